// SPDX-License-Identifier: Apache-2.0
// Reading of the directives of the scene language, and their effect on the graphics state.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fathom/error.h"
#include "formats/common/suggest.h"
#include "formats/io/gunzip.h"
#include "formats/io/read_file.h"
#include "formats/io/text_encoding.h"
#include "formats/pbrt/pbrt.h"
#include "formats/pbrt/reader.h"
#include "scene/texture_table.h"

namespace fathom {

namespace pbrt {

namespace {

constexpr std::size_t max_blocks = 100'000, max_nodes = 20'000'000;

/// Reads 16 numbers of a matrix in column-major order.
Transform matrix(Scanner& scanner)
{
    if (scanner.peek().kind != Token::Kind::open) scanner.fail("expected [ and 16 numbers");
    scanner.next();
    double m[16];
    for (double& value : m) value = scanner.number();
    if (scanner.peek().kind != Token::Kind::close) scanner.fail("expected ] after 16 numbers");
    scanner.next();
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] == 0)
        scanner.fail("the last row of a transform must be 0 0 0 1: perspective transforms are not supported");
    Transform t;
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 4; ++column) t.m[row][column] = m[4 * column + row] / m[15];
    return t;
}

Vec3d vector(Scanner& scanner)
{
    const double x = scanner.number(), y = scanner.number();
    return {x, y, scanner.number()};
}

/// Transform from world to a camera that looks along +z.
Transform look_at(Scanner& scanner)
{
    const Place place = scanner.place();
    const Vec3d eye = vector(scanner), at = vector(scanner), up = vector(scanner);
    const Vec3d z = normalize(at - eye), right = cross(normalize(up), z);
    if (length(z) == 0 || length(right) < 1e-12)
        place.fail("LookAt needs two different points and an up direction that is not parallel to the view");
    const Vec3d x = normalize(right), y = cross(z, x);
    Transform t;
    const Vec3d columns[] = {x, y, z, eye};
    for (std::size_t c = 0; c < 4; ++c) t.m[0][c] = columns[c].x, t.m[1][c] = columns[c].y, t.m[2][c] = columns[c].z;
    return t.inverse();
}

Space space_of(const Place& place, const std::string& name)
{
    const std::pair<const char*, Space> known[] = {
        {"srgb", Space::srgb}, {"rec2020", Space::rec2020}, {"dci-p3", Space::dci_p3}, {"aces2065-1", Space::aces2065}};
    std::vector<std::string> names;
    for (const auto& [text, space] : known) {
        if (name == text) return space;
        names.emplace_back(text);
    }
    place.fail(fmt::format("the color space '{}' is unknown{}", printable(name), suggestion(name, names)));
}

}  // namespace

Reader::Reader(const std::filesystem::path& file, LoadContext& context)
    : context_(context), folder_(file.parent_path()), reporter_(context.warnings)
{
    scene_.file = file.string();
    // A pbrt scene has its own light or is meant to be dark, so automatic lights are disabled.
    scene_.hints.own_light = true;
}

SceneDescription Reader::read(const std::string& bytes)
{
    read_file(scene_.file, bytes);
    if (!blocks_.empty())
        blocks_.back().place.fail(blocks_.back().kind == 'o' ? "ObjectBegin has no matching ObjectEnd"
                                                             : "AttributeBegin has no matching AttributeEnd");
    return finished();
}

SceneDescription Reader::finished()
{
    finish_camera();
    finish_media();
    if (mirrored_) {
        Node mirror;
        mirror.name = "left-handed";
        mirror.parent_from_node = Transform::scale({-1, 1, 1});
        mirror.children = std::move(scene_.roots);
        scene_.environment.world_from_environment = mirror.parent_from_node * scene_.environment.world_from_environment;
        for (Texture& texture : scene_.textures) {
            texture.direction = mirror.parent_from_node.vector(texture.direction);
            if (reads_position(texture))
                texture.world_from_texture = mirror.parent_from_node * texture.world_from_texture;
        }
        scene_.roots = {add_node(std::move(mirror))};
    }
    return std::move(scene_);
}

void Reader::report(const Parameters& of, const std::string& message)
{
    reporter_.report(of.place(), fmt::format("{}: {}", of.title(), message));
}

int Reader::add_node(Node node)
{
    if (scene_.nodes.size() >= max_nodes) throw Error(scene_.file, "", fmt::format("more than {} shapes", max_nodes));
    scene_.nodes.push_back(std::move(node));
    return int(scene_.nodes.size()) - 1;
}

std::filesystem::path Reader::locate(const Place& place, const std::string& name)
{
    if (name.empty() || name.find('\0') != std::string::npos)
        place.fail("the file name is empty or contains a null character");
    const std::filesystem::path path(name);
    try {
        return context_.locate(path.is_absolute() ? path : folder_ / path);
    } catch (const Error& error) {
        place.fail(error.what());
    }
}

std::filesystem::path Reader::locate(const Parameters& plugin, const std::string& name)
{
    return locate(plugin.place(), name);
}

void Reader::read_file(const std::filesystem::path& file, const std::string& bytes)
{
    const std::string unpacked = is_gzip(bytes) ? gunzip(file.string(), bytes) : std::string();
    const std::string_view text = utf8_text(file.string(), unpacked.empty() ? bytes : unpacked);
    Scanner scanner(std::make_shared<const std::string>(file.string()), text);
    while (scanner.peek().kind != Token::Kind::end) read_directive(scanner);
}

void Reader::include(Scanner& scanner, bool is_import)
{
    const Place place = scanner.place();
    if (is_import && !in_world_) place.fail("Import must follow WorldBegin");
    const std::filesystem::path file = locate(place, string_of(scanner));
    auto& open = context_.open_files;
    std::error_code error;
    std::filesystem::path canonical = std::filesystem::weakly_canonical(file, error);
    if (error) canonical = file;
    if (std::find(open.begin(), open.end(), canonical) != open.end())
        place.fail(fmt::format("'{}' includes itself", printable(file.string())));
    if (open.size() > 32) place.fail("files include files more than 32 deep");
    open.push_back(std::move(canonical));
    std::string bytes;
    try {
        bytes = context_.read(file);
    } catch (const Error& failure) {
        place.fail(failure.what());
    }
    const State before = state_;
    read_file(file, bytes);
    if (is_import) state_ = before;
    open.pop_back();
}

std::string Reader::string_of(Scanner& scanner)
{
    if (scanner.peek().kind != Token::Kind::string)
        scanner.fail(fmt::format("expected a string in quotes, found '{}'", printable(scanner.peek().text)));
    return unescaped(scanner.next());
}

Plugin Reader::plugin(Scanner& scanner, const char* kind, const char* preset)
{
    const Place place = scanner.place();
    std::string name = string_of(scanner);
    const auto found = state_.presets.find(preset);
    auto made = std::make_shared<Parameters>(kind, std::move(name), place, read_parameters(scanner),
                                             found == state_.presets.end() ? ParameterList() : found->second);
    made->set_space(state_.space);
    return made;
}

Plugin Reader::named_plugin(Scanner& scanner, const char* kind, const char* preset, std::string& name)
{
    const Plugin read = plugin(scanner, kind, preset);
    name = read->plugin();
    auto made = std::make_shared<Parameters>(*read);
    if (!made->has("type")) made->fail("it needs a 'type'");
    made->set_plugin(made->text("type", ""));
    return made;
}

void Reader::concat(const Transform& t)
{
    for (std::size_t i = 0; i < 2; ++i)
        if (state_.active[i]) state_.ctm[i] = state_.ctm[i] * t;
}

bool Reader::read_transform(Scanner& scanner, std::string_view word)
{
    const auto set = [&](const std::array<Transform, 2>& to) {
        for (std::size_t i = 0; i < 2; ++i)
            if (state_.active[i]) state_.ctm[i] = to[i];
    };
    if (word == "Identity") {
        set({});
    } else if (word == "Translate") {
        concat(Transform::translate(vector(scanner)));
    } else if (word == "Scale") {
        concat(Transform::scale(vector(scanner)));
    } else if (word == "Rotate") {
        const double angle = scanner.number();
        concat(Transform::rotate(vector(scanner), angle * std::numbers::pi / 180));
    } else if (word == "LookAt") {
        concat(look_at(scanner));
    } else if (word == "Transform") {
        const Transform t = matrix(scanner);
        set({t, t});
    } else if (word == "ConcatTransform") {
        concat(matrix(scanner));
    } else if (word == "CoordinateSystem") {
        systems_[string_of(scanner)] = state_.ctm;
    } else if (word == "CoordSysTransform") {
        const Place place = scanner.place();
        const std::string name = string_of(scanner);
        const auto found = systems_.find(name);
        if (found == systems_.end()) place.fail(fmt::format("there is no coordinate system '{}'", printable(name)));
        set(found->second);
    } else if (word == "TransformTimes") {
        times_[0] = scanner.number();
        times_[1] = scanner.number();
    } else if (word == "ActiveTransform") {
        const Token which = scanner.next();
        if (which.text != "All" && which.text != "StartTime" && which.text != "EndTime")
            scanner.fail("ActiveTransform must be followed by All, StartTime or EndTime");
        state_.active[0] = which.text != "EndTime";
        state_.active[1] = which.text != "StartTime";
    } else {
        return false;
    }
    return true;
}

void Reader::end_block(const Place& place, char kind)
{
    const char* const begin = kind == 'o' ? "ObjectBegin" : kind == 't' ? "TransformBegin" : "AttributeBegin";
    if (blocks_.empty() || blocks_.back().kind != kind)
        place.fail(blocks_.empty()
                       ? fmt::format("there is no matching {} before it", begin)
                       : fmt::format("the block that begins in line {} is still open", blocks_.back().place.line));
    state_ = std::move(blocks_.back().state);
    blocks_.pop_back();
    if (kind == 'o') current_object_ = nullptr;
}

bool Reader::read_scope(Scanner& scanner, std::string_view word)
{
    const Place place = scanner.place();
    const auto begin = [&](char kind) {
        if (blocks_.size() >= max_blocks) place.fail(fmt::format("blocks are nested more than {} deep", max_blocks));
        blocks_.push_back({state_, place, kind});
    };
    if (word == "AttributeBegin") {
        begin('a');
    } else if (word == "TransformBegin") {
        begin('t');
    } else if (word == "AttributeEnd") {
        end_block(place, 'a');
    } else if (word == "TransformEnd") {
        end_block(place, 't');
    } else if (word == "ObjectBegin") {
        if (current_object_) place.fail("objects can't contain objects");
        const std::string name = string_of(scanner);
        if (objects_.contains(name)) place.fail(fmt::format("the object '{}' is already defined", printable(name)));
        begin('o');
        current_object_ = &objects_[name];
    } else if (word == "ObjectEnd") {
        end_block(place, 'o');
    } else if (word == "ObjectInstance") {
        if (current_object_) place.fail("objects can't contain instances");
        const std::string name = string_of(scanner);
        const auto found = objects_.find(name);
        if (found == objects_.end()) place.fail(fmt::format("there is no object '{}'", printable(name)));
        Node node;
        node.children = found->second;
        if (!node.children.empty()) this->place(std::move(node));
    } else {
        return false;
    }
    return true;
}

bool Reader::read_block(Scanner& scanner, std::string_view word)
{
    const auto options = {"Camera", "Film", "PixelFilter", "Sampler", "Integrator", "Accelerator"};
    if (std::find(options.begin(), options.end(), word) == options.end()) return false;
    if (in_world_) scanner.fail(fmt::format("{} must precede WorldBegin", word));
    if (word == "Camera") {
        camera_ = plugin(scanner, "Camera", "");
        world_from_camera_ = state_.ctm[0].inverse();
        camera_medium_ = state_.outside;
        systems_["camera"] = {world_from_camera_, state_.ctm[1].inverse()};
        if (state_.ctm[0].m != state_.ctm[1].m)
            report(*camera_, "camera motion is not supported: the first transform is used");
    } else if (word == "Film") {
        film_ = plugin(scanner, "Film", "");
    } else if (word == "PixelFilter") {
        read_filter(*plugin(scanner, "PixelFilter", ""));
    } else if (word == "Sampler") {
        read_sampler(*plugin(scanner, "Sampler", ""));
    } else if (word == "Integrator") {
        read_integrator(*plugin(scanner, "Integrator", ""));
    } else {
        report(*plugin(scanner, "Accelerator", ""), "is ignored: Fathom builds its own acceleration structure");
    }
    return true;
}

void Reader::read_option(Scanner& scanner)
{
    const Place place = scanner.place();
    const std::string name = string_of(scanner);
    if (scanner.peek().kind == Token::Kind::end) scanner.fail("an option needs a value");
    scanner.next();
    reporter_.report(place, fmt::format("Option '{}' is ignored", printable(name)));
}

bool Reader::read_definition(Scanner& scanner, std::string_view word)
{
    const Place place = scanner.place();
    std::string name;
    if (word == "Texture") {
        name = string_of(scanner);
        const std::string type = string_of(scanner);
        if (type != "float" && type != "spectrum") place.fail("the type of a texture must be 'float' or 'spectrum'");
        auto& textures = type == "float" ? float_textures_ : color_textures_;
        if (textures.contains(name)) place.fail(fmt::format("the texture '{}' is already defined", printable(name)));
        textures[name] = {plugin(scanner, "Texture", "texture"), type == "float", state_.ctm[0], {}, false};
    } else if (word == "Material") {
        state_.material = plugin(scanner, "Material", "material");
        state_.named_material.clear();
        kept_.push_back(state_.material);
    } else if (word == "MakeNamedMaterial") {
        const Plugin made = named_plugin(scanner, "Material", "material", name);
        if (!named_materials_.emplace(name, made).second)
            place.fail(fmt::format("the material '{}' is already defined", printable(name)));
    } else if (word == "NamedMaterial") {
        state_.named_material = string_of(scanner);
    } else if (word == "MakeNamedMedium") {
        const Plugin made = named_plugin(scanner, "Medium", "medium", name);
        if (!media_.emplace(name, made).second)
            place.fail(fmt::format("the medium '{}' is already defined", printable(name)));
    } else if (word == "MediumInterface") {
        state_.inside = state_.outside = string_of(scanner);
        if (scanner.peek().kind == Token::Kind::string) state_.outside = string_of(scanner);
    } else if (word == "AreaLightSource") {
        state_.area_light = plugin(scanner, "AreaLightSource", "light");
        kept_.push_back(state_.area_light);
    } else {
        return false;
    }
    return true;
}

void Reader::read_directive(Scanner& scanner)
{
    const Token token = scanner.next();
    const Place place = scanner.place();
    if (token.kind != Token::Kind::word)
        place.fail(fmt::format("expected a directive, found '{}'", printable(token.text)));
    const std::string_view word = token.text;
    if (read_transform(scanner, word) || read_scope(scanner, word) || read_definition(scanner, word) ||
        read_block(scanner, word))
        return;
    if (word == "WorldBegin") {
        if (in_world_) place.fail("there is already a WorldBegin before it");
        in_world_ = true;
        state_.ctm = {};
        state_.active[0] = state_.active[1] = true;
        systems_["world"] = {};
    } else if (word == "WorldEnd") {
        // This directive of older versions has no effect.
    } else if (word == "Shape") {
        read_shape(*plugin(scanner, "Shape", "shape"));
    } else if (word == "LightSource") {
        read_light(*plugin(scanner, "LightSource", "light"));
    } else if (word == "ReverseOrientation") {
        state_.reverse = !state_.reverse;
    } else if (word == "Attribute") {
        const std::string target = string_of(scanner);
        ParameterList& list = state_.presets[target];
        for (auto& p : read_parameters(scanner)) list.push_back(std::move(p));
    } else if (word == "ColorSpace") {
        state_.space = space_of(place, string_of(scanner));
    } else if (word == "Option") {
        read_option(scanner);
    } else if (word == "Include" || word == "Import") {
        include(scanner, word == "Import");
    } else {
        std::vector<std::string> names = {
            "AttributeBegin",  "AttributeEnd",   "Shape",      "LightSource",     "Material",
            "NamedMaterial",   "Texture",        "Include",    "Import",          "ObjectBegin",
            "ObjectEnd",       "ObjectInstance", "WorldBegin", "AreaLightSource", "MakeNamedMaterial",
            "MakeNamedMedium", "Translate",      "Rotate",     "Scale",           "Transform",
            "LookAt",          "Camera",         "Film",       "Integrator"};
        place.fail(fmt::format("'{}' is not a directive{}", printable(word), suggestion(word, names)));
    }
}

}  // namespace pbrt

SceneDescription read_pbrt(const SourceFile& file, LoadContext& context)
{
    return pbrt::Reader(file.path, context).read(file.bytes());
}

}  // namespace fathom
