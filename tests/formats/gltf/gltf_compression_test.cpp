// SPDX-License-Identifier: Apache-2.0
#include "formats/import_test_helpers.h"
#include "gltf_builder.h"

#if defined(FATHOM_HAS_COMPRESSION)
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>
#endif

// Meshes compressed by the libraries' own encoders are decoded correctly.
namespace fathom::test {
namespace {

#if defined(FATHOM_HAS_COMPRESSION)

class GltfCompression : public ImportTest {
protected:
    static constexpr std::size_t vertices = 5;
    const std::vector<float> positions{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.5f, 0.5f, 2};
    const std::vector<std::uint32_t> indices{0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4, 0, 2, 1, 0, 3, 2};

    std::string packed_vertices() const
    {
        std::string out(meshopt_encodeVertexBufferBound(vertices, 12), '\0');
        out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(),
                                              positions.data(), vertices, 12));
        return out;
    }
    std::string packed_indices() const
    {
        std::string out(meshopt_encodeIndexBufferBound(indices.size(), vertices), '\0');
        out.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(), indices.data(),
                                             indices.size()));
        return out;
    }
    std::string meshopt_file(
        const std::string& vertex_bytes, const std::string& index_bytes,
        const std::string& extension = "EXT_meshopt_compression",
        const std::string& vertex_members = R"("byteStride": 12, "count": 5, "mode": "ATTRIBUTES")",
        const std::string& index_members = R"("byteStride": 4, "count": 18, "mode": "TRIANGLES")")
    {
        GltfBuilder b;
        const int place = b.accessor(b.packed_view(vertex_bytes, 60, extension, vertex_members, 12), 5126, 5, "VEC3");
        const int corners = b.accessor(b.packed_view(index_bytes, 72, extension, index_members), 5125, 18, "SCALAR");
        return b.one_primitive(fmt::format(R"("attributes": {{"POSITION": {}}}, "indices": {})", place, corners),
                               R"("extensionsRequired": ["EXT_meshopt_compression"])");
    }
    void expect_the_mesh(const Mesh& mesh, double tolerance) const
    {
        ASSERT_EQ(mesh.indices.size(), indices.size());
        // Encoders may renumber vertices and rotate triangles, so corners are compared by sorted positions.
        const auto corners = [](const auto& at, const std::vector<std::uint32_t>& all) {
            std::vector<std::array<double, 9>> triangles;
            for (std::size_t i = 0; i < all.size(); i += 3) {
                std::array<std::array<double, 3>, 3> c;
                for (std::size_t k = 0; k < 3; ++k) c[k] = at(all[i + k]);
                std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
                triangles.push_back({c[0][0], c[0][1], c[0][2], c[1][0], c[1][1], c[1][2], c[2][0], c[2][1], c[2][2]});
            }
            std::sort(triangles.begin(), triangles.end());
            return triangles;
        };
        const auto rounded = [](double x) { return std::round(x * 1000) / 1000; };
        const auto got = corners(
            [&](std::uint32_t i) {
                const Vec3f p = mesh.positions[i];
                return std::array<double, 3>{rounded(p.x), rounded(p.y), rounded(p.z)};
            },
            mesh.indices);
        const auto want = corners(
            [&](std::uint32_t i) {
                return std::array<double, 3>{positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
            },
            indices);
        for (std::size_t i = 0; i < want.size(); ++i)
            for (std::size_t k = 0; k < 9; ++k) EXPECT_NEAR(got[i][k], want[i][k], tolerance) << i << " " << k;
    }

    std::string draco_bytes() const
    {
        draco::TriangleSoupMeshBuilder builder;
        builder.Start(int(indices.size() / 3));
        const int attribute = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
        for (std::size_t i = 0; i < indices.size(); i += 3)
            builder.SetAttributeValuesForFace(attribute, draco::FaceIndex(std::uint32_t(i / 3)),
                                              &positions[3 * indices[i]], &positions[3 * indices[i + 1]],
                                              &positions[3 * indices[i + 2]]);
        const auto mesh = builder.Finalize();
        draco::Encoder encoder;
        encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
        draco::EncoderBuffer buffer;
        EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
        return {buffer.data(), buffer.size()};
    }
    std::string draco_file(const std::string& bytes, const std::string& more = "", int id = 0, std::size_t count = 5)
    {
        GltfBuilder b;
        const int view = b.view(std::vector<char>(bytes.begin(), bytes.end()));
        const int place = b.accessor(-1, 5126, count, "VEC3"), corners = b.accessor(-1, 5125, 18, "SCALAR");
        return b.one_primitive(
            fmt::format(
                R"("attributes": {{"POSITION": {}{}}}, "indices": {}, "extensions": {{"KHR_draco_mesh_compression":
                {{"bufferView": {}, "attributes": {{"POSITION": {}}}}}}})",
                place, more, corners, view, id),
            R"("extensionsRequired": ["KHR_draco_mesh_compression"])");
    }
};

TEST_F(GltfCompression, Meshopt)
{
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
        const SceneDescription scene = load("a.gltf", meshopt_file(packed_vertices(), packed_indices(), name));
        ASSERT_EQ(scene.meshes.size(), 1u);
        expect_the_mesh(scene.meshes[0], 0);
    }
    EXPECT_TRUE(warnings_.empty());
}

/// Octahedral filter: 8-bit normals decode to the direction defined in EXT_meshopt_compression.
TEST_F(GltfCompression, MeshoptFilters)
{
    const std::vector<std::int8_t> encoded{0, 0, 127, 0, 127, 0, 127, 0, 0, -127, 127, 0};
    std::string out(meshopt_encodeVertexBufferBound(3, 4), '\0');
    out.resize(
        meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(), encoded.data(), 3, 4));
    GltfBuilder b;
    const int place = b.triangle();
    const int normals =
        b.accessor(b.packed_view(out, 12, "EXT_meshopt_compression",
                                 R"("byteStride": 4, "count": 3, "mode": "ATTRIBUTES", "filter": "OCTAHEDRAL")", 4),
                   5120, 3, "VEC3", R"("normalized": true)");
    const SceneDescription scene = load(
        "a.gltf", b.one_primitive(fmt::format(R"("attributes": {{"POSITION": {}, "NORMAL": {}}})", place, normals)));
    ASSERT_EQ(scene.meshes.size(), 1u);
    const std::vector<Vec3f>& n = scene.meshes[0].normals;
    ASSERT_EQ(n.size(), 3u);
    EXPECT_NEAR(n[0].z, 1, 0.01);
    EXPECT_NEAR(n[1].x, 1, 0.01);
    EXPECT_NEAR(n[1].z, 0, 0.01);
    EXPECT_NEAR(n[2].y, -1, 0.01);
    EXPECT_NEAR(n[2].z, 0, 0.01);
}

TEST_F(GltfCompression, DamagedMeshopt)
{
    const std::string good = packed_vertices(), triangles = packed_indices();
    const auto refused = [&](const std::string& file, const std::string& words) {
        EXPECT_NE(error_of("a.gltf", file).find(words), std::string::npos) << error_of("a.gltf", file);
    };
    refused(meshopt_file(good.substr(0, good.size() / 2), triangles),
            "bufferViews[0].extensions.EXT_meshopt_compression: the compressed data is damaged");
    refused(meshopt_file(good, triangles.substr(0, 3)), "the compressed data is damaged");
    const char* const ext = "EXT_meshopt_compression";
    refused(meshopt_file(good, triangles, ext, R"("byteStride": 12, "count": 5, "mode": "SHAPES")"),
            "'SHAPES' is not one of");
    refused(meshopt_file(good, triangles, ext, R"("byteStride": 13, "count": 5, "mode": "ATTRIBUTES")"),
            "multiple of 4");
    refused(meshopt_file(good, triangles, ext, R"("byteStride": 12, "count": 0, "mode": "ATTRIBUTES")"), "at least 1");
    refused(meshopt_file(good, triangles, ext, R"("byteStride": 12, "count": 4000000000000, "mode": "ATTRIBUTES")"),
            "GB of memory");
    refused(meshopt_file(good, triangles, ext,
                         R"("byteStride": 12, "count": 5, "mode": "ATTRIBUTES", "filter": "QUATERNION")"),
            "QUATERNION can't be applied to elements of 12 bytes");
    // The stream has fewer elements than the accessor needs.
    refused(meshopt_file(good, triangles, ext, R"("byteStride": 12, "count": 3, "mode": "ATTRIBUTES")"), "");
    EXPECT_NE(
        error_of("a.gltf", meshopt_file(good, triangles, ext, R"("byteStride": 12, "count": 3, "mode": "ATTRIBUTES")")),
        "");
}

TEST_F(GltfCompression, Draco)
{
    const SceneDescription scene = load("a.gltf", draco_file(draco_bytes()));
    ASSERT_EQ(scene.meshes.size(), 1u);
    expect_the_mesh(scene.meshes[0], 2e-3);
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(GltfCompression, DamagedDraco)
{
    const std::string good = draco_bytes();
    const auto refused = [&](const std::string& file, const std::string& words) {
        EXPECT_NE(error_of("a.gltf", file).find(words), std::string::npos) << error_of("a.gltf", file);
    };
    refused(draco_file(good.substr(0, good.size() / 2)), "the compressed data is damaged");
    refused(draco_file("nothing"), "KHR_draco_mesh_compression: the compressed data is damaged");
    refused(draco_file(good, "", 7), "has no attribute with this id");
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string file = draco_file(good);
        const std::size_t at = file.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return file.replace(at, from.size(), to);
    };
    refused(with(R"("count")", R"("counts")"), "accessors[0]: key 'count' is missing");
    refused(with(R"("attributes": {"POSITION": 0}}})", R"("attributes": [0]}})"), "expected an object");
    refused(draco_file(good, "", 0, 900), "has 900 elements of 3 components, but its compressed data has 5 of 3");
    // After changing any single byte the file is either read or rejected.
    for (std::size_t i = 0; i < good.size(); ++i)
        for (const int change : {1, 0x80, 0xff}) {
            std::string bad = good;
            bad[i] = char(bad[i] ^ change);
            try {
                load("a.gltf", draco_file(bad));
            } catch (const Error&) {
            }
        }
}

#else

TEST(GltfCompression, IsLeftOut)
{
    GTEST_SKIP() << "built without meshoptimizer or Draco";
}

#endif

}  // namespace
}  // namespace fathom::test
