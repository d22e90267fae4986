// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "formats/common/load_context.h"
#include "formats/common/measured_file.h"
#include "formats/common/medium.h"
#include "formats/pbrt/measured_media.h"
#include "formats/pbrt/named_spectra.h"
#include "formats/pbrt/parameters.h"

namespace fathom::pbrt {

using Plugin = std::shared_ptr<const Parameters>;

/// The graphics state that directives change and AttributeEnd restores.
struct State {
    std::array<Transform, 2> ctm;  ///< transforms when the shutter opens and closes
    bool active[2] = {true, true};
    Plugin material;  ///< null: the default gray, or the named material
    std::string named_material;
    Plugin area_light;
    std::string inside, outside;  ///< names of the media inside and outside
    bool reverse = false;
    Space space = Space::srgb;
    std::map<std::string, ParameterList>
        presets;  ///< parameters of `Attribute` directives by plugin type: "shape", "material", ...
};

/// A texture with a name.
struct NamedTexture {
    Plugin plugin;
    bool is_float = false;
    Transform world_from_texture;
    std::optional<ColorInput> input;  ///< color or number of the texture, set after the first reference
    bool is_open = false;             ///< the texture is being read; detects cycles
};

/// The surface attributes of a shape; equal ones share a material.
struct Surface {
    const Parameters* material = nullptr;
    const Parameters* light = nullptr;
    const Parameters* medium = nullptr;
    bool is_vacuum_interior = false;  ///< the shape is a cavity in the surrounding medium, and its interior is vacuum
    std::string alpha;
    float power_factor = 1;  ///< scale of the radiance of lights whose power is given, from the shape's area
    float displacement_edge = 0;
    std::string displacement;
    friend auto operator<=>(const Surface&, const Surface&) = default;
};

/// Reads a scene of pbrt-v4 directive by directive.
class Reader {
public:
    Reader(const std::filesystem::path& file, LoadContext& context);

    SceneDescription read(const std::string& bytes);

private:
    // Defined in directives.cpp: directives.
    void read_file(const std::filesystem::path& file, const std::string& bytes);
    void read_directive(Scanner& scanner);
    bool read_transform(Scanner& scanner, std::string_view word);
    bool read_block(Scanner& scanner, std::string_view word);
    bool read_definition(Scanner& scanner, std::string_view word);
    bool read_scope(Scanner& scanner, std::string_view word);
    void include(Scanner& scanner, bool is_import);
    void end_block(const Place& place, char kind);
    void concat(const Transform& t);
    void read_option(Scanner& scanner);
    Plugin plugin(Scanner& scanner, const char* kind, const char* preset);
    Plugin named_plugin(Scanner& scanner, const char* kind, const char* preset, std::string& name);
    std::string string_of(Scanner& scanner);
    std::filesystem::path locate(const Parameters& plugin, const std::string& name);
    std::filesystem::path locate(const Place& place, const std::string& name);
    SceneDescription finished();

    // Defined in view.cpp: camera, film and sampler.
    void read_camera(const Parameters& camera);
    Camera placed_camera(const Parameters& of, const std::array<double, 4>& window) const;
    void read_spherical(const Parameters& of, Camera& camera);
    void read_realistic(const Parameters& of, double aspect, double scale, Camera& camera);
    void read_perspective(const Parameters& of, double half_height, Camera& camera);
    void read_thin_lens(const Parameters& of, double scale, Camera& camera);
    void finish_camera();
    void read_film(const Parameters& film);
    void read_crop(const Parameters& film, int width, int height);
    std::array<double, 4> crop_window(const std::array<double, 4>& window) const;
    void read_filter(const Parameters& filter);
    void read_sampler(const Parameters& sampler);
    void read_integrator(const Parameters& integrator);

    // Defined in spectra.cpp: colors.
    std::vector<float> spectrum_file(const Parameter& parameter);
    Color color_value(const Parameters& of, const Parameter& parameter, bool of_light);
    Color color_value(const Parameters& of, std::string_view name, Color otherwise, bool of_light);
    /// Color of a light; a spectrum that is not RGB is normalized to luminance 1.
    Color light_color(const Parameters& of, std::string_view name);
    ColorInput color(const Parameters& of, std::string_view name, Color otherwise);
    FloatInput number_or_texture(const Parameters& of, std::string_view name, float otherwise);
    /// An index of refraction: a number, a named glass, or a spectrum.
    GlassIndex glass_index(const Parameters& of, std::string_view name, float otherwise);
    /// An index of refraction without dispersion.
    float ior(const Parameters& of, std::string_view name, float otherwise);

    // Defined in texture.cpp:
    ColorInput texture(const Parameters& of, std::string_view name, bool is_float);
    ColorInput read_texture(NamedTexture& named);
    ColorInput texture_operand(const Parameters& of, std::string_view name, bool is_float, float otherwise);
    ColorInput image_map(const NamedTexture& named);
    ColorInput mixture(const NamedTexture& named);
    ColorInput dots(const NamedTexture& named);
    ColorInput bilerp(const NamedTexture& named);
    ColorInput checkerboard(const NamedTexture& named);
    ColorInput procedural(const NamedTexture& named);
    ColorInput product(const ColorInput& a, const ColorInput& b);
    ColorInput mixed(const ColorInput& a, const ColorInput& b, const FloatInput& amount);
    ColorInput limited(ColorInput input);
    static Transform world_from_texture(const NamedTexture& named);
    void set_mapping(const NamedTexture& named, Texture& texture, bool is_picture);
    static void set_plane(const Parameters& of, Texture& texture, bool is_picture);
    Wrap wrap_of(const Parameters& of, const std::string& name);
    int image(const Parameters& of);
    int add_texture(Texture texture);

    // Defined in material.cpp and metal.cpp:
    Material material(const Parameters* plugin);
    Material read_material(const Parameters& m);
    Material diffuse(const Parameters& m);
    Material coated_diffuse(const Parameters& m);
    Material dielectric(const Parameters& m, float usual_index);
    Material diffuse_transmission(const Parameters& m);
    Material conductor(const Parameters& m, const std::string& prefix, float outside);
    Material coated_conductor(const Parameters& m);
    const MeasuredMedium* measured_medium(const Parameters& of, std::string_view parameter);
    Material subsurface(const Parameters& m);
    Material hair(const Parameters& m);
    Material measured(const Parameters& m);
    Material mix(const Parameters& m);
    void set_metal_colors(const Parameters& m, const std::string& prefix, float outside, Material& out);
    float layer_thickness(const Parameters& m);
    void set_roughness(const Parameters& m, const std::string& prefix, Material& out);
    FloatInput roughness(const Parameters& m, const std::string& name, float otherwise, bool remap);
    void set_bumps(const Parameters& m, Material& out);
    void set_medium(const Parameters& medium, Material& out);
    void finish_media();
    void set_emission(const Surface& surface, Material& out);
    int surface_material(const Surface& surface);
    const Parameters* state_material(const Place& place);

    // Defined in shape.cpp and round_shapes.cpp:
    void read_shape(const Parameters& shape);
    std::optional<Shape> geometry(const Parameters& shape, Surface& surface);
    std::optional<Shape> triangle_mesh(const Parameters& shape, const Surface& surface);
    std::optional<Shape> ply_mesh(const Parameters& shape, Surface& surface);
    std::optional<Shape> bilinear_mesh(const Parameters& shape);
    std::optional<Shape> loop_mesh(const Parameters& shape, const Surface& surface);
    /// Whether the surface refers to a texture that depends on the shape's texture coordinates.
    bool needs_uv(const Surface& surface);
    std::optional<Shape> curve(const Parameters& shape);
    std::optional<Shape> sphere(const Parameters& shape, bool has_textures);
    std::optional<Shape> disk(const Parameters& shape, bool has_textures);
    std::optional<Shape> cylinder(const Parameters& shape);
    Shape add_mesh(Mesh mesh, const std::string& file);
    void set_media(const Place& place, Surface& surface);
    const Parameters* medium(const Place& place, const std::string& name) const;
    double area_of(const Shape& shape, const Transform& world) const;
    void place(Node node);

    // Defined in light.cpp: lights without a surface.
    void read_light(const Parameters& light);
    void read_infinite(const Parameters& light);
    void read_point(const Parameters& of);
    void read_spot(const Parameters& of);
    void read_distant(const Parameters& of);
    void read_goniometric(const Parameters& of);
    void read_projection(const Parameters& of);
    static void set_power(const Parameters& of, Light& light);
    void add_light(Light light, const Transform& world_from_light);
    void add_light_node(Light light, const Transform& world_from_node);

    void report(const Parameters& of, const std::string& message);
    int add_node(Node node);

    LoadContext& context_;
    std::filesystem::path folder_;
    WarningReporter reporter_;
    SceneDescription scene_;
    State state_;
    struct Block {
        State state;
        Place place;
        char kind;  ///< what the saved state belongs to: 'a'ttribute, 't'ransform, 'o'bject
    };
    std::vector<Block> blocks_;
    bool in_world_ = false;
    std::array<double, 2> times_{0, 1};
    std::map<std::string, std::array<Transform, 2>> systems_;
    Plugin camera_, film_;
    std::string camera_medium_;
    ShapeMedia<Parameters> media_of_shapes_;
    std::array<int, 2> film_size_ = {1280, 720};   ///< size of the whole film in pixels
    std::array<int, 4> crop_ = {0, 1280, 0, 720};  ///< part of the film that is rendered: x0, x1, y0, y1
    Transform world_from_camera_;
    bool mirrored_ = false;  ///< whether the scene is mirrored in x: pbrt's cameras are left-handed unless their
                             ///< transform mirrors
    std::map<std::string, NamedTexture> float_textures_, color_textures_;
    std::map<std::string, Plugin> named_materials_, media_;
    std::map<const Parameters*, Material> materials_;
    std::vector<Plugin> kept_;  ///< plugins that are kept alive because their addresses are keys
    std::set<const Parameters*> open_materials_;
    std::map<Surface, int> surfaces_;
    std::map<std::string, int> images_;
    MeasuredFiles measured_files_{context_, scene_};
    std::map<std::string, int> models_;  ///< meshes by file and orientation
    std::map<std::string, std::vector<int>> objects_;
    std::vector<int>* current_object_ = nullptr;
};

}  // namespace fathom::pbrt
