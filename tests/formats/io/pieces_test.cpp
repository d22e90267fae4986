// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <map>
#include <sstream>
#include <thread>

#include "fathom/threads.h"
#include "formats/import_test_helpers.h"
#include "formats/io/input_window.h"
#include "formats/mesh/mesh_fault_counts.h"
#include "formats/obj/line_blocks.h"
#include "formats/obj/obj_piece.h"

// Files larger than the read buffer: the result doesn't depend on where the buffer's windows end.
namespace fathom::test {
namespace {

class Pieces : public ImportTest {};

/// Pseudorandom numbers, the same on every run.
class RandomNumbers {
public:
    std::uint32_t operator()(std::uint32_t below)
    {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return std::uint32_t((state_ >> 33) % below);
    }

private:
    std::uint64_t state_ = 1;
};

/// A corner of a triangle: position, texture coordinates, normal.
using Corner = std::array<float, 8>;
using Triangles = std::vector<std::array<Corner, 3>>;

Triangles triangles_of(const SceneDescription& scene, const std::string& name)
{
    Triangles all;
    for (const Mesh& mesh : scene.meshes) {
        if (mesh.name != name) continue;
        for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
            auto& triangle = all.emplace_back();
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t v = mesh.indices[i + k];
                const Vec3f p = mesh.positions[v];
                const Vec2f t = mesh.uvs[0].empty() ? Vec2f{0, 0} : mesh.uvs[0][v];
                const Vec3f n = mesh.normals.empty() ? Vec3f{0, 0, 0} : mesh.normals[v];
                triangle[k] = {p.x, p.y, p.z, t.x, t.y, n.x, n.y, n.z};
            }
        }
    }
    return all;
}

/// A large OBJ file with all kinds of lines, and the triangles it describes.
struct Large {
    std::string text;
    std::map<std::string, Triangles> objects;
};

Large large_obj(int patches)
{
    Large file;
    RandomNumbers chance;
    std::vector<std::array<float, 3>> positions, normals;
    std::vector<std::array<float, 2>> uvs;
    std::string object = "start";
    file.text = "o start\n";
    const auto corner = [&](std::size_t p, std::size_t t, std::size_t n) {
        return Corner{positions[p][0], positions[p][1], positions[p][2], uvs[t][0],
                      1 - uvs[t][1],   normals[n][0],   normals[n][1],   normals[n][2]};
    };
    for (int patch = 0; patch < patches; ++patch) {
        if (chance(50) == 0) {
            object = fmt::format("part{}", chance(4));
            file.text += "# a comment that joins nothing \\\no " + object + (chance(2) ? "\r\n" : "\n");
        }
        for (int k = 0; k < 4; ++k) {
            // All coordinates differ, none is rounded, and no three vertices of a patch are collinear.
            positions.push_back({float(patch), float(k == 1 || k == 2), float(k > 1) + float(chance(100)) / 256});
            uvs.push_back({float(chance(1000)) / 1024, float(chance(1000)) / 1024});
            normals.push_back({float(1 + chance(100)) / 128, float(chance(100)) / 128, 0.5f});
            const auto& p = positions.back();
            const char* const between = chance(9) == 0 ? " \\\n" : chance(9) == 0 ? "\t+" : " ";
            file.text += fmt::format("v {} {}{}{:.9e}{}\n", p[0], p[1], between, p[2], chance(20) ? "" : " 1");
            file.text += fmt::format("vt {} {}{}\n", uvs.back()[0], uvs.back()[1], chance(9) ? "" : " 0");
            file.text += fmt::format("vn  {} {} {}\n", normals.back()[0], normals.back()[1], normals.back()[2]);
        }
        // Some faces refer to vertices far back in the file.
        const std::size_t first = 4 * (chance(8) ? std::size_t(patch) : chance(std::uint32_t(patch) + 1));
        const bool is_quad = chance(2), counts_back = chance(3) == 0;
        std::vector<Corner> corners;
        file.text += "f";
        for (std::size_t k = 0; k < (is_quad ? 4u : 3u); ++k) {
            const std::size_t t = first + chance(4), n = first + chance(4), p = first + k;
            corners.push_back(corner(p, t, n));
            const auto number = [&](std::size_t i) {
                return counts_back ? -(long long)(positions.size() - i) : (long long)(i + 1);
            };
            file.text += fmt::format(" {}/{}/{}", number(p), number(t), number(n));
        }
        file.text += chance(9) ? "\n" : " # behind it\n";
        file.objects[object].push_back({corners[0], corners[1], corners[2]});
        if (is_quad) file.objects[object].push_back({corners[0], corners[2], corners[3]});
    }
    return file;
}

TEST_F(Pieces, OfALargeObjAreOneFile)
{
    const Large file = large_obj(12000);
    ASSERT_GT(file.text.size(), 3 * LineBlocks::usual_size);
    const SceneDescription scene = load("a.obj", file.text);
    EXPECT_TRUE(warnings_.empty());
    EXPECT_EQ(scene.meshes.size(), file.objects.size());
    for (const auto& [name, triangles] : file.objects) {
        const Triangles read = triangles_of(scene, name);
        ASSERT_EQ(read.size(), triangles.size()) << name;
        EXPECT_TRUE(std::equal(read.begin(), read.end(), triangles.begin())) << name;
    }
}

template <class T>
std::string bits(const std::vector<T>& values)
{
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

TEST_F(Pieces, GiveTheSameForAnyThreads)
{
    const std::filesystem::path file = write("a.obj", large_obj(12000).text);
    const auto read = [&](int threads) {
        const ThreadLimit limit(threads);
        return load_scene(file, {}, warnings_);
    };
    const SceneDescription one = read(1), two = read(2), many = read(7);
    for (const SceneDescription* other : {&two, &many}) {
        ASSERT_EQ(one.meshes.size(), other->meshes.size());
        for (std::size_t i = 0; i < one.meshes.size(); ++i) {
            EXPECT_EQ(one.meshes[i].name, other->meshes[i].name);
            EXPECT_EQ(one.meshes[i].indices, other->meshes[i].indices);
            EXPECT_EQ(bits(one.meshes[i].positions), bits(other->meshes[i].positions));
            EXPECT_EQ(bits(one.meshes[i].normals), bits(other->meshes[i].normals));
            EXPECT_EQ(bits(one.meshes[i].uvs[0]), bits(other->meshes[i].uvs[0]));
        }
    }
}

std::vector<std::string> blocks_of(const std::string& text, std::size_t size)
{
    InputFile input("a.obj", text);
    LineBlocks reader(input, size);
    std::vector<std::string> blocks;
    for (std::string block; reader.next(block);) blocks.push_back(block);
    return blocks;
}

TEST_F(Pieces, EndWhereLinesEnd)
{
    const std::string text = "v 1 2\\\n3\nvt \\\r\n 4\r\n\n\nlast one \\\n goes on";
    for (std::size_t size = 1; size < text.size() + 3; ++size) {
        std::string all;
        for (const std::string& block : blocks_of(text, size)) {
            all += block;
            EXPECT_TRUE(block.ends_with('\n')) << size;
            EXPECT_FALSE(block.ends_with("\\\n") || block.ends_with("\\\r\n")) << size;
        }
        EXPECT_EQ(all, text + '\n') << size;
    }
}

/// A lone CR is converted to LF even at the end of a window; CR LF is kept.
TEST_F(Pieces, EndWhereLinesEndWithCr)
{
    const std::string text = "v 1 2\rvt \\\r 4\r\n\r\rlast one\r";
    for (std::size_t size = 1; size < text.size() + 3; ++size) {
        const std::vector<std::string> blocks = blocks_of(text, size);
        std::string all;
        for (const std::string& block : blocks) {
            all += block;
            EXPECT_TRUE(block.ends_with('\n')) << size;
        }
        EXPECT_EQ(all, "v 1 2\nvt \\\n 4\r\n\n\nlast one\n") << size;
        if (size == 1) EXPECT_GT(blocks.size(), 1u);
    }
}

/// Common line forms take a faster code path with the same result.
TEST_F(Pieces, UsualLinesAndOthersSayTheSame)
{
    const char* const words[] = {"0",  "-1.5", "+2", "1e2",  "1E-2", ".5",  "3.",    "1e-400", "16777217", "-0",
                                 "x1", "1x",   "",   "1e39", "nan",  "1-2", "1/2/3", "1//3",   "1/",       "0x1"};
    const auto read = [](const std::string& text) {
        ObjPiece piece;
        piece.text = text;
        try {
            read_obj_piece(piece, "a", 1);
        } catch (const Error& error) {
            return "refused: " + error.message();
        }
        std::ostringstream out;
        out.precision(9);
        for (const Vec3f& p : piece.positions) out << 'v' << p.x << ' ' << p.y << ' ' << p.z;
        for (const Vec4f& c : piece.colors) out << 'c' << c.x << ' ' << c.y << ' ' << c.z;
        for (const Vec3f& n : piece.normals) out << 'n' << n.x << ' ' << n.y << ' ' << n.z;
        for (const Vec2f& t : piece.uvs) out << 't' << t.x << ' ' << t.y;
        for (const ObjCorner& c : piece.corners) out << 'f' << c.position << ' ' << c.uv << ' ' << c.normal;
        return out.str();
    };
    int read_at_all = 0;
    for (const char* key : {"v", "vt", "vn", "f"})
        for (const char* a : words)
            for (const char* b : words)
                for (const char* more : {"", " 1", " 1 0.5", " 1 0.5 0.25", " 1 0.5 0.25 8", " 1 1 1 1 1", " 1 \r"}) {
                    const std::string line = fmt::format("{} {} {}{}", key, a, b, more);
                    // The empty continuation line adds nothing but forces the general code path.
                    const std::string usual = read(line + '\n'), other = read(line + " \\\n\n");
                    EXPECT_EQ(usual, other) << line;
                    read_at_all += !usual.starts_with("refused");
                }
    EXPECT_GT(read_at_all, 500);
}

TEST_F(Pieces, NameTheFirstLineThatIsWrong)
{
    const std::string patch = "v 0 0 0\nv 1 0 0\n# \\\nv 0 1 \\\n0\nf -3 -2 -1\n";
    std::string text;
    while (text.size() < 3 * LineBlocks::usual_size) text += patch;
    const auto lines = std::count(text.begin(), text.end(), '\n');
    const std::string end = text;
    EXPECT_EQ(error_of("a.obj", text + "v 0 0\n" + end),
              fmt::format("line {}: expected a number, found ''", lines + 1));
    EXPECT_EQ(error_of("b.obj", text + "v 0 0 0\n\nf 1 2 99999999999 # 4\n" + end),
              fmt::format("line {}: vertex 99999999999 is out of range: there are {} so far", lines + 3,
                          3 * text.size() / patch.size() + 1));
    EXPECT_EQ(error_of("c.obj", text + "vt 0 0\nf 1/1 2/1 3/2\nv x\n" + end),
              fmt::format("line {}: texture coordinate 2 is out of range: there are 1 so far", lines + 2));
    EXPECT_EQ(error_of("d.obj", text + "p 1 0\nf 0 0 0\n" + end),
              fmt::format("line {}: vertex 0 is out of range: there are {} so far", lines + 1,
                          3 * text.size() / patch.size()));
}

/// More vertices share a position than the linear search handles, and meshes share positions.
TEST_F(Pieces, JoinWhatIsAlikeWhereverItIs)
{
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    constexpr int uvs = 40;
    for (int i = 0; i < uvs; ++i) text += fmt::format("vt {} 0\n", i);
    for (const char* object : {"a", "b"}) {
        text += fmt::format("o {}\n", object);
        for (int times = 0; times < 3; ++times)
            for (int i = 1; i <= uvs; ++i) text += fmt::format("f 1/{0} 2/{0} 3/{0}\n", i);
    }
    const SceneDescription scene = load("a.obj", text);
    ASSERT_EQ(scene.meshes.size(), 2u);
    for (const Mesh& mesh : scene.meshes) {
        ASSERT_EQ(mesh.positions.size(), 3u * uvs);
        ASSERT_EQ(mesh.indices.size(), 9u * uvs);
        for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
            EXPECT_EQ(mesh.uvs[0][mesh.indices[i]].x, float(i / 3 % uvs));
            EXPECT_EQ(mesh.positions[mesh.indices[i]].x, float(i % 3 == 1));
        }
    }
}

std::string bytes_of(const auto& value)
{
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// n patches of a triangle and a quad, ASCII or binary.
std::string large_ply(int n, bool is_ascii, int wrong_face = -1)
{
    std::string text = fmt::format("ply\nformat {} 1.0\n", is_ascii ? "ascii" : "binary_little_endian");
    for (int i = 0; i < 200; ++i) text += "comment a header of more than what is looked at first, end_header\n";
    text += fmt::format(
        "element vertex {}\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\n"
        "property uchar green\nproperty uchar blue\nelement face {}\nproperty list uchar int "
        "vertex_indices\nend_header\n",
        4 * n, 2 * n);
    const auto put = [&](auto value) { is_ascii ? text += fmt::format("{}\n", value) : text += bytes_of(value); };
    for (int i = 0; i < 4 * n; ++i) {
        put(float(i));
        put(double(i % 4 == 1));
        put(float(i % 4 > 1));
        for (int c = 0; c < 3; ++c) put(static_cast<unsigned char>(c == 0 ? 255 : i % 2 * 255));
    }
    for (int i = 0; i < n; ++i) {
        put(static_cast<unsigned char>(3));
        for (const int k : {0, 1, 2}) put(2 * i == wrong_face ? 4 * n : 4 * i + k);
        put(static_cast<unsigned char>(4));
        for (const int k : {0, 1, 2, 3}) put(4 * i + k);
    }
    return text;
}

TEST_F(Pieces, OfALargePlyAreOneFile)
{
    constexpr int n = 20000;
    for (const bool is_ascii : {false, true}) {
        const SceneDescription scene = load("a.ply", large_ply(n, is_ascii));
        const Mesh& mesh = scene.meshes.at(0);
        ASSERT_EQ(mesh.positions.size(), 4u * n);
        ASSERT_EQ(mesh.indices.size(), 9u * n);
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            const Vec3f p = mesh.positions[i];
            const Vec4f c = mesh.colors[i];
            ASSERT_EQ((std::array{p.x, p.y, p.z}), (std::array{float(i), float(i % 4 == 1), float(i % 4 > 1)})) << i;
            ASSERT_EQ((std::array{c.x, c.y, c.z, c.w}), (std::array{1.0f, float(i % 2), float(i % 2), 1.0f})) << i;
        }
        constexpr std::uint32_t corners[9] = {0, 1, 2, 0, 1, 2, 0, 2, 3};
        for (std::size_t i = 0; i < mesh.indices.size(); ++i) ASSERT_EQ(mesh.indices[i] / 4, i / 9) << i;
        for (std::size_t i = 0; i < mesh.indices.size(); ++i)
            if (i % 9 < 3) {
                ASSERT_EQ(mesh.indices[i] % 4, corners[i % 9]) << i;
            }
    }
}

TEST_F(Pieces, OfAPlyThatIsWrong)
{
    constexpr int n = 20000;
    for (const bool is_ascii : {false, true}) {
        const std::string whole = large_ply(n, is_ascii);
        EXPECT_EQ(error_of("a.ply", large_ply(n, is_ascii, 30000)),
                  "face 30000: vertex 80000 is out of range: there are 80000");
        EXPECT_NE(error_of("b.ply", whole.substr(0, whole.size() / 2)).find("is truncated"), std::string::npos);
    }
    // This token is longer than a window.
    EXPECT_EQ(error_of("d.ply",
                       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                       "property float z\nend_header\n0\n0\n" +
                           std::string(1 << 20, 'x'))
                  .substr(0, 40),
              "line 10: expected a number, found 'xxxxx");
}

/// Mesh of a million triangles with one degenerate one: the others stay in order.
TEST_F(Pieces, WithoutArea)
{
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\n";
    constexpr int n = 100000;
    for (int i = 0; i < n; ++i) text += i % 30000 == 7 ? "f 1 2 4\n" : i % 2 ? "f 1 2 3\n" : "f 1 4 3\n";
    const SceneDescription scene = load("a.obj", text);
    EXPECT_EQ(count_in_all(warnings_, "degenerate triangles"), 4u);
    const auto& indices = scene.meshes.at(0).indices;
    ASSERT_EQ(indices.size(), 3u * (n - 4));
    std::size_t at = 0;
    for (int i = 0; i < n; ++i)
        if (i % 30000 != 7) {
            ASSERT_EQ(scene.meshes[0].positions[indices[at + 1]].x, i % 2 ? 1 : 2) << i;
            at += 3;
        }
}

TEST_F(Pieces, OfAnInputFile)
{
    std::string text;
    for (int i = 0; i < 80000; ++i) text += fmt::format("{} ", i);
    const std::filesystem::path file = write("a", text);
    InputFile input(file);
    EXPECT_EQ(input.size(), text.size());
    EXPECT_EQ(input.head(), text.substr(0, 4096));
    std::string pieces(50000, ' ');
    for (std::size_t at = 0; at < pieces.size(); at += 10000) ASSERT_EQ(input.read(pieces.data() + at, 10000), 10000u);
    EXPECT_EQ(pieces, text.substr(0, 50000));
    EXPECT_EQ(input.bytes(), text);
    EXPECT_EQ(input.read(pieces.data(), 100), 100u);
    EXPECT_EQ(pieces.substr(0, 100), text.substr(50000, 100));
    // Files in /proc report a size of 0.
    EXPECT_NE(InputFile("/proc/self/status").take().find("VmRSS"), std::string::npos);

    InputFile again(file);
    InputWindow window(again);
    EXPECT_EQ(window.bytes_left(), text.size());
    window.pass(window.peek(10).size());
    const std::size_t at = text.size() - window.bytes_left();
    EXPECT_EQ(std::string(window.take(7), 7), text.substr(at, 7));
    EXPECT_EQ(window.take(text.size()), nullptr);
    EXPECT_EQ(window.peek(1).substr(0, 5), text.substr(at + 7, 5));
}

TEST_F(Pieces, OfAPipe)
{
    const std::string text = large_obj(3000).text;
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    std::thread writer([&] {
        for (std::size_t at = 0; at < text.size();)
            at += std::size_t(::write(ends[1], text.data() + at, text.size() - at));
        close(ends[1]);
    });
    InputFile input(fmt::format("/proc/self/fd/{}", ends[0]));
    writer.join();
    close(ends[0]);
    LineBlocks blocks(input);
    std::string all;
    for (std::string block; blocks.next(block);) all += block;
    EXPECT_EQ(all, text);
}

}  // namespace
}  // namespace fathom::test
