// SPDX-License-Identifier: Apache-2.0
#include "targets.h"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>

#include "fathom/error.h"
#include "fathom/film_file.h"
#include "fathom/image.h"
#include "fathom/load.h"
#include "fathom/render.h"
#include "fathom/scene_file.h"
#include "film/film_data.h"
#include "formats/common/importer.h"
#include "formats/common/measured_file.h"
#include "formats/fathom/fathom_json.h"
#include "formats/gltf/gltf.h"
#include "formats/mitsuba/mitsuba.h"
#include "formats/mitsuba/serialized.h"
#include "formats/obj/obj.h"
#include "formats/pbrt/pbrt.h"
#include "formats/ply/ply.h"
#include "formats/stl/stl.h"
#include "lights/ies/ies.h"
#include "scene/check.h"
#include "support/deflated.h"

namespace fathom::fuzz {

namespace {

/// Files that the inputs refer to don't exist.
const std::filesystem::path folder = "/nonexistent-folder";

void use(SceneDescription& scene)
{
    check_scene(scene);
    add_default_camera(scene, {});
    world_bounds(scene);
}

/// Plays all animations before, during and after their time; one that is rejected doesn't stop the others.
void play(const SceneDescription& scene, const AnimationRig& rig)
{
    for (std::size_t i = 0; i < rig.animations.size(); ++i) {
        SceneDescription posed = scene;
        try {
            const AnimationPlayer player(posed, rig, i);
            for (const double time_s : {-1.0, 0.0, 0.3, 0.8, 1e9}) {
                set_pose(posed, player.pose(time_s));
                use(posed);
            }
        } catch (const Error&) {
            // A reader may reject any input with an Error.
        }
    }
}

template <const Importer& importer>
void read_scene(const std::string& bytes)
{
    if (bytes.empty()) return;
    try {
        const std::filesystem::path file = folder / "a";
        Warnings warnings;
        LoadContext context(file, false, warnings);
        const LoadOptions options;
        InputFile input(file.string(), bytes);
        SceneDescription scene = importer.read({file, "", input, options}, context);
        use(scene);
        play(scene, context.offered.rig);
    } catch (const Error&) {
        // A reader may reject any input with an Error.
    }
}

void read_serialized(const std::string& bytes)
{
    try {
        const mitsuba::SerializedFile file("a", bytes);
        for (std::size_t i = 0; i < std::min<std::size_t>(file.count(), 4); ++i) file.mesh(i);
    } catch (const Error&) {
        // A reader may reject any input with an Error.
    }
}

void read_materials(const std::string& bytes)
{
    try {
        Warnings warnings;
        SceneDescription scene;
        std::map<std::string, int, std::less<>> names;
        read_mtl(folder / "a.mtl", bytes, scene, names, warnings);
        use(scene);
    } catch (const Error&) {
        // A reader may reject any input with an Error.
    }
}

constexpr std::uint64_t memory = 1 << 28;

void read_picture(const std::string& bytes)
{
    try {
        read_image("a", bytes.data(), bytes.size(), memory);
    } catch (const Error&) {
        // A reader may reject any input with an Error.
    }
}

void read_profile(const std::string& bytes)
{
    try {
        const IesProfile profile = parse_ies("a.ies", bytes);
        for (const double azimuth : {0.0, 37.0, 90.0, 200.0, 359.0})
            for (const double polar : {0.0, 33.0, 90.0, 180.0}) profile.at(polar, azimuth);
    } catch (const Error&) {
        // A reader may reject any input with an Error.
    }
}

void read_surface(const std::string& bytes)
{
    try {
        SceneDescription scene;
        scene.measured.push_back(read_measured("a.bsdf", bytes));
        use(scene);
    } catch (const Error&) {
        // A reader may reject any input with an Error.
    }
}

/// Film files are read at any offset by several threads, so this writes the input to a file in memory.
void read_film(const std::string& bytes)
{
    static const int descriptor = memfd_create("film", MFD_CLOEXEC);
    const std::string file = "/proc/self/fd/" + std::to_string(descriptor);
    if (ftruncate(descriptor, 0) != 0 || pwrite(descriptor, bytes.data(), bytes.size(), 0) != ssize_t(bytes.size()))
        throw std::runtime_error("no file in memory can be written");
    try {
        FilmFile(file).read().image(true, true);
    } catch (const Error&) {
        // A reader may reject any input with an Error.
    }
}

template <class T>
std::string raw(const std::vector<T>& values)
{
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}
std::string raw(std::uint32_t value)
{
    return raw(std::vector<std::uint32_t>{value});
}

std::vector<std::string> json_seeds()
{
    return {
        R"({"fathom": 1, "camera": {"position": [0, 1, 5], "look_at": [0, 0, 0], "aperture": 0.1, "shutter": [0, 1]},
  "textures": {"t": {"kind": "checker_uv", "scale": 4, "color_a": [0, 0, 0]}, "i": {"image": "a.png"}},
  "materials": {"m": {"kind": "diffuse", "base_color": "t"}, "g": {"kind": "glass", "ior": 1.5}},
  "meshes": {"q": {"positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "indices": [[0, 1, 2]], "uvs": [[0, 0], [1, 0], [0, 1]]}},
  "nodes": {"n": {"mesh": "q", "material": "m", "children": [{"sphere": {"radius": 2}, "material": "g"}]}},
  "scene": ["n", {"instance": "n", "transform": [{"scale": 2}, {"rotate": {"axis": [0, 1, 0], "angle_deg": 30}}]},
    {"motion": [{"time": 0}, {"time": 1, "transform": {"translate": [1, 0, 0]}}], "box": {"min": [0, 0, 0], "max": [1, 1, 1]}}],
  "lights": {"l": {"kind": "spot", "intensity": 10, "unit": "W", "position": [0, 3, 0]},
    "p": {"kind": "projector", "image": "a.png", "fov_deg": 40, "fov_axis": "width", "up": [0, 1, 1]}, "g": {"kind": "goniometric", "image": "a.ies"}},
  "environment": {"kind": "gradient"}, "render": {"size": [32, 24], "samples": 4}})",
        R"({"fathom": 1, "scene": [{"curves": {"curves": [[[0, 0, 0, 1], [1, 0, 0, 1], [2, 0, 0, 1], [3, 1, 0, 1]]]}},
  {"points": {"points": [[0, 0, 0], [1, 2, 3, 0.5]]}}, {"disk": {"normal": [0, 1, 0]}},
  {"rectangle": {"corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0]}}]})"};
}

std::string from_hex(std::string_view digits)
{
    std::string bytes;
    for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
        bytes += char(std::stoi(std::string(digits.substr(i, 2)), nullptr, 16));
    return bytes;
}

std::string glb_of(std::string json, std::string bytes)
{
    json.resize((json.size() + 3) / 4 * 4, ' ');
    bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    return "glTF" + raw(2u) + raw(std::uint32_t(28 + json.size() + bytes.size())) + raw(std::uint32_t(json.size())) +
           raw(0x4e4f534au) + json + raw(std::uint32_t(bytes.size())) + raw(0x004e4942u) + bytes;
}

/// A pyramid compressed by meshoptimizer's encoders.
std::string meshopt_seed()
{
    return glb_of(
        R"({"asset": {"version": "2.0"}, "extensionsRequired": ["EXT_meshopt_compression"], "nodes": [{"mesh": 0}], "meshes":
  [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}], "accessors": [{"bufferView": 0, "componentType": 5126,
  "count": 5, "type": "VEC3"}, {"bufferView": 1, "componentType": 5125, "count": 18, "type": "SCALAR"}], "bufferViews":
  [{"buffer": 0, "byteLength": 60, "byteStride": 12, "extensions": {"EXT_meshopt_compression": {"buffer": 0, "byteLength": 74,
  "byteStride": 12, "count": 5, "mode": "ATTRIBUTES", "filter": "EXPONENTIAL"}}}, {"buffer": 0, "byteLength": 72, "extensions":
  {"EXT_meshopt_compression": {"buffer": 0, "byteOffset": 74, "byteLength": 26, "byteStride": 4, "count": 18, "mode":
  "TRIANGLES"}}}], "buffers": [{"byteLength": 100}]})",
        from_hex(
            "a000000133000000ffff0133c000007e7d7e0000010cc00000ffff010c0000007e0000000100c0000080000000000000000000"
            "0000000000000000000000000000000000000000000000e0fe100004540f0f0801007687566778a9866589689801690000"));
}

/// A pyramid compressed by both of Draco's encoding methods.
std::string draco_seed()
{
    return glb_of(
        R"({"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"], "nodes": [{"mesh": 0}], "meshes":
  [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0,
  "attributes": {"POSITION": 0}}}}, {"attributes": {"POSITION": 2}, "indices": 3, "extensions": {"KHR_draco_mesh_compression":
  {"bufferView": 1, "attributes": {"POSITION": 0}}}}]}], "accessors": [{"componentType": 5126, "count": 5, "type": "VEC3"},
  {"componentType": 5125, "count": 18, "type": "SCALAR"}, {"componentType": 5126, "count": 5, "type": "VEC3"}, {"componentType":
  5125, "count": 18, "type": "SCALAR"}], "bufferViews": [{"buffer": 0, "byteLength": 97}, {"buffer": 0, "byteOffset": 97,
  "byteLength": 93}], "buffers": [{"byteLength": 190}]})",
        from_hex(
            "445241434f02020101000000050600050000026f0101011001ff000001000903000002010101000f3701400100ffffff0f00fc"
            "ffff3f000000fcff0000000800060000200020000000000000ff3f0000000000000000000000000000000000400e445241434f"
            "0202010000000605010001020103020304020400020003010004030101000903000002000101000903cd0c1735330304e082f8"
            "0700f8030c000414f807000000000000ff0000000000000000000000000000000000004008"));
}

/// A skin, a morph target and every animated property with every interpolation.
std::string animated_seed()
{
    const std::string bytes =
        raw(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}) + raw(std::vector<float>{0, 0.5f, 1}) +
        raw(std::vector<std::uint32_t>(3, 0x01000100u)) +
        raw(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 32767, 0, 0, 9, 0, -9}) +
        raw(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5, 0, 2, 0, 1, 1, 1, 0, 0, 1, 0, 3, 0, 0, 0, 0});
    const std::string json =
        R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0, 1]}], "nodes": [{"mesh": 0, "skin": 0,
  "weights": [0.5]}, {"children": [2], "camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}}, {"mesh": 0}],
  "skins": [{"joints": [1, 2]}], "cameras": [{"type": "perspective", "perspective": {"yfov": 0.7}}], "materials": [{}],
  "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "spot": {}}]}, "KHR_materials_variants": {"variants":
  [{"name": "a"}]}}, "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0, "JOINTS_0": 2, "WEIGHTS_0": 3},
  "material": 0, "targets": [{"POSITION": 0, "NORMAL": 0}], "extensions": {"KHR_materials_variants": {"mappings": [{"material":
  0, "variants": [0]}]}}}]}], "animations": [{"name": "a", "samplers": [{"input": 1, "output": 0}, {"input": 1, "output": 4,
  "interpolation": "STEP"}, {"input": 1, "output": 5, "interpolation": "CUBICSPLINE"}, {"input": 1, "output": 1}], "channels":
  [{"sampler": 0, "target": {"node": 1, "path": "scale"}}, {"sampler": 1, "target": {"node": 2, "path": "rotation"}}, {"sampler":
  2, "target": {"node": 2, "path": "translation"}}, {"sampler": 3, "target": {"node": 0, "path": "weights"}}, {"sampler": 3,
  "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": "/nodes/2/extensions/KHR_node_visibility/visible"
  }}}}, {"sampler": 3, "target": {"path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer":
  "/extensions/KHR_lights_punctual/lights/0/intensity"}}}}, {"sampler": 0, "target": {"path": "pointer", "extensions":
  {"KHR_animation_pointer": {"pointer": "/materials/0/emissiveFactor"}}}}, {"sampler": 3, "target": {"path": "pointer",
  "extensions": {"KHR_animation_pointer": {"pointer": "/cameras/0/perspective/yfov"}}}}]}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}, {"bufferView": 1, "componentType": 5126,
  "count": 3, "type": "SCALAR"}, {"bufferView": 2, "componentType": 5121, "count": 3, "type": "VEC4"}, {"bufferView": 2,
  "componentType": 5121, "count": 3, "type": "VEC4"}, {"bufferView": 3, "componentType": 5122, "count": 3, "type": "VEC4",
  "normalized": true}, {"bufferView": 4, "componentType": 5126, "count": 9, "type": "VEC3"}], "bufferViews":
  [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 12}, {"buffer": 0, "byteOffset": 48,
  "byteLength": 12}, {"buffer": 0, "byteOffset": 60, "byteLength": 24}, {"buffer": 0, "byteOffset": 84, "byteLength": 108}],
  "buffers": [{"byteLength": 192}]})";
    return glb_of(json, bytes);
}

std::vector<std::string> gltf_seeds()
{
    // The buffer holds three vertices and three indices.
    const std::string uri =
        "data:application/octet-stream;base64,"
        "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA";
    const auto text = [](const std::string& buffer) {
        return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 2]}], "nodes": [{"mesh": 0, "children": [1],
  "rotation": [0, 0, 0, 1]}, {"camera": 0, "translation": [0, 0, 5]}, {"mesh": 0, "extensions": {"KHR_node_visibility":
  {"visible": true}, "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}}], "cameras": [{"type": "perspective",
  "perspective": {"yfov": 0.7, "znear": 0.1}}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 0},
  "indices": 1, "material": 0}]}], "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "roughnessFactor":
  0.5}, "alphaMode": "MASK"}], "textures": [{"source": 0}], "images": [{"uri": "a.png"}], "accessors": [{"bufferView": 0,
  "componentType": 5126, "count": 3, "type": "VEC3", "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123},
  "values": {"bufferView": 0}}}, {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}], "bufferViews":
  [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}], "buffers": [{"byteLength": 42)" +
               buffer + "}]}";
    };
    const std::string bytes =
        raw(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}) + raw(std::vector<std::uint16_t>{0, 1, 2, 0});
    return {text(R"(, "uri": ")" + uri + '"'), glb_of(text(""), bytes), meshopt_seed(), draco_seed(), animated_seed()};
}

std::vector<std::string> obj_seeds()
{
    return {
        "o a\nv 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/1/1 4\n"
        "f -1//-1 -2//1 -3 \\\n -4\np 1 2\nl 1 2\ng b\ns 1\nmtllib none.mtl\n",
        "v 0 0 0\nv 1 2 3\n"};
}

std::vector<std::string> mtl_seeds()
{
    return {
        "newmtl a\nKd 0.5 0.25 1\nKs 1\nNs 20\nd 0.5\nillum 2\nmap_Kd -s 2 2 -o 0.5 0 -clamp on a b.png\nbump -bm 2 "
        "h.png\n"
        "newmtl b\nPr 0.3\nPm 1\nKe 1 1 1\nmap_d a.png\nnorm n.png\nTr 0.2\nKa spectral x.rfl\n"};
}

std::vector<std::string> ply_seeds()
{
    const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
    const auto header = [&](const std::string& format) {
        return "ply\nformat " + format + " 1.0\nelement vertex 3\n" + xyz +
               "property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    };
    std::string body;
    for (int i = 0; i < 3; ++i) body += raw(std::vector<float>{float(i), float(i == 2), 0}) + char(7);
    body += '\3' + raw(std::vector<std::int32_t>{0, 1, 2});
    return {header("ascii") + "0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n", header("binary_little_endian") + body,
            header("binary_big_endian") + body,
            "ply\nformat ascii 1.0\nelement vertex 2\n" + xyz + "end_header\n0 0 0\n1 2 3\n"};
}

std::vector<std::string> stl_seeds()
{
    const std::string triangle = raw(std::vector<float>{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) + std::string(2, '\0');
    return {
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
        "0\nendloop\nendfacet\nendsolid\n",
        std::string(80, ' ') + raw(2u) + triangle + triangle};
}

/// Bytes of a file written by `write(path)`.
template <class Write>
std::string written(const std::string& extension, Write write)
{
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("fathom_fuzz_" + std::to_string(getpid()) + extension);
    write(file);
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    std::filesystem::remove(file);
    return bytes;
}

std::string written(const Image& image, const std::string& extension, const WriteOptions& options = {})
{
    return written(extension, [&](const std::filesystem::path& file) { write_image(file, image, options); });
}

Image small_image(int width, int height)
{
    Image image;
    image.width = width;
    image.height = height;
    image.layers.push_back({"", {"R", "G", "B", "A"}, {}});
    for (int i = 0; i < width * height * 4; ++i) image.layers[0].pixels.push_back(float(i % 7) / 7);
    return image;
}

std::vector<std::string> image_seeds()
{
    const Image image = small_image(5, 4);
    WriteOptions halves;
    halves.exr_half = true;
    halves.png_bits = 16;
    return {written(image, ".png"),         written(image, ".png", halves), written(image, ".exr"),
            written(image, ".exr", halves), written(image, ".jpg"),         written(image, ".hdr"),
            written(image, ".webp"),        written(image, ".avif"),        "P6 2 2 255 abcdefghijkl"};
}

std::string film_seed(const RenderSettings& settings, const WriteOptions& options)
{
    FilmKey key;
    key.settings = settings;
    key.settings.width = 3;
    key.settings.height = 2;
    key.scene = std::string(32, '0');
    Film film(key);
    film.data().add_range({0, 4});
    film.data().add_range({8, 9});
    for (std::size_t i = 0; i < film.data().words.size(); ++i) film.data().words[i] = std::uint32_t(i % 3);
    const Image image = film.image(settings.alpha, true);
    return written(".exr", [&](const auto& file) { write_film(file, film, image, options); });
}

/// A minimal film file, and one with every optional part.
std::vector<std::string> film_seeds()
{
    RenderSettings all;
    all.alpha = true;
    all.aovs = {Aov::albedo, Aov::normal, Aov::depth, Aov::position, Aov::instance_id, Aov::material_id};
    WriteOptions half;
    half.exr_half = true;
    return {film_seed({}, {}), film_seed(all, half)};
}

std::vector<std::string> pbrt_seeds()
{
    return {
        R"(LookAt 0 0 -5 0 0 0 0 1 0 Camera "perspective" "float fov" 40 "float lensradius" .1 "float focaldistance" [ 3 ]
Film "rgb" "integer xresolution" [ 8 ] "integer yresolution" 6 "float iso" 200 Sampler "halton" "integer pixelsamples" 4
PixelFilter "box" Integrator "volpath" "integer maxdepth" 5 ColorSpace "aces2065-1"
WorldBegin # a comment
Texture "c" "spectrum" "checkerboard" "rgb tex1" [ 1 0 0 ] "float uscale" 4 "float vscale" 2
Texture "f" "float" "fbm" "integer octaves" 4
Texture "m" "spectrum" "mix" "texture tex1" "c" "rgb tex2" [ 0 1 0 ] "texture amount" "f"
MakeNamedMaterial "a" "string type" "coateddiffuse" "texture reflectance" "m" "float roughness" .1
MakeNamedMaterial "b" "string type" "conductor" "spectrum eta" [ 400 1 700 2 ] "spectrum k" [ 400 3 700 2 ]
MakeNamedMedium "g" "string type" "homogeneous" "rgb sigma_a" [ 1 2 3 ] "rgb sigma_s" [ 0 0 1 ]
LightSource "infinite" "blackbody L" 5000 "float illuminance" 10
LightSource "projection" "string filename" "a.png" "float power" 3
LightSource "spot" "rgb I" [ 1 2 3 ] "point3 from" [ 0 5 0 ] "float power" 10
AttributeBegin AreaLightSource "diffuse" "spectrum L" [ 300 1 800 2 ] "bool twosided" true "float power" 5
 Translate 0 1e1 0 Shape "disk" "float radius" 2 AttributeEnd
ObjectBegin "o" NamedMaterial "a" Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ] "point2 uv" [ 0 0 1 0 1 1 ]
 "normal N" [ 0 0 1 0 0 1 0 0 1 ] "integer indices" [ 0 1 2 ] "texture alpha" "f" ObjectEnd
Rotate 30 0 1 0 ObjectInstance "o" ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 1 1 1 1 ] ObjectInstance "o"
Material "hair" "float eumelanin" .3 "float beta_m" .2 "texture beta_n" "f" "float alpha" 3 "float eta" 1.4
Shape "curve" "point3 P" [ 0 0 0 1 0 0 2 0 0 3 0 0 ] "float width" .1
ReverseOrientation MediumInterface "g" "" Material "dielectric" "spectrum eta" "glass-BK7" Shape "sphere" "float zmin" 0
Attribute "shape" "float radius" 3 Shape "cylinder" "float phimax" 90
NamedMaterial "b" Shape "bilinearmesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 1 1 1 ]
Shape "curve" "point3 P" [ 0 0 0 1 0 0 2 0 0 3 0 0 ] "float width" .1 "string type" "cylinder"
Shape "loopsubdiv" "integer levels" 1 "point3 P" [ 0 0 0 1 0 0 0 1 0 ] "integer indices" [ 0 1 2 ]
ActiveTransform EndTime Translate 1 0 0 ActiveTransform All Shape "sphere" Option "seed" 3)"};
}
std::vector<std::string> mitsuba_seeds()
{
    return {
        R"(<?xml version="1.0"?><scene version="3.0.0"><default name="spp" value="4"/><integrator type="path"><integer name="max_depth"
 value="5"/></integrator><sensor type="thinlens"><float name="fov" value="40"/><string name="fov_axis" value="larger"/>
 <float name="aperture_radius" value="0.1"/><float name="focus_distance" value="3"/><transform name="to_world"><lookat
 origin="0,0,5" target="0,0,0" up="0,1,0"/></transform><film type="hdrfilm"><integer name="width" value="8"/><integer
 name="height" value="6"/><rfilter type="box"/></film><sampler type="independent"><integer name="sample_count" value="$spp"/>
 </sampler></sensor><bsdf type="twosided" id="a"><bsdf type="roughplastic"><rgb name="diffuse_reflectance" value="0.1 0.2 0.3"/>
 <float name="alpha" value="0.1"/><string name="distribution" value="ggx"/><boolean name="nonlinear" value="true"/></bsdf></bsdf>
 <bsdf type="hair" id="h"><rgb name="sigma_a" value="1 2 3"/><float name="scale" value="2"/><float name="scale_tilt" value="3"/></bsdf>
 <bsdf type="mask" id="b"><float name="opacity" value="0.5"/><bsdf type="roughconductor"><spectrum name="eta" value="400:1,700:2"/>
 <rgb name="k" value="3"/><float name="alpha_u" value="0.1"/><float name="alpha_v" value="0.2"/></bsdf></bsdf>
 <shape type="shapegroup" id="g"><shape type="sphere"><ref id="a"/></shape></shape><shape type="instance"><ref id="g"/>
 <transform name="to_world"><rotate y="1" angle="30"/><scale value="2"/><translate x="1"/></transform></shape><shape type="rectangle">
 <ref id="b"/><emitter type="area"><rgb name="radiance" value="1 2 3"/></emitter></shape><shape type="cylinder"><bsdf type="dielectric">
 <string name="int_ior" value="water"/></bsdf><medium name="interior" type="homogeneous"><float name="sigma_t" value="2"/></medium>
 </shape><emitter type="sunsky"><vector name="sun_direction" x="0" y="1" z="1"/></emitter><alias id="a" as="c"/><emitter type="spot"/><emitter type="projector"><float name="fov" value="40"/>
 <rgb name="irradiance" value="1 2 3"/></emitter>
 <shape type="cube"><bsdf type="blendbsdf"><float name="weight" value="0.2"/><ref id="c"/><bsdf type="principled"><texture
 type="checkerboard" name="base_color"/></bsdf></bsdf></shape></scene>)"};
}

std::vector<std::string> serialized_seeds()
{
    // The file has two meshes of format version 4: a triangle with normals and texture coordinates, and one in doubles.
    using test::deflated;
    const std::string sign = {0x1c, 0x04, 4, 0};
    const auto counts = raw(std::vector<std::uint64_t>{3, 1}), indices = raw(std::vector<std::uint32_t>{0, 1, 2});
    const std::string first =
        sign + deflated(raw(0x1003u) + std::string("a\0", 2) + counts + raw(std::vector<float>(24, 0.5f)) + indices);
    const std::string second =
        sign + deflated(raw(0x2000u) + std::string(1, 0) + counts + raw(std::vector<double>(9, 0.5)) + indices);
    return {first + second + raw(std::vector<std::uint64_t>{0, first.size()}) + raw(2u)};
}

std::vector<std::string> ies_seeds()
{
    const std::string numbers =
        "1 1000 1.5\n4 3 1 1 0.1 0.1 0.1\n1 1 60\n0 20 45 90\n0 45 90\n3 2.8 1 0.2\n3 2.5 1.6 0.3\n3 1 0.4 0\n";
    return {"IESNA:LM-63-2002\n[TEST] a\nTILT=NONE\n" + numbers,
            "IESNA91\nTILT=INCLUDE\n1\n2\n0 90\n1 0.9\n" + numbers};
}

std::vector<std::string> measured_seeds()
{
    // The data of all arrays, one after another, in sizes that follow from their shapes.
    struct Field {
        std::string name;
        std::vector<std::uint64_t> shape;
    };
    const auto file = [](const std::vector<Field>& fields) {
        std::string header = std::string("tensor_file\0\1\0", 14) + raw(std::uint32_t(fields.size())), data;
        std::size_t size = header.size();
        for (const Field& f : fields) size += 13 + f.name.size() + 8 * f.shape.size();
        for (const Field& f : fields) {
            const auto offset = std::uint64_t(size + data.size());
            header += raw(std::vector<std::uint16_t>{std::uint16_t(f.name.size())}) + f.name;
            header += raw(std::vector<std::uint16_t>{std::uint16_t(f.shape.size())}) + char(10);
            header += raw(std::vector<std::uint64_t>{offset}) + raw(f.shape);
            std::size_t count = 1;
            for (const std::uint64_t n : f.shape) count *= n;
            for (std::size_t i = 0; i < count; ++i) data += raw(std::vector<float>{float(i)});
        }
        return header + data;
    };
    const std::vector<Field> shared = {{"phi_i", {1}},    {"theta_i", {2}},       {"ndf", {2, 2}},
                                       {"sigma", {2, 3}}, {"vndf", {1, 2, 3, 2}}, {"luminance", {1, 2, 2, 2}}};
    std::vector<Field> colors = shared, spectra = shared;
    colors.push_back({"rgb", {1, 2, 3, 2, 2}});
    spectra.push_back({"spectra", {1, 2, 2, 2, 2}}), spectra.push_back({"wavelengths", {2}});
    return {file(colors), file(spectra)};
}

constexpr Target all[] = {{"fathom-json", read_scene<fathom_json_importer>, json_seeds},
                          {"gltf", read_scene<gltf_importer>, gltf_seeds},
                          {"obj", read_scene<obj_importer>, obj_seeds},
                          {"mtl", read_materials, mtl_seeds},
                          {"ply", read_scene<ply_importer>, ply_seeds},
                          {"stl", read_scene<stl_importer>, stl_seeds},
                          {"mitsuba", read_scene<mitsuba_importer>, mitsuba_seeds},
                          {"pbrt", read_scene<pbrt_importer>, pbrt_seeds},
                          {"serialized", read_serialized, serialized_seeds},
                          {"image", read_picture, image_seeds},
                          {"ies", read_profile, ies_seeds},
                          {"measured", read_surface, measured_seeds},
                          {"film", read_film, film_seeds}};

}  // namespace

std::span<const Target> targets()
{
    return all;
}

}  // namespace fathom::fuzz
