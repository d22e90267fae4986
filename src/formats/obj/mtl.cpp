// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numbers>
#include <optional>

#include "formats/common/phong.h"
#include "formats/io/text_encoding.h"
#include "formats/io/text_scanner.h"
#include "formats/obj/obj.h"

namespace fathom {

namespace {

/// Values of one material in an MTL file, collected before the material is built.
struct Entry {
    std::string name;
    Phong phong;
    std::optional<float> opacity, transparency;  ///< `d` and `Tr`, of which either defines the opacity
    int illum = 2;
    std::optional<float> roughness, metallic, sheen, coat, coat_roughness, anisotropy, anisotropy_turn;
    Color emission{0, 0, 0};
    int map_diffuse = -1, map_emission = -1, map_opacity = -1, map_roughness = -1, map_metallic = -1, map_normal = -1;
    int map_sheen = -1, map_coat = -1, map_coat_roughness = -1;
    float normal_scale = 1;
    FloatInput displacement{0, -1, 0};
    float displacement_midlevel = 0;
};

/// Bump height in image widths for -bm 1, which the format leaves undefined.
constexpr float height_of_white = 0.01f;

class MtlReader {
public:
    MtlReader(const std::filesystem::path& file, std::string_view text, SceneDescription& scene,
              std::map<std::string, int, std::less<>>& by_name, Warnings& warnings)
        : file_(file),
          name_(file.string()),
          scan_(name_, utf8_text(name_, text), 1, '#'),
          scene_(scene),
          by_name_(by_name),
          warnings_(warnings)
    {
    }

    void read()
    {
        std::optional<Entry> entry;
        for (; !scan_.at_end(); scan_.next_line()) {
            const std::string_view key = scan_.word();
            if (key == "newmtl") {
                if (entry) add(*entry);
                entry.emplace();
                entry->name = scan_.rest();
            } else if (entry && !key.empty()) {
                read_line(key, *entry);
            }
        }
        if (entry) add(*entry);
    }

private:
    Color color()
    {
        const std::string_view first = scan_.word();
        if (first == "spectral" || first == "xyz") {
            warnings_.add(name_ + ": colors that are not RGB are not supported: gray is used");
            return {0.5f, 0.5f, 0.5f};
        }
        Color c;
        c.r = scan_.to_number(first);
        // A single number stands for all three channels.
        c.g = scan_.line_has_more() ? scan_.number() : c.r;
        c.b = scan_.line_has_more() ? scan_.number() : c.g;
        return {std::max(c.r, 0.0f), std::max(c.g, 0.0f), std::max(c.b, 0.0f)};
    }

    void read_line(std::string_view key, Entry& e)
    {
        std::string lower(key);
        std::transform(lower.begin(), lower.end(), lower.begin(),
                       [](unsigned char c) { return char(std::tolower(c)); });
        if (lower == "kd")
            e.phong.diffuse = color();
        else if (lower == "ks")
            e.phong.specular = color();
        else if (lower == "ke")
            e.emission = color();
        else if (lower == "ns")
            e.phong.shininess = scan_.number();
        else if (lower == "ni")
            e.phong.ior = scan_.number();
        else if (lower == "d")
            e.opacity = opacity();
        else if (lower == "tr")
            e.transparency = scan_.number();
        else if (lower == "illum")
            e.illum = int(std::clamp(scan_.number(), 0.0f, 10.0f));
        else if (lower == "pr")
            e.roughness = scan_.number();
        else if (lower == "pm")
            e.metallic = scan_.number();
        else if (lower == "ps")
            e.sheen = scan_.number();
        else if (lower == "pc")
            e.coat = scan_.number();
        else if (lower == "pcr")
            e.coat_roughness = scan_.number();
        else if (lower == "aniso")
            e.anisotropy = scan_.number();
        else if (lower == "anisor")
            e.anisotropy_turn = scan_.number();
        else
            read_map(key, lower, e);
    }

    void read_map(std::string_view key, const std::string& lower, Entry& e)
    {
        if (lower == "map_kd")
            e.map_diffuse = map(ColorSpace::srgb);
        else if (lower == "map_ke")
            e.map_emission = map(ColorSpace::srgb);
        else if (lower == "map_d" || lower == "map_tr")
            e.map_opacity = map(ColorSpace::linear);
        else if (lower == "map_pr")
            e.map_roughness = map(ColorSpace::linear);
        else if (lower == "map_pm")
            e.map_metallic = map(ColorSpace::linear);
        else if (lower == "map_ps")
            e.map_sheen = map(ColorSpace::linear);
        else if (lower == "map_pc")
            e.map_coat = map(ColorSpace::linear);
        else if (lower == "map_pcr")
            e.map_coat_roughness = map(ColorSpace::linear);
        else if (lower == "norm" || lower == "map_kn")
            e.map_normal = map(ColorSpace::linear);
        else if (lower == "map_bump" || lower == "bump")
            read_bump(e);
        else if (lower == "disp" || lower == "map_disp")
            read_displacement(e);
        else if (lower.starts_with("map_") || lower == "decal" || lower == "refl")
            warnings_.add(fmt::format("{}: '{}' is not supported and is ignored", name_, printable(key)));
    }

    float opacity()
    {
        const std::string_view word = scan_.word();
        return word == "-halo" ? scan_.number() : scan_.to_number(word);
    }

    /// Reads map_bump: a height map by the specification, but often a normal map in practice, which only the file name
    /// reveals.
    void read_bump(Entry& e)
    {
        const int texture = map(ColorSpace::linear);
        if (texture < 0) return;
        std::string file = scene_.images[std::size_t(scene_.textures[std::size_t(texture)].image)].name;
        std::transform(file.begin(), file.end(), file.begin(), [](unsigned char c) { return char(std::tolower(c)); });
        for (const char* sign : {"norm", "nrm", "_n.", "-n.", "_ddn", "_nor"})
            if (file.find(sign) != std::string::npos) {
                e.map_normal = texture;
                e.normal_scale = bump_scale_;
                return;
            }
        // An explicit normal map takes precedence.
        if (e.map_normal >= 0) return;
        e.map_normal = texture;
        e.normal_scale = 1;
        scene_.textures[std::size_t(texture)].height_scale = bump_scale_ * height_of_white;
    }

    /// Reads a displacement map with heights in units of the file; -mm gives base + gain * value.
    void read_displacement(Entry& e)
    {
        const int texture = map(ColorSpace::linear);
        if (texture < 0 || value_gain_ == 0) return;
        e.displacement = {bump_scale_ * value_gain_, texture, 0};
        e.displacement_midlevel = -value_base_ / value_gain_;
    }

    /// Reads a map's options and file name, which may contain spaces. Returns the texture's index, or -1.
    int map(ColorSpace color_space)
    {
        Texture texture;
        texture.color_space = color_space;
        bump_scale_ = value_gain_ = 1;
        value_base_ = 0;
        Vec2f offset{0, 0}, scale{1, 1};
        std::string_view rest = scan_.rest();
        while (rest.starts_with('-')) {
            TextScanner words(name_, rest, scan_.line());
            const std::string_view option = words.word();
            const auto up_to_three = [&](Vec2f& out) {
                for (int i = 0; i < 3; ++i) {
                    TextScanner ahead = words;
                    const std::string_view word = ahead.word();
                    if (word.empty() ||
                        !(std::isdigit(static_cast<unsigned char>(word[0])) || word[0] == '-' || word[0] == '+' ||
                          word[0] == '.') ||
                        (word.size() > 1 && std::isalpha(static_cast<unsigned char>(word[1]))))
                        break;
                    // File names such as 2k.png begin like numbers.
                    if (word.find_first_not_of("0123456789+-.eE") != std::string_view::npos) break;
                    const float value = words.to_number(words.word());
                    if (i == 0) out.x = value;
                    if (i == 1) out.y = value;
                }
            };
            Vec2f ignored;
            if (option == "-o")
                up_to_three(offset);
            else if (option == "-s")
                up_to_three(scale);
            else if (option == "-t")
                up_to_three(ignored);
            else if (option == "-bm")
                bump_scale_ = words.number();
            else if (option == "-clamp")
                texture.wrap_u = texture.wrap_v = words.word() == "on" ? Wrap::clamp : Wrap::repeat;
            else if (option == "-mm")
                value_base_ = words.number(), value_gain_ = words.number();
            else if (option == "-blendu" || option == "-blendv" || option == "-cc" || option == "-boost" ||
                     option == "-texres" || option == "-imfchan" || option == "-type")
                words.word();
            else
                break;
            rest = words.rest();
        }
        rest = file_name(rest);
        if (rest.empty()) {
            warnings_.add(name_ + ": textures without a file are ignored");
            return -1;
        }
        // OBJ's v grows upward; the reader flips it.
        texture.uv_scale = scale;
        texture.uv_offset = {offset.x, 1 - scale.y - offset.y};
        texture.image = image(rest);
        scene_.textures.push_back(texture);
        return int(scene_.textures.size()) - 1;
    }

    /// The file name without a comment: a '#' belongs to the name unless the part before it has an extension.
    static std::string_view file_name(std::string_view rest)
    {
        const std::string_view name = before_comment(rest);
        return name.empty() || name.find('.') != std::string_view::npos ? name : rest;
    }

    int image(std::string_view name)
    {
        std::string path(name);
        std::replace(path.begin(), path.end(), '\\', '/');
        const auto [found, is_new] = images_.try_emplace(path, int(scene_.images.size()));
        if (is_new) scene_.images.push_back({path, file_.parent_path() / path, {}});
        return found->second;
    }

    /// Applies the keys of physically based materials, which override the older keys.
    static void set_layers(const Entry& e, Material& m)
    {
        const auto share = [](std::optional<float> value, int map) {
            return std::clamp(value.value_or(map >= 0 ? 1.0f : 0.0f), 0.0f, 1.0f);
        };
        const bool has_metal = e.roughness || e.metallic || e.map_roughness >= 0 || e.map_metallic >= 0;
        const bool has_layers = share(e.sheen, e.map_sheen) > 0 || share(e.coat, e.map_coat) > 0 || e.anisotropy;
        if ((has_metal || has_layers) && m.kind != MaterialKind::glass) m.kind = MaterialKind::principled;
        if (has_metal) {
            m.roughness = {std::clamp(e.roughness.value_or(e.map_roughness >= 0 ? 1.0f : 0.5f), 0.0f, 1.0f),
                           e.map_roughness, 0};
            m.metallic = {share(e.metallic, e.map_metallic), e.map_metallic, 0};
        }
        if (m.kind != MaterialKind::principled || !has_layers) return;
        const float sheen = share(e.sheen, e.map_sheen);
        m.sheen.color = {{sheen, sheen, sheen}, e.map_sheen};
        m.coat.weight = {share(e.coat, e.map_coat), e.map_coat, 0};
        m.coat.roughness = {share(e.coat_roughness, e.map_coat_roughness), e.map_coat_roughness, 0};
        m.microfacets.anisotropy = {std::clamp(e.anisotropy.value_or(0), 0.0f, 1.0f), -1, 0};
        // The file's unit is turns.
        m.microfacets.anisotropy_rotation = 2 * std::numbers::pi * double(e.anisotropy_turn.value_or(0));
    }

    void add(Entry& e)
    {
        Material m;
        m.name = printable(e.name);
        set_opacity(e);
        // Some programs write a black color together with a texture and mean the texture alone.
        const auto is_black = [](Color c) { return c.r == 0 && c.g == 0 && c.b == 0; };
        if (e.map_diffuse >= 0 && is_black(e.phong.diffuse)) e.phong.diffuse = {1, 1, 1};
        if (e.illum < 2) e.phong.specular = {0, 0, 0};
        e.phong.refracts = e.illum == 6 || e.illum == 7 || e.illum == 9 || (e.illum == 4 && e.phong.opacity < 1);
        set_phong(m, e.phong);
        set_layers(e, m);
        m.base_color.texture = e.map_diffuse;
        m.normal_map.texture = e.map_normal;
        m.normal_map.scale = e.normal_scale;
        m.displacement.height = e.displacement;
        m.displacement.midlevel = e.displacement_midlevel;
        m.emission.radiance.value = e.map_emission >= 0 && is_black(e.emission) ? Color{1, 1, 1} : e.emission;
        m.emission.radiance.texture = e.map_emission;
        // OBJ files are unreliable about the front side, so both sides emit.
        m.emission.two_sided = true;
        if (e.map_opacity >= 0) {
            m.opacity.alpha.texture = e.map_opacity;
            const bool same_image = e.map_diffuse >= 0 && texture_image(e.map_diffuse) == texture_image(e.map_opacity);
            m.opacity.alpha.channel = same_image ? 3 : 0;
            m.opacity.mode = AlphaMode::blend;
        }
        by_name_[e.name] = int(scene_.materials.size());
        by_name_.try_emplace(std::string(before_comment(e.name)), int(scene_.materials.size()));
        scene_.materials.push_back(std::move(m));
    }

    /// The specification defines `d`; `Tr` was added later, and some programs write the same number for both.
    void set_opacity(Entry& e)
    {
        if (e.opacity && e.transparency && std::abs(*e.opacity + *e.transparency - 1) > 0.01f)
            warnings_.add(name_ + ": materials whose 'd' and 'Tr' contradict each other: 'd' is used");
        if (e.opacity || e.transparency) e.phong.opacity = e.opacity ? *e.opacity : 1 - *e.transparency;
    }
    int texture_image(int texture) const { return scene_.textures[std::size_t(texture)].image; }

    std::filesystem::path file_;
    std::string name_;
    TextScanner scan_;
    SceneDescription& scene_;
    std::map<std::string, int, std::less<>>& by_name_;
    Warnings& warnings_;
    std::map<std::string, int> images_;
    float bump_scale_ = 1, value_base_ = 0, value_gain_ = 1;  ///< options of the last map
};

}  // namespace

std::string_view before_comment(std::string_view name)
{
    std::size_t end = 0;
    for (; end < name.size(); ++end)
        if (name[end] == '#' && (end == 0 || name[end - 1] == ' ' || name[end - 1] == '\t')) break;
    while (end > 0 && (name[end - 1] == ' ' || name[end - 1] == '\t')) --end;
    return name.substr(0, end);
}

void read_mtl(const std::filesystem::path& file, std::string_view text, SceneDescription& scene,
              std::map<std::string, int, std::less<>>& by_name, Warnings& warnings)
{
    MtlReader(file, text, scene, by_name, warnings).read();
}

}  // namespace fathom
