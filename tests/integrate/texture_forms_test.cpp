// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <filesystem>
#include <functional>

#include "picture_helpers.h"

// Placement of textures on shapes, channel assignment, and normal maps, against closed forms.
namespace fathom {
namespace {

using namespace test;

/// An orthographic camera at z = 5 that sees [-1, 1] x [-1, 1] in the plane z = 0; unlit surfaces give images without
/// noise.
class View : public SceneBuilder {
public:
    static constexpr int side = 16;

    View()
    {
        camera({0, 0, 5}, {0, 0, 0});
        scene.cameras[0].kind = CameraKind::orthographic;
        scene.cameras[0].height = 2;
    }
    /// n x n pixels with one sample each, anywhere in its pixel.
    std::vector<float> pixels(std::uint64_t samples = 1, int n = side)
    {
        return render_film(scene, small_image_settings(n, n), samples).image(false, false).layers[0].pixels;
    }
    Color at(double x, double y)
    {
        const std::vector<float> all = pixels();
        const int column = int((x + 1) / 2 * side), row = int((1 - y) / 2 * side);
        const float* p = &all[std::size_t(3 * (row * side + column))];
        return {p[0], p[1], p[2]};
    }
    int unlit(int texture)
    {
        Material m;
        m.kind = MaterialKind::unlit;
        m.base_color = {{1, 1, 1}, texture};
        return material(m);
    }
    int texture(const Texture& t)
    {
        scene.textures.push_back(t);
        return int(scene.textures.size()) - 1;
    }
};

class TextureForms : public testing::Test {
protected:
    TextureForms()
    {
        file_ = std::filesystem::temp_directory_path() /
                (std::string("fathom-forms-") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".exr");
    }
    ~TextureForms() override { std::filesystem::remove(file_); }

    /// Adds an image given by rows from the top; four channels, premultiplied as in files.
    Texture picture(SceneDescription& scene, int width, int height,
                    const std::function<std::array<float, 4>(int, int)>& value)
    {
        Image image;
        image.width = width, image.height = height;
        image.layers.push_back({"", {"R", "G", "B", "A"}, {}});
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (float v : value(x, y)) image.layers[0].pixels.push_back(v);
        write_image(file_, image, {});
        scene.images.push_back({"picture", file_, {}});
        Texture t;
        t.image = int(scene.images.size()) - 1;
        t.nearest = true;
        return t;
    }
    /// Colors of the texture encode the position: red increases with x, green with y.
    Texture places(SceneDescription& scene, int n = 4)
    {
        return picture(scene, n, n, [](int x, int y) { return std::array{float(x), float(y), 0.5f, 1.f}; });
    }

    std::filesystem::path file_;
};

/// Textures are upright when facing the viewer: on rectangles, fronts of boxes, disks, meshes and spheres, in lists and
/// BVHs.
TEST_F(TextureForms, HangUpright)
{
    for (const bool tree : {false, true})
        for (int kind = 0; kind < 5; ++kind) {
            View v;
            const int material = v.unlit(v.texture(places(v.scene)));
            if (kind == 0) v.add(Rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}, material);
            if (kind == 1) v.add(Box{{-1, -1, -1}, {1, 1, 0}}, material);
            if (kind == 2) v.add(Disk{{0, 0, 0}, {0, 0, 1}, std::sqrt(2.0)}, material);
            if (kind == 3) {
                Mesh mesh;
                mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
                mesh.uvs[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
                mesh.indices = {0, 1, 2, 0, 2, 3};
                v.scene.meshes.push_back(mesh);
                v.add(MeshInstance{0}, material);
            }
            if (kind == 4) v.add(Sphere{{0, 0, 0}, 2, {}}, material);
            for (int i = 0; i < (tree ? 100 : 0); ++i) v.add(Sphere{{8 + 0.1 * i, 0, -9}, 0.01, {}}, material);
            for (double x : {-0.8, -0.3, 0.2, 0.7})
                for (double y : {-0.8, -0.3, 0.2, 0.7}) {
                    double s = (x + 1) / 2, t = (1 - y) / 2;
                    if (kind == 2) s = 0.5 + x / 2 / std::sqrt(2.0), t = 0.5 - y / 2 / std::sqrt(2.0);
                    if (kind == 4) {
                        // u rotates about +y from +x towards -z; v descends from the pole at +y.
                        const double z = std::sqrt(4 - x * x - y * y);
                        s = std::atan2(-z, x) / (2 * std::numbers::pi), s += s < 0 ? 1 : 0;
                        t = std::acos(y / 2) / std::numbers::pi;
                    }
                    // Pixels (1/8 wide) that cover texels of two kinds are skipped.
                    const double margin = kind == 4 ? 0.12 : 0.26;
                    const double fs = s * 4 - std::floor(s * 4), ft = t * 4 - std::floor(t * 4);
                    if (std::min({fs, 1 - fs, ft, 1 - ft}) < margin) continue;
                    const Color c = v.at(x, y);
                    EXPECT_EQ(c.r, std::floor(s * 4)) << kind << tree << " " << x << " " << y;
                    EXPECT_EQ(c.g, std::floor(t * 4)) << kind << tree << " " << x << " " << y;
                    EXPECT_EQ(c.b, 0.5f);
                }
        }
}

/// KHR_texture_transform: scale, rotation, offset by the matrix of its specification.
TEST_F(TextureForms, OffsetRotationScaleAndSet)
{
    for (const bool second : {false, true})
        for (const float angle : {0.0f, 0.4f, -1.2f}) {
            View v;
            Texture t = places(v.scene, 8);
            t.uv_offset = {0.2f, -0.35f}, t.uv_scale = {0.7f, 1.3f}, t.uv_rotation = angle;
            t.uv_set = second;
            t.wrap_u = Wrap::repeat, t.wrap_v = Wrap::repeat;
            const int material = v.unlit(v.texture(t));
            Mesh mesh;
            mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
            mesh.uvs[second ? 1 : 0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
            mesh.uvs[second ? 0 : 1] = {{0.1f, 0.1f}, {0.1f, 0.1f}, {0.1f, 0.1f}, {0.1f, 0.1f}};
            mesh.indices = {0, 1, 2, 0, 2, 3};
            v.scene.meshes.push_back(mesh);
            v.add(MeshInstance{0}, material);
            const std::vector<float> pixels = v.pixels(1, 64);
            int checked = 0;
            for (int row = 0; row < 64; ++row)
                for (int column = 0; column < 64; ++column) {
                    // Only pixels that lie entirely in one texel are compared.
                    Color expected;
                    bool one = true;
                    for (int corner = 0; corner < 4; ++corner) {
                        const double s = (column + (corner & 1)) / 64.0 * double(t.uv_scale.x),
                                     r = (row + (corner >> 1)) / 64.0 * double(t.uv_scale.y);
                        const double c = std::cos(double(angle)), n = std::sin(double(angle));
                        const double tu = c * s + n * r + double(t.uv_offset.x),
                                     tv = -n * s + c * r + double(t.uv_offset.y);
                        const Color here{float(int(std::floor(tu * 8 + 80)) % 8),
                                         float(int(std::floor(tv * 8 + 80)) % 8), 0.5f};
                        if (corner > 0 && !(here == expected)) one = false;
                        expected = here;
                    }
                    if (!one) continue;
                    ++checked;
                    const float* p = &pixels[std::size_t(3 * (row * 64 + column))];
                    ASSERT_EQ((Color{p[0], p[1], p[2]}), expected) << second << angle << " " << column << " " << row;
                }
            EXPECT_GT(checked, 1000);
        }
}

/// A number from a texture channel equals the plain number up to rounding.
TEST_F(TextureForms, ChannelsOfRoughnessMetallicAndAlpha)
{
    const std::array<float, 4> value{0.125f, 0.375f, 0.75f, 0.5f};
    for (int channel = 0; channel < 4; ++channel)
        for (int what = 0; what < 3; ++what) {
            std::vector<float> pictures[2];
            for (const bool textured : {false, true}) {
                View v;
                const int t = v.texture(picture(v.scene, 1, 1, [&](int, int) { return value; }));
                Material m;
                m.kind = MaterialKind::principled;
                m.base_color.value = {0.9f, 0.6f, 0.2f};
                m.roughness.value = 0.5f, m.metallic.value = 0.5f;
                FloatInput& input = what == 0 ? m.roughness : what == 1 ? m.metallic : m.opacity.alpha;
                const float factor = 0.875f;
                input = {factor * (textured ? 1 : value[std::size_t(channel)]), textured ? t : -1, channel};
                if (what == 2) m.opacity.mode = AlphaMode::blend;
                // A square with each of them makes sure that both scenes have textures.
                v.add(Rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0.5}}, v.material(m));
                v.add(Rectangle{{5, -1, 0}, {1, 0, 0}, {0, 1, 0}}, v.unlit(t));
                v.scene.environment.kind = EnvironmentKind::gradient;
                pictures[textured] = v.pixels(4);
            }
            double difference = 0, total = 0;
            for (std::size_t i = 0; i < pictures[0].size(); ++i) {
                difference += std::abs(double(pictures[0][i]) - double(pictures[1][i]));
                total += double(pictures[0][i]);
            }
            EXPECT_LT(difference, 2e-4 * total) << "channel " << channel << " of " << what;
        }
}

/// A texture's color is multiplied by the factor, for reflection and emission.
TEST_F(TextureForms, ColorsMultiply)
{
    for (const bool emits : {false, true}) {
        View v;
        const int t = v.texture(picture(v.scene, 1, 1, [](int, int) { return std::array{0.5f, 0.25f, 0.125f, 1.f}; }));
        Material m;
        m.kind = emits ? MaterialKind::none : MaterialKind::diffuse;
        (emits ? m.emission.radiance : m.base_color) = {{0.5f, 0.75f, 1}, t};
        v.add(Rectangle{{-2, -2, 0}, {4, 0, 0}, {0, 4, 0}}, v.material(m));
        v.scene.environment.kind = EnvironmentKind::constant;
        const Mean mean = mean_of(render_film(v.scene, small_image_settings(8, 8), 16));
        const double expected[] = {0.25, 0.1875, 0.125};
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean.value[c], expected[c], 1e-5) << emits;
    }
}

/// Vertex colors are interpolated by barycentric coordinates.
TEST(VertexForms, ColorsAreInterpolated)
{
    for (const bool tree : {false, true}) {
        View v;
        Mesh mesh;
        mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}};
        mesh.colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}};
        mesh.indices = {0, 1, 2};
        v.scene.meshes.push_back(mesh);
        Material m;
        m.base_color.value = {1, 0.5f, 0.25f};
        m.use_vertex_color = true;
        v.add(MeshInstance{0}, v.material(m));
        for (int i = 0; i < (tree ? 100 : 0); ++i) v.add(Sphere{{8 + 0.1 * i, 0, -9}, 0.01, {}}, 0);
        v.scene.environment.kind = EnvironmentKind::constant;
        const std::vector<float> pixels = v.pixels(64);
        for (const auto& [x, y] : {std::pair{-0.9, -0.9}, {0.6, -0.9}, {-0.9, 0.6}, {-0.4, -0.3}}) {
            const int column = int((x + 1) * 8), row = int((1 - y) * 8);
            const float* p = &pixels[std::size_t(3 * (row * 16 + column))];
            // The position is the pixel's center, up to the jitter of samples.
            const double mx = (column + 0.5) / 8 - 1, my = 1 - (row + 0.5) / 8;
            const double green = (mx + 1) / 2, blue = (my + 1) / 2;
            EXPECT_NEAR(p[0], 1 - green - blue, 0.01) << x << " " << y;
            EXPECT_NEAR(p[1], 0.5 * green, 0.01) << x << " " << y;
            EXPECT_NEAR(p[2], 0.25 * blue, 0.01) << x << " " << y;
        }
    }
}
/// Unlit surfaces show their color times the vertex colors.
TEST(VertexForms, ColorsOfUnlitSurfaces)
{
    for (const bool used : {true, false}) {
        View v;
        Mesh mesh;
        mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
        mesh.colors.assign(4, {0.5f, 0.25f, 0.125f, 1});
        mesh.indices = {0, 1, 2, 0, 2, 3};
        v.scene.meshes.push_back(mesh);
        Material m;
        m.kind = MaterialKind::unlit;
        m.base_color.value = {1, 0.5f, 0.25f};
        m.use_vertex_color = used;
        v.add(MeshInstance{0}, v.material(m));
        const Color c = v.at(0.1, 0.2);
        EXPECT_EQ(c, used ? (Color{0.5f, 0.125f, 0.03125f}) : m.base_color.value);
    }
}

/// A constant normal map under a sun from several sides shows the cosine of that normal in the shape's frame: red
/// points along increasing u, green up in the image.
TEST_F(TextureForms, NormalMaps)
{
    const Vec3d coded = normalize(Vec3d{0.3, -0.4, 0.8});
    for (int kind = 0; kind < 5; ++kind)
        for (const float scale : {1.0f, 0.5f})
            for (const Vec3d& to_sun : {Vec3d{0, 0, 1}, normalize(Vec3d{1, 0, 1}), normalize(Vec3d{0.2, -1, 1})}) {
                View v;
                Texture t = picture(v.scene, 1, 1, [&](int, int) {
                    return std::array{float(coded.x / 2 + 0.5), float(coded.y / 2 + 0.5), float(coded.z / 2 + 0.5),
                                      1.f};
                });
                Material m;
                m.base_color.value = {1, 1, 1};
                m.normal_map.texture = v.texture(t);
                m.normal_map.scale = scale;
                const int material = v.material(m);
                // The vectors are the tangent and the bitangent of the shape.
                Vec3d right{1, 0, 0}, up{0, 1, 0};
                if (kind == 0) v.add(Rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}, material);
                if (kind == 1) {
                    v.add(Rectangle{{1, -1, 0}, {0, 2, 0}, {-2, 0, 0}}, material);
                    right = {0, 1, 0}, up = {-1, 0, 0};
                }
                if (kind >= 2) {
                    Mesh mesh;
                    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
                    mesh.indices = {0, 1, 2, 0, 2, 3};
                    mesh.uvs[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
                    if (kind == 3) {  // the image is mirrored, so u increases to the left
                        mesh.uvs[0] = {{1, 1}, {0, 1}, {0, 0}, {1, 0}};
                        right = {-1, 0, 0};
                    }
                    if (kind ==
                        4) {  // the explicit tangents differ from those of uv: up, with the bitangent to its right
                        mesh.normals.assign(4, {0, 0, 1});
                        mesh.tangents.assign(4, {0, 1, 0, -1});
                        right = {0, 1, 0}, up = {1, 0, 0};
                    }
                    v.scene.meshes.push_back(mesh);
                    v.add(MeshInstance{0}, material);
                }
                Light sun;
                sun.kind = LightKind::directional;
                sun.intensity = {2, 2, 2};
                const Vec3d axis = cross({0, 0, 1}, to_sun);
                v.light(sun, Transform::rotate(length(axis) > 0 ? axis : Vec3d{1, 0, 0}, std::acos(to_sun.z)));
                const double s = double(scale);
                const Vec3d n = normalize(right * (coded.x * s) + up * (coded.y * s) + Vec3d{0, 0, 1} * coded.z);
                expect_mean(render_film(v.scene, small_image_settings(4, 4), 4),
                            2 / std::numbers::pi * std::max(0.0, dot(n, to_sun)), 1e-3);
            }
}

/// The visible square with skewed texture coordinates. The second set is the first one after the texture's transform.
Mesh skewed_square(const Texture& transform)
{
    Mesh mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    for (const Vec3f& p : mesh.positions) {
        const double u = 0.5 * p.x + 0.2 * p.y, v = 0.1 * p.x - 0.4 * p.y;
        const double c = std::cos(double(transform.uv_rotation)), s = std::sin(double(transform.uv_rotation));
        const double scaled_u = transform.uv_scale.x * u, scaled_v = transform.uv_scale.y * v;
        mesh.uvs[0].push_back({float(u), float(v)});
        mesh.uvs[1].push_back({float(c * scaled_u + s * scaled_v), float(-s * scaled_u + c * scaled_v)});
    }
    return mesh;
}
/// Texture transforms that rotate or mirror the tangents.
std::vector<Texture> turning_transforms()
{
    std::vector<Texture> all(4);
    all[0].uv_rotation = 0.7f;
    all[1].uv_scale = {-1, 1};
    all[2].uv_scale = {2, -0.5f}, all[2].uv_rotation = -2;
    all[3].uv_scale = {0.5f, 3}, all[3].uv_rotation = 1;
    return all;
}

/// If the mesh has no tangents, red of a normal map points along increasing u of the map's own coordinates, by the
/// inverse of the affine map from positions to coordinates.
TEST_F(TextureForms, NormalMapsFollowTheirOwnCoordinates)
{
    for (const Texture& transform : turning_transforms())
        for (const bool baked : {false, true})
            for (const bool by_map : {true, false}) {
                View v;
                Texture t = picture(v.scene, 1, 1, [](int, int) { return std::array{0.75f, 0.65f, 0.9f, 1.f}; });
                const Mesh mesh = skewed_square(transform);
                t.uv_set = baked;
                if (!baked) t.uv_scale = transform.uv_scale, t.uv_rotation = transform.uv_rotation;
                Material m;
                m.base_color.value = {1, 1, 1};
                m.normal_map.texture = v.texture(t);
                m.map_tangents = by_map;
                v.scene.meshes.push_back(mesh);
                v.add(MeshInstance{0}, v.material(m));
                Light sun;
                sun.kind = LightKind::directional;
                v.light(sun, Transform::rotate({0, 1, 0}, 0.9));
                // This is the direction of increasing u' at constant v', perpendicular to the gradient of v'.
                const std::vector<Vec2f>& uv = mesh.uvs[by_map ? 1 : 0];
                const double v_by_x = (uv[1].y - uv[0].y) / 2, v_by_y = (uv[3].y - uv[0].y) / 2,
                             u_by_x = (uv[1].x - uv[0].x) / 2, u_by_y = (uv[3].x - uv[0].x) / 2;
                Vec3d along = normalize(Vec3d{v_by_y, -v_by_x, 0});
                if (u_by_x * along.x + u_by_y * along.y < 0) along = along * -1.0;
                // Green points towards decreasing v'.
                const Vec3d up = normalize(Vec3d{-v_by_x, -v_by_y, 0});
                const Vec3d n = normalize(along * 0.5 + up * 0.3 + Vec3d{0, 0, 0.8});
                const double expected = (n.x * std::sin(0.9) + n.z * std::cos(0.9)) / std::numbers::pi;
                EXPECT_NEAR(v.at(0.3, 0.1).g, std::max(expected, 0.0), 1e-4)
                    << transform.uv_rotation << " " << baked << by_map;
            }
}

/// Coat normal maps and anisotropy directions give equal images whether the transform is the texture's or already in
/// the mesh's coordinates.
TEST_F(TextureForms, CoatsAndAnisotropyFollowTheirMaps)
{
    for (const Texture& transform : turning_transforms())
        for (const bool coat : {false, true}) {
            std::vector<float> pixels[3];
            for (const int which : {0, 1, 2}) {
                View v;
                Texture t = picture(v.scene, 1, 1, [](int, int) { return std::array{0.75f, 0.6f, 0.9f, 1.f}; });
                t.uv_set = which == 1;
                if (which == 0) t.uv_scale = transform.uv_scale, t.uv_rotation = transform.uv_rotation;
                Material m;
                m.kind = MaterialKind::principled;
                m.base_color.value = {0.5f, 0.5f, 0.5f};
                m.roughness.value = 0.5f;
                if (coat) {
                    m.coat.weight.value = 1, m.coat.roughness.value = 0.5f, m.coat.normal_texture = v.texture(t);
                } else {
                    m.metallic.value = 1, m.microfacets.anisotropy.value = 0.9f,
                    m.microfacets.anisotropy_texture = v.texture(t);
                }
                v.scene.meshes.push_back(skewed_square(transform));
                v.add(MeshInstance{0}, v.material(m));
                Light sun;
                sun.kind = LightKind::directional;
                v.light(sun, Transform::rotate({0, 1, 0}, 0.7));
                pixels[which] = v.pixels();
            }
            double unlike = 0;
            for (std::size_t i = 0; i < pixels[0].size(); ++i) {
                EXPECT_NEAR(pixels[0][i], pixels[1][i], 1e-4f + 1e-3f * pixels[1][i]);
                unlike += std::abs(double(pixels[0][i]) - pixels[2][i]) / double(pixels[2][i]);
            }
            EXPECT_GT(unlike / double(pixels[0].size()), 0.01) << transform.uv_rotation << coat;
        }
}

/// With alpha blending the transmitted fraction also passes shadow rays; with a cutoff, alpha at or above it is opaque.
TEST(AlphaForms, ShadowsAndCutoff)
{
    Light sun;
    sun.kind = LightKind::directional;
    for (const float alpha : {0.0f, 0.3f, 0.8f, 1.0f})
        for (const AlphaMode mode : {AlphaMode::blend, AlphaMode::mask, AlphaMode::opaque}) {
            View v;
            Material floor, veil;
            floor.base_color.value = {1, 1, 1};
            veil.kind = MaterialKind::none;
            veil.opacity.alpha.value = alpha;
            veil.opacity.mode = mode;
            veil.opacity.cutoff = 0.8f;
            v.add(Rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}, v.material(floor));
            // The veil is behind the camera, between the sun and the scene.
            v.add(Rectangle{{-4, -4, 8}, {8, 0, 0}, {0, 8, 0}}, v.material(veil));
            v.light(sun, {});
            const double stopped = mode == AlphaMode::blend  ? double(alpha)
                                   : mode == AlphaMode::mask ? (alpha >= 0.8f ? 1 : 0)
                                                             : 1;
            const Mean m = mean_of(render_film(v.scene, small_image_settings(16, 16), 64));
            EXPECT_NEAR(m.value[0], (1 - stopped) / std::numbers::pi, 4 * m.error[0] + 1e-5)
                << alpha << " " << int(mode);
        }
}

/// Alpha textures cut surfaces at the right places, on a rectangle and on pairs of triangles, for camera and shadow
/// rays.
TEST_F(TextureForms, AlphaLiesWhereThePictureDoes)
{
    // The pattern has no rotation or mirror symmetry.
    const auto stands = [](int x, int y) { return ((x * 3 + y * y + (x == 0 ? y : 0)) % 4) < 2; };
    for (const bool tree : {false, true})
        for (const bool shadow : {false, true})
            for (const bool mesh_of_two : {false, true}) {
                View v;
                const Texture t = picture(v.scene, 4, 4, [&](int x, int y) {
                    const float a = stands(x, y) ? 1.f : 0.f;
                    return std::array{a, a, a, 1.f};
                });
                Material cut, floor;
                cut.kind = shadow ? MaterialKind::none : MaterialKind::unlit;
                cut.base_color.value = {1, 0, 0};
                cut.opacity.alpha = {1, v.texture(t), 0};
                cut.opacity.mode = AlphaMode::mask;
                floor.base_color.value = {1, 1, 1};
                // For shadows the surface is behind the camera, between the sun and the scene.
                const double z = shadow ? 8 : 0;
                const int material = v.material(cut);
                if (!mesh_of_two) v.add(Rectangle{{-1, -1, z}, {2, 0, 0}, {0, 2, 0}}, material);
                if (mesh_of_two) {
                    Mesh mesh;
                    const float at = float(z);
                    mesh.positions = {{-1, -1, at}, {1, -1, at}, {1, 1, at}, {-1, 1, at}};
                    mesh.uvs[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
                    mesh.indices = {0, 1, 2, 0, 2, 3};
                    v.scene.meshes.push_back(mesh);
                    v.add(MeshInstance{0}, material);
                }
                for (int i = 0; i < (tree ? 100 : 0); ++i) v.add(Sphere{{8 + 0.1 * i, 0, -9}, 0.01, {}}, material);
                if (shadow) {
                    v.add(Rectangle{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}, v.material(floor));
                    Light sun;
                    sun.kind = LightKind::directional;
                    v.light(sun, {});
                } else {
                    v.scene.environment.kind = EnvironmentKind::constant;
                    v.scene.environment.color = {0, 0, 1};
                }
                const std::vector<float> pixels = v.pixels();
                for (int y = 0; y < 4; ++y)
                    for (int x = 0; x < 4; ++x) {
                        const bool seen = stands(x, y);
                        const float* p = &pixels[std::size_t(3 * ((4 * y + 2) * View::side + 4 * x + 2))];
                        SCOPED_TRACE(testing::Message() << mesh_of_two << tree << shadow << " cell " << x << " " << y);
                        if (shadow)
                            EXPECT_NEAR(p[0], seen ? 0 : 1 / std::numbers::pi, 1e-5);
                        else
                            EXPECT_EQ((Color{p[0], p[1], p[2]}), seen ? (Color{1, 0, 0}) : (Color{0, 0, 1}));
                    }
            }
}

}  // namespace
}  // namespace fathom
