// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <sstream>
#include <vector>

#include "fathom/scene_digest.h"
#include "scene/light_table.h"
#include "scene/material_table.h"
#include "scene/texture_table.h"

namespace fathom {

namespace {

/// FNV-1a hash of 32 bits. A collision only hides a change from the text: the fingerprint of the whole scene detects
/// it.
std::uint32_t digest(const std::string& text)
{
    std::uint32_t hash = 2166136261u;
    for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
    return hash;
}

/// Replaces control characters, since names stand between quotes in messages and between tabs in the digest.
std::string one_line(std::string name)
{
    std::replace_if(name.begin(), name.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
    return name;
}

/// Formats values as text, independent of padding in memory. Textures are identified by name, because indices shift.
class Words {
public:
    explicit Words(const SceneDescription& scene) : scene_(scene) {}

    std::string of(const Color& c) const { return fmt::format("{} {} {}", c.r, c.g, c.b); }
    std::string of(const Vec2f& v) const { return fmt::format("{} {}", v.x, v.y); }
    std::string of(const Vec3d& v) const { return fmt::format("{} {} {}", v.x, v.y, v.z); }
    std::string of(const Transform& t) const
    {
        std::string words;
        for (const auto& row : t.m)
            for (const double number : row) words += fmt::format("{} ", number);
        return words;
    }
    std::string of(const ColorInput& input) const { return of(input.value) + texture(input.texture); }
    std::string of(const FloatInput& input) const
    {
        return fmt::format("{} {}{}", input.value, input.channel, texture(input.texture));
    }
    std::string of(const std::vector<RampStop>& stops) const
    {
        std::string words;
        for (const RampStop& stop : stops) words += fmt::format("{} {};", stop.position, of(stop.color));
        return words;
    }
    template <class Number>
    std::string of(const Number& number) const
    {
        if constexpr (std::is_enum_v<Number>)
            return fmt::format("{}", int(number));
        else
            return fmt::format("{}", number);
    }
    std::string texture(int index) const
    {
        const bool is_there = index >= 0 && std::size_t(index) < scene_.textures.size();
        return is_there ? " " + scene_.textures[std::size_t(index)].name : "";
    }
    std::string material(int index) const
    {
        const bool is_there = index >= 0 && std::size_t(index) < scene_.materials.size();
        return is_there ? scene_.materials[std::size_t(index)].name : "";
    }
    std::string image(int index) const
    {
        const bool is_there = index >= 0 && std::size_t(index) < scene_.images.size();
        return is_there ? scene_.images[std::size_t(index)].path.filename().string() : "";
    }

    std::string measured(int index) const
    {
        const bool is_there = index >= 0 && std::size_t(index) < scene_.measured.size();
        return is_there ? scene_.measured[std::size_t(index)].name : "";
    }

private:
    const SceneDescription& scene_;
};

class PartsText {
public:
    void begin(const char* kind, const std::string& name)
    {
        text_ += fmt::format("{}{}\t{}", text_.empty() ? "" : "\n", kind, one_line(name));
    }
    void value(const char* key, const std::string& words) { text_ += fmt::format("\t{}={:08x}", key, digest(words)); }
    bool is_full() const
    {
        constexpr std::size_t most = 1 << 20;
        return text_.size() > most;
    }
    std::string take() { return std::move(text_); }

private:
    std::string text_;
};

template <class Owner>
void add(PartsText& text, const char* kind, const Owner& owner, std::span<const Parameter<Owner>> parameters,
         const Words& words)
{
    if (text.is_full()) return;
    text.begin(kind, owner.name);
    text.value("kind", words.of(owner.kind));
    for (const Parameter<Owner>& p : parameters) {
        if (!p.is_of(std::uint32_t(owner.kind))) continue;
        std::visit(
            [&](auto member) {
                if constexpr (std::is_same_v<decltype(member), TextureReference<Owner>>)
                    text.value(p.key, words.texture(member(owner)));
                else if constexpr (std::is_same_v<decltype(member), ImageReference<Owner>>)
                    text.value(p.key, words.image(member(owner)));
                else if constexpr (std::is_same_v<decltype(member), MeasuredReference<Owner>>)
                    text.value(p.key, words.measured(member(owner)));
                else if constexpr (std::is_same_v<decltype(member), MaterialReference<Owner>>)
                    text.value(p.key, words.material(member(owner)));
                else
                    text.value(p.key, words.of(member(owner)));
            },
            p.member);
    }
}

/// The digests of each part of a scene, by key.
using Parts = std::map<std::string, std::map<std::string, std::string>>;

Parts parse(const std::string& text)
{
    Parts parts;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string kind, name, value;
        std::getline(words, kind, '\t');
        std::getline(words, name, '\t');
        auto& values = parts[name.empty() ? kind : fmt::format("{} '{}'", kind, name)];
        while (std::getline(words, value, '\t')) {
            const std::size_t equals = value.find('=');
            values[value.substr(0, equals)] += equals == std::string::npos ? "" : value.substr(equals + 1);
        }
    }
    return parts;
}

}  // namespace

std::string scene_digest(const SceneDescription& scene)
{
    const Words words(scene);
    PartsText text;
    const Environment& e = scene.environment;
    text.begin("environment", "");
    text.value("kind", words.of(e.kind));
    text.value("color", words.of(e.color) + words.of(e.bottom) + words.of(e.top));
    text.value("image", words.image(e.image));
    text.value("sun", words.of(e.to_sun) + words.of(e.sun_disk) + words.of(e.sky_ground) + words.of(e.turbidity) +
                          words.of(e.ground_albedo));
    for (const Camera& camera : scene.cameras) {
        if (text.is_full()) break;
        text.begin("camera", camera.name);
        text.value("place", words.of(camera.position) + words.of(camera.look_at) + words.of(camera.up));
        text.value("lens", fmt::format("{} {} {} {} {}", int(camera.kind), camera.fov_y, camera.height, camera.aperture,
                                       camera.focus_distance));
        if (camera.fov_aspect > 0)
            text.value("fov axis", fmt::format("{} {}", int(camera.fov_axis), camera.fov_aspect));
        text.value("shift", fmt::format("{} {}", camera.shift_x, camera.shift_y));
        text.value("shutter", fmt::format("{} {}", camera.shutter_open, camera.shutter_close));
    }
    for (const Light& light : scene.lights) {
        if (text.is_full()) break;
        add(text, "light", light, light_parameters(), words);
        text.value("intensity", words.of(light.intensity) + words.of(light.intensity_is_flux));
        if (light.picture.image < 0) continue;
        text.value("picture", words.image(light.picture.image) +
                                  fmt::format(" {} {}", int(light.picture.color_space), light.picture.nearest));
    }
    for (const Material& material : scene.materials) add(text, "material", material, material_parameters(), words);
    for (const Texture& texture : scene.textures) add(text, "texture", texture, texture_parameters(), words);
    return text.take();
}

std::string scene_digest_difference(const std::string& before, const std::string& now)
{
    const Parts old_parts = parse(before), new_parts = parse(now);
    std::vector<std::string> words;
    for (const auto& [name, values] : new_parts) {
        const auto old = old_parts.find(name);
        if (old == old_parts.end()) {
            words.push_back(name + " is new");
            continue;
        }
        std::vector<std::string> keys;
        for (const auto& [key, value] : values)
            if (const auto there = old->second.find(key); there == old->second.end() || there->second != value)
                keys.push_back(key);
        if (!keys.empty()) words.push_back(fmt::format("{}: {}", name, fmt::join(keys, ", ")));
    }
    for (const auto& [name, values] : old_parts)
        if (!new_parts.contains(name)) words.push_back(name + " is gone");
    constexpr std::size_t most = 4;
    const std::size_t more = words.size() > most ? words.size() - most : 0;
    words.resize(words.size() - more);
    return fmt::format("{}{}", fmt::join(words, "; "), more > 0 ? fmt::format("; and {} more", more) : "");
}

}  // namespace fathom
