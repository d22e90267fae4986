// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "formats/common/load_context.h"
#include "formats/common/measured_file.h"
#include "formats/common/medium.h"
#include "formats/mitsuba/object.h"
#include "formats/mitsuba/serialized.h"
#include "scene/append.h"

namespace fathom::mitsuba {

/// Whether the shape's own transform mirrors.
bool mirrors(Object& shape);

/// Converts a Mitsuba document to a scene.
class Reader {
public:
    Reader(const Document& document, LoadContext& context) : document_(document), context_(context) {}

    SceneDescription read();

private:
    using Key = std::pair<const Element*, std::string>;

    // Defined in scene.cpp: sensor, film and integrator.
    void read_root(const Element& element);
    void read_sensor(const Element& element);
    struct FieldOfView {
        double angle;  ///< angle in radians
        FovAxis axis;  ///< side of the image that the angle spans
    };
    /// Field of view of cameras and projectors.
    static FieldOfView field_of_view(Object& object);
    static double vertical_fov(Object& sensor, double aspect);
    void read_film(const Element& element);
    void read_crop(Object& film);
    void look_at_crop(Object& sensor, Camera& camera) const;
    void read_integrator(const Element& element);
    void hide_emitters();
    // Defined in emitter.cpp:
    void read_emitter(const Element& element);
    std::optional<LightImage> light_picture(const Element& texture);
    void read_projector(Object& emitter, Light& light);
    void read_environment_map(Object& emitter);
    void read_sky(Object& emitter);
    void add_light(Light light, const Transform& world_from_light);
    /// Adds a collimated light in front of a shape whose emitter shines along the normal only.
    void add_beam(const Element& element, Object& shape, Node& node);

    // Defined in texture.cpp: colors and textures. Reflectances are clamped to at most 1.
    ColorInput color(Object& of, std::string_view name, Color otherwise);
    /// A number or texture. A color texture is read by its luminance.
    FloatInput number_or_texture(Object& of, std::string_view name, float otherwise);
    /// A constant color; a texture is replaced by gray, which is reported.
    Color plain_color(Object& of, std::string_view name, Color otherwise);
    /// A constant color or spectrum; nothing for a texture.
    std::optional<Color> color_of(const Element& element);
    Color spectrum(const Element& element);
    /// Reads a texture and returns its index.
    ///
    /// data  whether values are data rather than colors
    int texture(const Element& element, bool data);
    int bitmap(Object& texture);
    int checkerboard(Object& texture, bool data);
    int mesh_attribute(Object& texture);

    // Defined in material.cpp:
    int material(const Element& bsdf);
    Material read_bsdf(const Element& element);
    Material read_nested(Object& bsdf);
    Material diffuse(Object& bsdf);
    Material conductor(Object& bsdf);
    Material dielectric(Object& bsdf);
    Material thin_dielectric(Object& bsdf);
    Material plastic(Object& bsdf);
    Material hair(Object& bsdf);
    Material principled(Object& bsdf);
    Material measured(Object& bsdf);
    Material mask(Object& bsdf);
    // Defined in bumps.cpp:
    Material bumps(Object& bsdf);
    Material bumped(Material m, const FloatInput& height);
    Material normal_mapped(Material m, int map);
    /// Whether the material, or one that it combines, has a normal or bump map.
    bool has_normal_perturbation(const Material& m) const;
    Material bumps_for_back_side(Material m);
    /// Applies a bump or normal map to copies of both materials of a mixture.
    template <class Bend>
    Material bend_parts(Material mixture, const Bend& bend);
    Material two_sided(Object& bsdf);
    Material blend(Object& bsdf);
    // Defined in legacy_materials.cpp: plugins of Mitsuba 0.6.
    Material phong(Object& bsdf);
    Material rough_diffuse(Object& bsdf);
    Material diffuse_transmitter(Object& bsdf);
    Material mixture(Object& bsdf);
    ColorInput squared(const ColorInput& color);
    ColorInput scaled_input(const ColorInput& color, float by);
    int add_material(Material material);
    /// A metal with reflectance 1.
    static Material mirror();
    /// Tints a mirror's reflection with a color that is constant over all angles.
    static void tint(Material& mirror, const ColorInput& color);
    void read_roughness(Object& bsdf, Material& material);
    /// Index of refraction inside over outside.
    double relative_ior(Object& bsdf, double inside, double outside);
    double ior(Object& bsdf, std::string_view name, double otherwise);
    // Defined in opacity.cpp:
    Material combine_opacity(Material mixture);
    Material mix_with_clear_sheet(Material m);
    /// Adds emission to a material so that its alpha doesn't scale the emission.
    Material with_emission(Material m, ColorInput emission);
    /// Index of the shape's material, with its interior medium and emission.
    int material_of_shape(Object& shape);
    void read_interior(const Element& medium, Material& material);
    void finish_media();

    // Defined in shape.cpp:
    void read_shape(const Element& element, std::vector<int>& roots);
    std::optional<Shape> read_geometry(Object& shape, Node& node);
    std::optional<Shape> model(Object& shape, Node& node);
    std::optional<Shape> ply(Object& shape);
    Mesh ply_mesh(Object& shape, const std::string& file, const std::string& attribute);
    std::filesystem::path file_of(Object& shape);
    /// A mesh of a file, which is read once for each variant of options. Errors in the file name the shape.
    template <class Read>
    Shape mesh_of_file(Object& shape, const std::string& file, const std::string& variant, const Read& read);
    /// The mesh attribute that the shape's material refers to ("vertex_color", "face_weight", ...); empty if none.
    std::string attribute_of(Object& shape);
    std::optional<Shape> serialized(Object& shape);
    std::optional<Shape> sdf_grid(Object& shape);
    bool needs_uv(Object& shape);
    /// The mesh as a shape, with Mitsuba's tangents if its material has a normal map.
    Shape add_textured(Mesh mesh, Object& shape);
    Shape rectangle(Object& shape);
    Shape cylinder(Object& shape, Node& node);
    Shape sphere(Object& shape, Node& node);
    Shape disk(Object& shape);
    Shape cube(Object& shape);
    std::optional<Shape> curves(Object& shape);
    void read_group(Object& group, std::vector<int>& roots);
    Shape add_mesh(Mesh mesh);
    /// The mesh with the shape's options applied.
    Mesh finished(Mesh mesh, Object& shape, bool flip_v);

    /// Warns of an element: one line for each type of element and message, with the id of the first element.
    void report(const Element& element, const std::string& message);
    void add_reported_warnings();
    int add_node(Node node);

    const Document& document_;
    LoadContext& context_;
    struct ReportCount {
        std::size_t times = 0;
        std::string first_id;
        std::set<std::string> ids;
    };
    std::map<std::pair<std::string, std::string>, ReportCount> report_counts_;  ///< reports by element type and message
    SceneDescription scene_;
    int film_width_ = 768, film_height_ = 576;
    std::array<double, 2> crop_middle_{384, 288};  ///< center of the cropped part of the film, in pixels
    std::map<const Element*, int> textures_, materials_, two_sided_materials_;
    bool two_sided_ = false;  ///< inside a 'twosided' BSDF, whose back is not black
    std::map<const Element*, int> data_textures_;
    std::map<int, std::string> attributes_;  ///< names of the mesh attributes that textures refer to
    std::map<std::string, int> images_;
    MeasuredFiles measured_files_{context_, scene_};
    /// Materials of shapes by BSDF, emitter and medium.
    std::map<std::array<const Element*, 3>, int> shape_materials_;
    const Element* camera_medium_ = nullptr;
    bool hides_emitters_ = false;          ///< known only after all top-level elements are read
    std::vector<int> emissive_materials_;  ///< materials of emissive shapes
    ShapeMedia<Element> media_of_shapes_;
    std::map<Key, int> meshes_;
    std::map<std::string, SerializedFile> serialized_;
    std::map<std::string, Appended> models_;  ///< models by file and options
    std::map<const Element*, std::vector<int>> groups_;
    std::set<const Element*> open_shapes_;  ///< shapes being read; detects cycles
};

}  // namespace fathom::mitsuba
