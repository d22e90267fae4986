// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "formats/import_test_helpers.h"
#include "gltf_builder.h"

namespace fathom::test {
namespace {

class GltfErrors : public ImportTest {};

std::string read_whole(const std::filesystem::path& path)
{
    std::ifstream in(path, std::ios::binary);
    return std::string((std::istreambuf_iterator<char>(in)), {});
}

TEST_F(GltfErrors, Containers)
{
    EXPECT_EQ(error_of("a.gltf", ""), "the file is empty");
    EXPECT_EQ(error_of("a.gltf", "{\"asset\": "),
              "line 1, column 11: not JSON: the file is truncated: unexpected end of input; expected '[', '{', or a "
              "literal");
    EXPECT_EQ(error_of("a.gltf", "{}"), "this is not glTF 2.0: 'asset' is missing");
    EXPECT_EQ(error_of("a.gltf", R"({"asset": {"version": "1.0"}})"),
              "asset.version: glTF 1.0 is not supported, only 2.0");
    EXPECT_EQ(error_of("a.glb", "glTF"), "GLB header: the file ends after 4 bytes");
    EXPECT_EQ(error_of("a.glb", std::string("glTF\1\0\0\0\x20\0\0\0\0\0\0\0\0\0\0\0", 20)),
              "GLB header: version 1 is not supported, only 2");
    EXPECT_EQ(error_of("a.glb", std::string("glTF\2\0\0\0\x20\0\0\0\0\0\0\0\0\0\0\0", 20)),
              "GLB header: the file ends after 20 bytes; its header says 32");
    EXPECT_EQ(error_of("a.glb", std::string("glTF\2\0\0\0\x14\0\0\0\xff\xff\xff\xffJSON", 20)),
              "GLB header: chunk 0 of 4294967295 bytes does not fit into the file's 20");
    EXPECT_EQ(error_of("a.gltf", R"({"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_x", "KHR_y"]})"),
              "extensionsRequired[0]: the file requires KHR_x, which is not supported");
}

/// A file with one primitive whose POSITION is accessor 0, and the expected error.
struct WrongFile {
    const char* accessors;
    const char* views;
    const char* error;
};
class GltfAccessorError : public ImportTest, public ::testing::WithParamInterface<WrongFile> {};

TEST_P(GltfAccessorError, Message)
{
    const std::string gltf =
        fmt::format(R"({{"asset": {{"version": "2.0"}}, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}], "accessors": [{}], "bufferViews": [{}],
        "buffers": [{{"byteLength": 36, "uri": "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}]}})",
                    GetParam().accessors, GetParam().views);
    EXPECT_EQ(error_of("a.gltf", gltf), GetParam().error);
}

#define GOOD_VIEW R"({"buffer": 0, "byteLength": 36})"
#define INDICES R"({"componentType": 5121, "count": 3, "type": "SCALAR"})"

INSTANTIATE_TEST_SUITE_P(
    All, GltfAccessorError,
    ::testing::Values(
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"})", GOOD_VIEW,
                  "meshes[0].primitives[0].indices: there is no accessors[1]: the file has 1"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},)" INDICES, GOOD_VIEW,
                  "accessors[0]: 4 elements of 12 bytes from offset 0 on do not fit into the view's 36 bytes"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "byteOffset": 1},)" INDICES,
                  GOOD_VIEW,
                  "accessors[0]: 3 elements of 12 bytes from offset 1 on do not fit into the view's 36 bytes"},
        WrongFile{
            R"({"bufferView": 0, "componentType": 5126, "count": 9007199254740992, "type": "VEC3"},)" INDICES,
            GOOD_VIEW,
            "accessors[0]: 9007199254740992 elements of 12 bytes from offset 0 on do not fit into the view's 36 bytes"},
        WrongFile{
            R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "byteOffset": 9007199254740992},)" INDICES,
            GOOD_VIEW,
            "accessors[0]: 3 elements of 12 bytes from offset 9007199254740992 on do not fit into the view's 36 bytes"},
        WrongFile{R"({"componentType": 5126, "count": 9007199254740992, "type": "VEC3"},)" INDICES, GOOD_VIEW,
                  "accessors[0].count: 9007199254740992 elements without a bufferView are too many"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": -3, "type": "VEC3"},)" INDICES, GOOD_VIEW,
                  "accessors[0].count: expected a whole number of at least 0, found -3"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": 0, "type": "VEC3"},)" INDICES, GOOD_VIEW,
                  "accessors[0].count: must be at least 1"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "type": "VEC3"},)" INDICES, GOOD_VIEW,
                  "accessors[0]: key 'count' is missing"},
        WrongFile{R"({"bufferView": 0, "componentType": 5124, "count": 3, "type": "VEC3"},)" INDICES, GOOD_VIEW,
                  "accessors[0].componentType: 5124 is not a component type"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC9"},)" INDICES, GOOD_VIEW,
                  "accessors[0].type: must be SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"},)" INDICES, GOOD_VIEW,
                  "accessors[0]: positions must be VEC3"},
        WrongFile{R"({"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},)" INDICES, GOOD_VIEW,
                  "accessors[0].bufferView: there is no bufferViews[1]: the file has 1"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},)" INDICES,
                  R"({"buffer": 0, "byteLength": 37})",
                  "bufferViews[0]: bytes 0 to 37 are not in the buffer, which has 36 bytes"},
        WrongFile{
            R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},)" INDICES,
            R"({"buffer": 0, "byteLength": 36, "byteOffset": 9007199254740992})",
            "bufferViews[0]: bytes 9007199254740992 to 9007199254741028 are not in the buffer, which has 36 bytes"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},)" INDICES,
                  R"({"buffer": 0, "byteLength": 36, "byteStride": 8})",
                  "accessors[0]: elements of 12 bytes overlap: the view's stride is 8"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},)" INDICES,
                  R"({"buffer": 2, "byteLength": 36})",
                  "bufferViews[0].buffer: there is no buffers[2]: the file has 1"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                {"bufferView": 0, "componentType": 5123, "count": 3, "type": "SCALAR", "byteOffset": 14})",
                  GOOD_VIEW, "accessors[1]: index 16256 is out of range: there are 3 vertices"},
        WrongFile{R"({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                {"bufferView": 0, "componentType": 5126, "count": 3, "type": "SCALAR"})",
                  GOOD_VIEW, "accessors[1]: indices must be unsigned integers"},
        WrongFile{
            R"({"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {"count": 1, "indices": {"bufferView": 0,
                "componentType": 5123, "byteOffset": 14}, "values": {"bufferView": 0}}},)" INDICES,
            GOOD_VIEW, "accessors[0].sparse.indices: index 16256 is out of range: there are 3 elements"}));

TEST_F(GltfErrors, Graph)
{
    const auto with = [](const std::string& members) { return R"({"asset": {"version": "2.0"}, )" + members + "}"; };
    EXPECT_EQ(error_of("a.gltf", with(R"("scenes": [{"nodes": [1]}], "nodes": [{}])")),
              "scenes[0].nodes[0]: there is no nodes[1]: the file has 1");
    EXPECT_EQ(error_of("a.gltf", with(R"("scene": 3, "scenes": [{}])")),
              "scene: there is no scenes[3]: the file has 1");
    EXPECT_EQ(
        error_of("a.gltf", with(R"("scenes": [{"nodes": [0]}], "nodes": [{"children": [1]}, {"children": [0]}])")),
        "nodes[1].children[0]: a node can't contain itself");
    EXPECT_EQ(error_of("a.gltf", with(R"("nodes": [{"children": [2]}, {"children": [2]}, {}])")),
              "nodes[1].children[0]: nodes[2] has two parents");
    EXPECT_EQ(error_of("a.gltf", with(R"("nodes": [{"mesh": 0}])")),
              "nodes[0].mesh: there is no meshes[0]: the file has 0");
    EXPECT_EQ(error_of("a.gltf", with(R"("nodes": [{"translation": [1, 2]}])")),
              "nodes[0].translation: expected 3 numbers, found 2");
    EXPECT_EQ(error_of("a.gltf", with(R"("nodes": [{"matrix": 5}])")),
              "nodes[0].matrix: expected an array of 16 numbers, found a number");
    EXPECT_EQ(error_of("a.gltf", with(R"("nodes": {})")), "nodes: expected an array, found an object");
    EXPECT_EQ(error_of("a.gltf",
                       with(R"("nodes": [{"camera": 0}], "cameras": [{"type": "perspective", "perspective": {}}])")),
              "cameras[0].perspective: key 'yfov' is missing");
}

TEST_F(GltfErrors, Buffers)
{
    GltfBuilder b;
    const std::string primitive = fmt::format(R"("attributes": {{"POSITION": {}}})", b.triangle());
    std::string gltf = b.one_primitive(primitive);
    const auto with_uri = [&](const std::string& uri) {
        std::string changed = gltf;
        const std::size_t at = changed.find("data:"), end = changed.find('"', at);
        return changed.replace(at, end - at, uri);
    };
    EXPECT_EQ(error_of("a.gltf", with_uri("gone.bin")), "buffers[0].uri: 'gone.bin': no such file");
    EXPECT_EQ(error_of("a.gltf", with_uri("http://example.com/a.bin")),
              "buffers[0].uri: only files and data URIs can be read");
    EXPECT_EQ(error_of("a.gltf", with_uri("data:;base64,@@@@")), "buffers[0].uri: the data URI is damaged");
    write("short.bin", "1234567890");
    EXPECT_EQ(error_of("a.gltf", with_uri("short.bin")), "buffers[0]: expected 36 bytes, found 10");
    write("b.bin", std::string(36, '\xff'));
    EXPECT_EQ(error_of("a.gltf", with_uri("b.bin")), "meshes[0].positions[0]: is not finite");
}

TEST_F(GltfErrors, EveryTruncationOfAGlb)
{
    const std::string whole = read_whole(FATHOM_SCENES "/models/chess.glb");
    ASSERT_GT(whole.size(), 1000u);
    for (std::size_t size = 0; size < whole.size(); size += size < 6000 ? 7 : 2001)
        EXPECT_NE(error_of("cut.glb", whole.substr(0, size)), "loaded") << size;
}

TEST_F(GltfErrors, DamagedBytesNeverCrash)
{
    const std::string whole = read_whole(FATHOM_SCENES "/models/chess.glb");
    std::mt19937 random(1);
    for (int i = 0; i < 300; ++i) {
        std::string damaged = whole;
        // Most of the JSON is at the front, where damage has the most effect.
        for (int k = 0; k < 3; ++k) damaged[random() % (i % 2 ? 7000 : damaged.size())] = char(random());
        error_of("damaged.glb", damaged);
    }
}

TEST_F(GltfErrors, DamagedNumbersNeverCrash)
{
    GltfBuilder b;
    const int positions = b.triangle();
    const int indices = b.accessor(b.view<std::uint8_t>({2, 1, 0}), 5121, 3, "SCALAR");
    const std::string good = b.one_primitive(
        fmt::format(R"("indices": {}, "attributes": {{"POSITION": {}}}, "mode": 5)", indices, positions));
    EXPECT_EQ(error_of("good.gltf", good), "loaded");
    const std::string strange[] = {
        "-1",    "0.5", "1e30", "4294967295", "4294967296", "18446744073709551615", "9007199254740991", "null",
        "\"x\"", "[]",  "{}",   "true",       "2147483648"};
    for (std::size_t at = 0; at < good.size(); ++at) {
        if (!std::isdigit(static_cast<unsigned char>(good[at])) || good[at - 1] != ' ') continue;
        std::size_t end = at;
        while (std::isdigit(static_cast<unsigned char>(good[end]))) ++end;
        for (const std::string& number : strange) {
            std::string changed = good;
            error_of("changed.gltf", changed.replace(at, end - at, number));
        }
    }
}

}  // namespace
}  // namespace fathom::test
