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
        else if (lower == "illum")
            e.illum = int(std::clamp(scan_.number(), 0.0f, 10.0f));
        else if (!read_number(lower, e) && !read_map(lower, e) && is_map(lower))
            warnings_.add(fmt::format("{}: '{}' is not supported and is ignored", name_, printable(key)));
    }

    /// Reads a number that is optional. False for other keys.
    bool read_number(std::string_view key, Entry& e)
    {
        static constexpr std::pair<std::string_view, std::optional<float> Entry::*> numbers[] = {
            {"tr", &Entry::transparency},  {"pr", &Entry::roughness},
            {"pm", &Entry::metallic},      {"ps", &Entry::sheen},
            {"pc", &Entry::coat},          {"pcr", &Entry::coat_roughness},
            {"aniso", &Entry::anisotropy}, {"anisor", &Entry::anisotropy_turn}};
        for (const auto& [name, member] : numbers) {
            if (name != key) continue;
            e.*member = scan_.number();
            return true;
        }
        return false;
    }

    /// Reads the name of an image. False for other keys.
    bool read_map(std::string_view key, Entry& e)
    {
        static constexpr std::pair<std::string_view, int Entry::*> maps[] = {
            {"map_kd", &Entry::map_diffuse}, {"map_ke", &Entry::map_emission},  {"map_d", &Entry::map_opacity},
            {"map_tr", &Entry::map_opacity}, {"map_pr", &Entry::map_roughness}, {"map_pm", &Entry::map_metallic},
            {"map_ps", &Entry::map_sheen},   {"map_pc", &Entry::map_coat},      {"map_pcr", &Entry::map_coat_roughness},
            {"norm", &Entry::map_normal},    {"map_kn", &Entry::map_normal}};
        for (const auto& [name, member] : maps) {
            if (name != key) continue;
            const bool is_color = member == &Entry::map_diffuse || member == &Entry::map_emission;
            e.*member = map(is_color ? ColorSpace::srgb : ColorSpace::linear);
            return true;
        }
        if (key == "map_bump" || key == "bump")
            read_bump(e);
        else if (key == "disp" || key == "map_disp")
            read_displacement(e);
        else
            return false;
        return true;
    }

    static bool is_map(std::string_view key) { return key.starts_with("map_") || key == "decal" || key == "refl"; }

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

    /// Options of a map that apply to texture coordinates.
    struct MapPlacement {
        Vec2f offset{0, 0}, scale{1, 1};
        Wrap wrap = Wrap::repeat;
    };

    /// Reads a map's options and file name, which may contain spaces. Returns the texture's index, or -1.
    int map(ColorSpace color_space)
    {
        bump_scale_ = value_gain_ = 1;
        value_base_ = 0;
        MapPlacement placement;
        std::string_view rest = scan_.rest();
        while (rest.starts_with('-')) {
            TextScanner words(name_, rest, scan_.line());
            if (!read_map_option(words, placement)) break;
            rest = words.rest();
        }
        rest = file_name(rest);
        if (rest.empty()) {
            warnings_.add(name_ + ": textures without a file are ignored");
            return -1;
        }
        Texture texture;
        texture.color_space = color_space;
        texture.wrap_u = texture.wrap_v = placement.wrap;
        // OBJ's v grows upward; the reader flips it.
        texture.uv_scale = placement.scale;
        texture.uv_offset = {placement.offset.x, 1 - placement.scale.y - placement.offset.y};
        texture.image = image(rest);
        scene_.textures.push_back(texture);
        return int(scene_.textures.size()) - 1;
    }

    /// Reads an option of a map with its arguments. False if the words begin with something else.
    bool read_map_option(TextScanner& words, MapPlacement& placement)
    {
        const std::string_view option = words.word();
        if (option == "-o") {
            placement.offset = read_up_to_three(words, placement.offset);
        } else if (option == "-s") {
            placement.scale = read_up_to_three(words, placement.scale);
        } else if (option == "-t") {
            read_up_to_three(words, {});
        } else if (option == "-bm") {
            bump_scale_ = words.number();
        } else if (option == "-clamp") {
            placement.wrap = words.word() == "on" ? Wrap::clamp : Wrap::repeat;
        } else if (option == "-mm") {
            value_base_ = words.number(), value_gain_ = words.number();
        } else {
            constexpr std::string_view ignored[] = {"-blendu", "-blendv",  "-cc",  "-boost",
                                                    "-texres", "-imfchan", "-type"};
            if (std::find(std::begin(ignored), std::end(ignored), option) == std::end(ignored)) return false;
            words.word();
        }
        return true;
    }

    /// Reads up to three numbers, of which the third is ignored; missing ones keep their values.
    static Vec2f read_up_to_three(TextScanner& words, Vec2f values)
    {
        for (int i = 0; i < 3; ++i) {
            TextScanner ahead = words;
            // File names such as 2k.png begin like numbers.
            if (!looks_like_number(ahead.word())) break;
            const float value = words.to_number(words.word());
            if (i == 0) values.x = value;
            if (i == 1) values.y = value;
        }
        return values;
    }
    static bool looks_like_number(std::string_view word)
    {
        return !word.empty() && word.find_first_not_of("0123456789+-.eE") == std::string_view::npos &&
               (std::isdigit(static_cast<unsigned char>(word[0])) || word[0] == '-' || word[0] == '+' ||
                word[0] == '.') &&
               !(word.size() > 1 && std::isalpha(static_cast<unsigned char>(word[1])));
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
    float bump_scale_ = 1, value_base_ = 0,
          value_gain_ = 1;  ///< scale, offset and gain from the options of the last map
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
