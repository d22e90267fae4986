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

/// Turns a mesh's other side to the front.
void flip(Mesh& mesh);
/// Whether a shape's own transform does.
bool mirrors(Object& shape);

/// A Mitsuba document into a scene.
class Reader {
public:
    Reader(const Document& document, LoadContext& context) : document_(document), context_(context) {}

    SceneDescription read();

private:
    using Key = std::pair<const Element*, std::string>;

    // scene.cpp: what is seen, and from where
    void read_root(const Element& element);
    void read_sensor(const Element& element);
    struct FieldOfView {
        double angle;  ///< radians
        FovAxis axis;  ///< of which side of the picture
    };
    /// Of cameras and projectors.
    static FieldOfView field_of_view(Object& object);
    static double vertical_fov(Object& sensor, double aspect);
    void read_film(const Element& element);
    void read_crop(Object& film);
    void look_at_crop(Object& sensor, Camera& camera) const;
    void read_integrator(const Element& element);
    void hide_emitters();
    // emitter.cpp
    void read_emitter(const Element& element);
    std::optional<LightPicture> light_picture(const Element& texture);
    void read_projector(Object& emitter, Light& light);
    void read_environment_map(Object& emitter);
    void read_sky(Object& emitter);
    void add_light(Light light, const Transform& world_from_light);
    /// Of a shape that shines along its normals only: a light in front of it.
    void add_beam(const Element& element, Object& shape, Node& node);

    // texture.cpp: colours and what stands for them. Reflectances are at most 1.
    ColorInput color(Object& of, std::string_view name, Color otherwise);
    /// A color texture is read by its luminance.
    FloatInput number_or_texture(Object& of, std::string_view name, float otherwise);
    /// One colour; of a texture, which is told, grey.
    Color plain_color(Object& of, std::string_view name, Color otherwise);
    std::optional<Color> color_of(const Element& element);
    Color spectrum(const Element& element);
    /// data  numbers, not colours
    int texture(const Element& element, bool data);
    int bitmap(Object& texture);
    int checkerboard(Object& texture, bool data);
    int mesh_attribute(Object& texture);

    // material.cpp
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
    // bumps.cpp
    Material bumps(Object& bsdf);
    Material bumped(Material m, const FloatInput& height);
    Material normal_mapped(Material m, int map);
    bool is_bent(const Material& m) const;
    Material bent_from_behind(Material m);
    /// Applies a bump or normal map to copies of both materials of a mixture.
    template <class Bend>
    Material bend_parts(Material mixture, const Bend& bend);
    Material two_sided(Object& bsdf);
    Material blend(Object& bsdf);
    // old_materials.cpp: of Mitsuba 0.6
    Material phong(Object& bsdf);
    Material rough_diffuse(Object& bsdf);
    Material diffuse_transmitter(Object& bsdf);
    Material mixture(Object& bsdf);
    ColorInput squared(const ColorInput& color);
    ColorInput scaled_input(const ColorInput& color, float by);
    int add_material(Material material);
    /// Metal that reflects all.
    static Material mirror();
    /// What a mirror reflects gets a colour, the same at all angles.
    static void tint(Material& mirror, const ColorInput& color);
    void read_roughness(Object& bsdf, Material& material);
    /// Of one side against the other.
    double relative_ior(Object& bsdf, double inside, double outside);
    double ior(Object& bsdf, std::string_view name, double otherwise);
    // opacity.cpp
    Material blend_by_alpha(Material mixture);
    Material mixed_with_transparent(Material m);
    Material with_emission(Material m, ColorInput emission);
    /// With what fills the shape, and with what it emits.
    int material_of_shape(Object& shape);
    void read_interior(const Element& medium, Material& material);
    void finish_media();

    // shape.cpp
    void read_shape(const Element& element, std::vector<int>& roots);
    std::optional<Shape> read_geometry(Object& shape, Node& node);
    std::optional<Shape> model(Object& shape, Node& node);
    std::optional<Shape> ply(Object& shape);
    Mesh ply_mesh(Object& shape, const std::string& file, const std::string& attribute);
    std::filesystem::path file_of(Object& shape);
    /// The mesh attribute that the shape's material looks up: "vertex_color", "face_weight", ...; else empty.
    std::string attribute_of(Object& shape);
    std::optional<Shape> serialized(Object& shape);
    std::optional<Shape> sdf_grid(Object& shape);
    bool wants_uv(Object& shape);
    Shape add_textured(Mesh mesh, Object& shape);
    Shape rectangle(Object& shape);
    Shape cylinder(Object& shape, Node& node);
    Shape sphere(Object& shape, Node& node);
    Shape disk(Object& shape);
    Shape cube(Object& shape);
    std::optional<Shape> curves(Object& shape);
    void read_group(Object& group, std::vector<int>& roots);
    Shape add_mesh(Mesh mesh);
    /// Their mesh as a shape's options have it.
    Mesh finished(Mesh mesh, Object& shape, bool flip_v);

    /// Warns of an element: one line for each kind of element and message, with the id of the first one.
    void report(const Element& element, const std::string& message);
    void add_reported_warnings();
    int add_node(Node node);

    const Document& document_;
    LoadContext& context_;
    struct Told {
        std::size_t times = 0;
        std::string first_id;
        std::set<std::string> ids;
    };
    std::map<std::pair<std::string, std::string>, Told> told_;  ///< by what an element is and the message
    SceneDescription scene_;
    int film_width_ = 768, film_height_ = 576;
    std::array<double, 2> crop_middle_{384, 288};  ///< of the part of the film that is the picture, in pixels
    std::map<const Element*, int> textures_, materials_, two_sided_materials_;
    bool two_sided_ = false;  ///< what is read is within a 'twosided' bsdf: it is not black behind
    std::map<const Element*, int> data_textures_;
    std::map<int, std::string> attributes_;  ///< names of those that textures stand for
    std::map<std::string, int> images_;
    MeasuredFiles measured_files_{context_, scene_};
    /// By bsdf, emitter and medium.
    std::map<std::array<const Element*, 3>, int> shape_materials_;
    const Element* camera_medium_ = nullptr;
    bool hides_emitters_ = false;  ///< known when all of the scene's own elements were read
    std::vector<int> lamps_;       ///< materials of shapes that shine
    MediaOfShapes<Element> media_of_shapes_;
    std::map<Key, int> meshes_;
    std::map<std::string, SerializedFile> serialized_;
    std::map<std::string, Appended> models_;  ///< by file and options
    std::map<const Element*, std::vector<int>> groups_;
    std::set<const Element*> open_shapes_;  ///< being read now: finds cycles
};

}  // namespace fathom::mitsuba
