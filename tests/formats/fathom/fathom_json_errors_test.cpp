// SPDX-License-Identifier: Apache-2.0
#include "formats/import_test_helpers.h"
#include "scene/material_table.h"

namespace fathom::test {
namespace {

class FathomJsonErrors : public ImportTest {};

TEST_F(FathomJsonErrors, Files)
{
    EXPECT_EQ(error_of(folder_ / "none.json"), "no such file");
    EXPECT_EQ(error_of(folder_), "is a directory, not a file");
    EXPECT_EQ(error_of("empty.json", ""), "the file is empty");
    EXPECT_EQ(error_of(std::filesystem::path("/dev/zero")), "is a device, not a file");
}

TEST_F(FathomJsonErrors, Syntax)
{
    EXPECT_EQ(error_of("a.json", "{\n  \"scene\": [\n  ,]\n}"),
              "line 3, column 3: not JSON: unexpected ','; expected '[', '{', or a literal");
    EXPECT_EQ(error_of("b.json", "{\"scene\": ["),
              "line 1, column 12: not JSON: the file is truncated: unexpected end of input; expected '[', '{', or a "
              "literal");
    EXPECT_EQ(error_of("c.json", R"({"materials": {"red": {}, "red": {}}})"),
              "line 1, column 27: key 'red' appears twice in one object");
    EXPECT_EQ(error_of("d.json", R"({"scene": [1e999]})"),
              "line 1, column 12: not JSON: number overflow parsing '1e999'");
    EXPECT_EQ(error_of("e.json", "[]"), "expected an object, found an array");
    EXPECT_NE(error_of("f.json", R"({"scene": [NaN]})").find("line 1, column"), std::string::npos);
}

TEST_F(FathomJsonErrors, KindsAreListed)
{
    std::string known;
    for (const auto& kind : material_kinds()) known += (known.empty() ? "" : ", ") + std::string(kind.name);
    const std::string some =
        "diffuse, metal, fuzz_metal, glass, plastic, hair, principled, disney, measured, unlit, none, mix, two_sided";
    EXPECT_EQ(known.substr(0, some.size()), some);
    EXPECT_EQ(error_of("scene.json", R"({"materials": {"a/b~c": {"kind": "mirror"}}})"),
              "/materials/a~1b~0c/kind: unknown value 'mirror'; known here: " + known);
}

struct Case {
    const char* json;
    const char* error;
};

class FathomJsonError : public ImportTest, public ::testing::WithParamInterface<Case> {};

TEST_P(FathomJsonError, Message)
{
    EXPECT_EQ(error_of("scene.json", GetParam().json), GetParam().error);
}

INSTANTIATE_TEST_SUITE_P(
    Keys, FathomJsonError,
    ::testing::Values(
        Case{R"({"materials": {"red": {"colr": [1, 0, 0]}}})",
             "/materials/red/colr: unknown key 'colr' in a material of kind 'diffuse'; did you mean 'color'?"},
        Case{R"({"materials": {"m": {"kind": "fuzz_metal", "ior": 1}}})",
             "/materials/m/ior: unknown key 'ior' in a material of kind 'fuzz_metal'; known here: kind, color, fuzz, "
             "emission, emission_two_sided, normal_map, map_tangents, normal_scale, bump, displacement, "
             "displacement_midlevel, displacement_edge_length, alpha, alpha_mode, alpha_cutoff, black_behind, "
             "single_sided, hidden_from_camera, invisible_light, use_vertex_color, emission_unit"},
        Case{R"({"materials": {"m": {"kind": "metal", "conductor": "gild"}}})",
             "/materials/m/conductor: unknown value 'gild'; did you mean 'gold'?"},
        Case{R"({"materials": {"m": {"kind": "principled", "conductor": "gold", "metallic": 1}}})",
             "/materials/m/conductor: replaces 'metallic': give only one of them"},
        Case{R"({"sceen": []})", "/sceen: unknown key 'sceen' in a scene; did you mean 'scene'?"},
        Case{R"({"fathom": 2})", "/fathom: format 2 is not supported; this version reads format 1"}));

INSTANTIATE_TEST_SUITE_P(
    Types, FathomJsonError,
    ::testing::Values(
        Case{R"({"camera": {"position": "here"}})", "/camera/position: expected an array of 3 numbers, found a string"},
        Case{R"({"camera": {"position": [1, 2]}})", "/camera/position: expected 3 numbers, found 2"},
        Case{R"({"camera": {"position": [1, 2, null]}})", "/camera/position/2: expected a number, found null"},
        Case{R"({"materials": {"m": {"color": true}}})",
             "/materials/m/color: expected a color: 3 numbers or one for gray, found true or false"},
        Case{R"({"materials": {"m": {"color": [1, 0, 2]}}})",
             "/materials/m/color: a reflectance above 1 would violate energy conservation"},
        Case{R"({"materials": {"m": {"color": [1, -0.1, 0]}}})", "/materials/m/color: a color can't be negative"},
        Case{R"({"materials": {"m": {"roughness": 1.5}}})",
             "/materials/m/roughness: must be between 0 and 1, found 1.5"},
        Case{R"({"render": {"size": [0, 600]}})", "/render/size/0: an image must be at least 1 pixel wide and high"},
        Case{R"({"render": {"samples": 2.5}})", "/render/samples: expected a whole number, found 2.5"},
        Case{R"({"render": {"samples": 0}})", "/render/samples: must be at least 1, found 0"},
        Case{R"({"render": {"filter": "boxx"}})", "/render/filter: unknown value 'boxx'; did you mean 'box'?"},
        Case{R"({"camera": {"fov_y_deg": 180}})", "/camera/fov_y_deg: must be between 0 and 180, found 180"},
        Case{R"({"camera": {"look_at": [0, 0, 0]}})", "/camera: 'position' and 'look_at' are the same point"},
        Case{R"({"camera": {"up": [0, 0, 2]}})", "/camera: 'up' must not be zero or parallel to the view direction"},
        Case{R"({"camera": {"shutter": [1, 0]}})", "/camera/shutter: the shutter closes before it opens"},
        Case{R"({"scene": [{"mesh": {"positions": [[0, 0, 1e39], [0, 0, 0], [0, 0, 0]]}}]})",
             "/scene/0/mesh/positions/0/2: 1e+39 is too large"}));

INSTANTIATE_TEST_SUITE_P(
    References, FathomJsonError,
    ::testing::Values(
        Case{R"({"materials": {"red": {}}, "scene": [{"sphere": {}, "material": "rde"}]})",
             "/scene/0/material: there is no material named 'rde'; did you mean 'red'?"},
        Case{R"({"scene": ["ball"]})", "/scene/0: there is no node named 'ball'"},
        Case{R"({"nodes": {"a": {"children": ["b"]}, "b": {"children": [{"instance": "a"}]}}, "scene": ["a"]})",
             "/nodes/b/children/0/instance: a node can't contain itself: a > b > a"},
        Case{R"({"materials": {"m": {"color": "wood"}}})", "/materials/m/color: there is no texture named 'wood'"},
        Case{R"({"scene": [{"mesh": {"positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "indices": [[0, 1, 3]]}}]})",
             "/scene/0/mesh/indices/0/2: index 3 is out of range: there are 3 positions"},
        Case{R"({"scene": [{"mesh": {"positions": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "uvs": [[0, 1]]}}]})",
             "/scene/0/mesh/uvs: expected 3 elements, one for each of 'positions', found 1"}));

INSTANTIATE_TEST_SUITE_P(
    Shapes, FathomJsonError,
    ::testing::Values(
        Case{R"({"scene": [{"sphere": {"radius": 0}}]})", "/scene/0/sphere/radius: must not be 0"},
        Case{R"({"scene": [{"box": {"min": [0, 0, 0], "max": [1, 0, 1]}}]})",
             "/scene/0/box: 'min' must be less than 'max' along each axis"},
        Case{R"({"scene": [{"rectangle": {"corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [2, 0, 0]}}]})",
             "/scene/0/rectangle: the edges are parallel, or one of them has zero length"},
        Case{R"({"scene": [{"rectangle": {"corner": [0, 0, 0]}}]})", "/scene/0/rectangle: key 'edge_u' is missing"},
        Case{R"({"scene": [{"disk": {"normal": [0, 0, 0]}}]})", "/scene/0/disk/normal: must not have zero length"},
        Case{R"({"scene": [{"sphere": {}, "box": {"min": [0, 0, 0], "max": [1, 1, 1]}}]})",
             "/scene/0/box: a node can have only one shape; put others into 'children'"},
        Case{R"({"scene": [{"sphere": {}, "transform": {"scale": 0}}]})",
             "/scene/0/transform/scale: a scale of 0 flattens the object; use a rectangle or disk"},
        Case{R"({"scene": [{"sphere": {}, "transform": {"matrix": [[1, 0, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0]]}}]})",
             "/scene/0/transform/matrix: the matrix can't be inverted"},
        Case{R"({"lights": {"l": {"kind": "spot", "inner_angle_deg": 50}}})",
             "/lights/l: 'outer_angle_deg' must be greater than 0 and not less than 'inner_angle_deg'"},
        Case{R"({"lights": {"l": {"kind": "point", "unit": "lx"}}})",
             "/lights/l/unit: unknown value 'lx'; known here: cd, lm, W/sr, W"}));

TEST_F(FathomJsonErrors, Models)
{
    EXPECT_EQ(error_of("a.json", R"({"scene": [{"model": "gone.glb"}]})"),
              "/scene/0/model: no such file: '" + (folder_ / "gone.glb").string() + "'");
    const std::string self = R"({"scene": [{"model": "self.json"}]})";
    EXPECT_EQ(error_of("self.json", self), "a scene can't contain itself: this file is being read already");
    write("part.json", R"({"materials": {"wood": {}}, "scene": [{"sphere": {}, "material": "wood"}]})");
    EXPECT_EQ(error_of("b.json", R"({"scene": [{"model": "part.json", "materials": {"wod": {}}}]})"),
              "/scene/0/materials/wod: the model has no material named 'wod'; did you mean 'wood'?");
}

TEST_F(FathomJsonErrors, DeepNesting)
{
    std::string deep = "{}";
    for (int i = 0; i < 1000; ++i) deep = R"({"children": [)" + deep + "]}";
    const std::string error = error_of("deep.json", R"({"scene": [)" + deep + "]}");
    EXPECT_NE(error.find("nodes are nested more than 200 deep"), std::string::npos) << error;
    EXPECT_NE(error_of("brackets.json", std::string(1000000, '[')), "loaded");
    EXPECT_NE(error_of("both.json", R"({"scene": )" + std::string(100000, '[') + std::string(100000, ']') + "}"),
              "loaded");
}

TEST_F(FathomJsonErrors, EveryTruncationIsAnError)
{
    std::ifstream in(FATHOM_SCENES "/cornell-box.json", std::ios::binary);
    const std::string whole((std::istreambuf_iterator<char>(in)), {});
    const std::size_t end = whole.rfind('}');
    for (std::size_t size = 0; size <= end; ++size) {
        const std::string error = error_of("cut.json", whole.substr(0, size));
        EXPECT_TRUE(error == "the file is empty" || error.starts_with("line ")) << size << ": " << error;
    }
}

}  // namespace
}  // namespace fathom::test
