#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "fathom/vector.h"

/// What a scene file says, as plain data: the same for every file format, and what a program fills that makes a scene
/// in code. Things refer to each other by index into the vectors of SceneDescription; -1 is none. Units: metres,
/// radians, seconds; radiance and colours are linear Rec.709.
namespace fathom {

// ---------------------------------------------------------------------------------------------------- textures

/// An encoded picture (PNG, JPEG, WebP, AVIF, HDR, EXR): a path, or its bytes where the scene file has them inside.
struct ImageFile {
    std::string name;
    std::filesystem::path path;    ///< empty if bytes are given
    std::vector<std::byte> bytes;  ///< the encoded file, if embedded
};

/// How 8- and 16-bit values of a colour image are encoded (HDR, EXR: always linear).
enum class ColorSpace { srgb, linear };
enum class Wrap {
    repeat,
    clamp,
    mirror,
    black,      ///< nothing outside, alpha too
    octahedral  ///< across each edge lies the same edge turned round, as of an octahedral map of directions
};

/// value, multiplied by the texture if there is one.
struct ColorInput {
    Color value{1, 1, 1};
    int texture = -1;
};
/// The channel of a texture that is its luminance, beside 0 red to 3 alpha.
inline constexpr int luminance_channel = 4;

/// value, multiplied by one channel (0 red to 3 alpha, luminance_channel) of the texture if there is one.
struct FloatInput {
    float value = 1;
    int texture = -1;
    int channel = 0;
};

enum class TextureKind {
    image,          ///< bilinear (or nearest) lookup in full resolution
    checker_uv,     ///< color_a where floor(scale u) + floor(scale v) is even, else color_b
    checker_space,  ///< color_b where sin(scale x) sin(scale y) sin(scale z) < 0, else color_a (world space)
    noise,          ///< Perlin noise of scale * p mixed from color_a (0) to color_b (1) by 0.5 (1 + noise)
    turbulence,     ///< sum over octaves of |noise| / 2^i, mixed from color_a (0) to color_b (1)
    marble,         ///< 0.5 (1 + sin(scale z + turbulence_weight * turbulence(p))) mixed from color_a to color_b
    fbm,            ///< fractal sum of Perlin's noise: octaves 1.99 times as fine, gain times as high; color_a (0) to b
    wrinkled,       ///< the same of |noise|, and 0.2 for what comes after the last octave
    windy,          ///< fbm of six octaves times |fbm| of three that are ten times as coarse, mixed as those
    veined_marble,  ///< bands of scale * y, shaken by turbulence_weight * fbm, in the greys of marble
    dots,           ///< color_b in disks of radius 0.35 in about half of the squares of uv, else color_a
    coordinates,    ///< where it is looked up: red u, green v
    facing,         ///< by how much the geometric normal is along direction: color_a (0) to color_b (1)
    mix,            ///< from color_a (factor 0) to color_b (factor 1)
    scale,          ///< color_a times color_b
    uv_transform,   ///< color_a's texture, looked up at transformed texture coordinates
    ramp,           ///< the factor as a colour: linear between stops
    vertex_color,   ///< the mesh's vertex colours; white where it has none
    invert,         ///< what color_a lacks of white, 0 where it is brighter
    clamp,          ///< color_a, limited to 0 to 1
};
inline constexpr int texture_kind_count = 20;

/// What kinds that look at uv take for them. Of the others p is where they are looked up, in the texture's space.
enum class TextureMapping {
    uv,           ///< those of the surface
    spherical,    ///< u: angle about z from x over 2 pi; v: angle from z over pi
    cylindrical,  ///< u: angle about z over 2 pi, 1/2 at x; v: z
    planar        ///< x and y
};

/// A colour at a number.
struct RampStop {
    float position = 0;
    Color color;
};

/// A node of a graph: what it refers to may be textures itself, which must not lead back to it. Colours of textures
/// have an alpha, too, which is 1 where a node is made of plain colours.
struct Texture {
    std::string name;
    TextureKind kind = TextureKind::image;
    // image
    int image = -1;  ///< index into SceneDescription::images
    ColorSpace color_space = ColorSpace::srgb;
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    bool nearest = false;
    /// Unless 0: the picture holds heights, and the texture is the normal map of them, where white lies that many
    /// widths of the picture above black.
    float height_scale = 0;
    // all kinds that look at uv: which they are, and the map applied to it first: offset + rotation * (scale * uv)
    TextureMapping mapping = TextureMapping::uv;
    int uv_set = 0;
    Vec2f uv_offset{0, 0}, uv_scale{1, 1};
    float uv_rotation = 0;  ///< radians, as KHR_texture_transform
    /// Where the texture stands: of all kinds in space, and of mappings other than uv.
    Transform world_from_texture;
    // procedural kinds
    float scale = 1;
    float turbulence_weight = 10;
    int octaves = 7;
    float gain = 0.5f;         ///< fbm, wrinkled, veined_marble: height of each octave by that of the one before
    Vec3d direction{0, 1, 0};  ///< facing: in the world
    ColorInput color_a{{0, 0, 0}, -1}, color_b{{1, 1, 1}, -1};
    FloatInput factor;            ///< mix, ramp
    std::vector<RampStop> stops;  ///< ramp: 2 to 16, by ascending position
};

// ---------------------------------------------------------------------------------------------------- materials

enum class MaterialKind {
    none,     ///< black; for pure emitters
    unlit,    ///< shows base_color whatever the light, also in mirrors and through glass; lights nothing
    diffuse,  ///< base_color; roughness > 0: energy-preserving Oren-Nayar
    metal,    ///< base_color is the reflectance at normal incidence; roughness is the GGX alpha's root; 0 is a mirror
    fuzz_metal,  ///< the report's metal: mirror direction plus fuzz times a random point of the unit sphere
    glass,       ///< smooth or rough dielectric of index ior, solid or thin; a solid absorbs by attenuation_color over
                 ///< attenuation_distance
    plastic,     ///< a boundary of index ior, smooth or rough, over a diffuse body of base_color
    /// A fibre: a rough cylinder of glass that absorbs, under tilted scales. Meant for curves; on other shapes fibres
    /// run along growing u, and v says where across one it is.
    hair,
    /// Layers in the manner of OpenPBR: sheen over coat over a mixture of metal and dielectric, the latter a specular
    /// boundary over what is diffuse, passes diffusely, or is refracted. By default the metallic-roughness model of
    /// glTF.
    principled,
    /// Disney's (Burley 2012, 2015): lobes that are added, of facets, what is diffuse, sheen and a clear coat.
    disney,
    measured,  ///< what was measured of a surface: of the description's `measured`
    mix,       ///< of two materials: a path meets material_b as often as factor says, else material_a
    two_sided  ///< material_a on the side of the geometric normal, material_b on the other
};
inline constexpr int material_kind_count = 13;

enum class AlphaMode { opaque, mask, blend };

struct Material {
    std::string name;
    MaterialKind kind = MaterialKind::diffuse;
    ColorInput base_color{{0.8f, 0.8f, 0.8f}, -1};
    FloatInput roughness{0, -1, 1};  ///< perceptual: GGX alpha = roughness^2
    FloatInput metallic{0, -1, 2};
    float fuzz = 0;  ///< fuzz_metal: 0 to 1
    float ior = 1.5f;
    // glass, and principled with transmission
    Color attenuation_color{1, 1, 1};
    double attenuation_distance = 0;            ///< metres after which attenuation_color is left; 0: clear
    Color transmission_scatter{0, 0, 0};        ///< what is scattered over attenuation_distance, as an exponent
    float transmission_scatter_anisotropy = 0;  ///< mean cosine of it
    bool transmission_scatter_bounces = false;  ///< where paths have a longest depth, each scattering counts
    int priority = 0;  ///< where solids overlap, the one of greatest priority is there; of equal ones the inner
    /// What is left of light that went through, in and out of a solid, or once a thin sheet.
    ColorInput transmission_color;
    bool thin = false;  ///< a sheet without thickness, which light passes straight on
    // principled
    FloatInput transmission{0, -1, 0};          ///< share of what the dielectric's boundary lets in that is refracted
    float dispersion = 0;                       ///< 20 / Abbe's number
    FloatInput diffuse_transmission{0, -1, 3};  ///< share of what is diffuse that leaves on the other side
    ColorInput diffuse_transmission_color;
    /// What passes diffusely is not taken from what base_color reflects, but comes beside it: together at most 1.
    bool diffuse_transmission_added = false;
    /// Share of what is diffuse that enters the solid, is scattered there, and leaves it diffusely.
    FloatInput subsurface{0, -1, 0};
    ColorInput subsurface_color{{0.8f, 0.8f, 0.8f}, -1};  ///< what a half-space gives back of light from everywhere
    FloatInput subsurface_radius{0.01f, -1, 0};           ///< mean free path, metres
    ColorInput subsurface_radius_scale{{1, 0.5f, 0.25f}, -1};
    float subsurface_scatter_anisotropy = 0;  ///< mean cosine
    FloatInput diffuse_roughness{0, -1, 0};
    FloatInput specular{1, -1, 3};  ///< strength of the dielectric's reflection
    /// Its tint at normal incidence; may be above 1, the reflectance may not. Of glass and plastic: multiplies what the
    /// boundary reflects at all angles.
    ColorInput specular_color;
    ColorInput edge_color;  ///< metal: at 82 degrees, what is left of Schlick's reflectance
    /// Metal: complex index of refraction. Where k is above 0 what is reflected at each angle is what Fresnel's
    /// equations say of it; base_color and edge_color are those of the same metal then.
    Color conductor_eta{0, 0, 0}, conductor_k{0, 0, 0};
    /// How far facets are drawn out along the tangent: there alpha goes from roughness^2 to 1 by the square of it.
    FloatInput anisotropy{0, -1, 2};
    bool two_roughnesses = false;     ///< anisotropy is the roughness along the tangent, and roughness that across it
    double anisotropy_rotation = 0;   ///< radians, from the tangent towards the bitangent
    int anisotropy_texture = -1;      ///< red and green: the direction, of which 0.5 is 0; before the rotation
    bool beckmann = false;            ///< facets are Beckmann's, else GGX's; alpha is the roughness' square too
    bool separable = false;           ///< what hides GGX's facets from one direction says nothing of the other
    float optical_thickness = 0;      ///< plastic: of the grey layer between boundary and body
    bool nonlinear = true;            ///< plastic: what the boundary throws back is coloured each time
    float inner_reflectance = -1;     ///< plastic: what the boundary throws back; below 0: what follows from its facets
    bool energy_compensation = true;  ///< scaled for what facets scatter more than once, which is lost otherwise
    FloatInput coat{0, -1, 0};
    ColorInput coat_color;  ///< what the coat leaves of light that passes it
    FloatInput coat_roughness{0, -1, 1};
    float coat_ior = 1.5f;
    float coat_darkening = 1;  ///< how much of what goes up and down between coat and base is counted
    int coat_normal_texture = -1;
    float coat_normal_scale = 1;
    ColorInput sheen_color{{0, 0, 0}, -1};
    FloatInput sheen_roughness{0.3f, -1, 3};
    /// What the sheen leaves is by the direction in which it leaves less, as in glTF; else by the way out alone.
    bool sheen_reciprocal = false;
    FloatInput thin_film{0, -1, 0};              ///< share of the surface that has the film
    FloatInput thin_film_thickness{400, -1, 1};  ///< nanometres
    float thin_film_ior = 1.3f;
    // disney
    FloatInput flatness{0, -1, 0};       ///< how far what is diffuse is that of light scattered below the surface
    FloatInput specular_tint{0, -1, 0};  ///< how far the dielectric's reflection has the hue of base_color
    FloatInput sheen{0, -1, 0};
    FloatInput sheen_tint{0, -1, 0};  ///< how far the sheen has that hue
    FloatInput coat_gloss{0, -1, 0};  ///< 0: an alpha of 0.1, 1: one of 0.001
    int measured = -1;                ///< measured: into SceneDescription::measured
    // mix, two_sided: materials, which may be such themselves. What they emit, their alpha and their displacement don't
    // count: the mixture has its own.
    int material_a = -1, material_b = -1;
    FloatInput factor{0.5f, -1, 0};  ///< 0: material_a, 1: material_b
    // hair. Of absorption, the melanins together and base_color the first that is above 0 counts.
    ColorInput absorption{{0, 0, 0}, -1};     ///< coefficient times the fibre's radius
    float eumelanin = 0, pheomelanin = 0;     ///< concentrations: of black and brown, of red and yellow
    FloatInput beta_m{0.3f, -1, 1};           ///< roughness along the fibre, 0 to 1
    FloatInput beta_n{0.3f, -1, 1};           ///< and around it
    double scale_tilt = 0.03490658503988659;  ///< radians, towards the root
    float hair_ior = 1.55f;
    // all kinds
    ColorInput emission{{0, 0, 0}, -1};  ///< radiance
    bool emission_two_sided = false;     ///< else only on the side of the geometric normal
    int normal_texture = -1;
    float normal_scale = 1;
    /// The tangents that normal, coat normal and anisotropy maps refer to are those of the map's own texture
    /// coordinates (its set and transform), as in glTF; else those of the mesh's first set. Tangents that a mesh brings
    /// come first.
    bool map_tangents = true;
    /// Height above the surface, in units of the world, by whose slope the shading normal is bent (Blinn 1978), before
    /// normal_texture bends it. Only a texture has a slope.
    FloatInput bump{0, -1, 0};
    /// Height by which surfaces themselves are moved along their shading normal, in units of the shape's own space:
    /// value times what the texture is above displacement_midlevel; without one it counts as 1.
    FloatInput displacement{0, -1, 0};
    float displacement_midlevel = 0;
    double displacement_edge_length = 0;  ///< triangles get no longer edges before they are moved; 0: by the texture
    AlphaMode alpha_mode = AlphaMode::opaque;
    FloatInput alpha{1, -1, 3};
    float alpha_cutoff = 0.5f;
    bool one_sided = false;           ///< of what doesn't transmit: reflects nothing on its back
    bool single_sided = false;        ///< cameras look through it from behind; other light does not pass
    bool hidden_from_camera = false;  ///< cameras look through it; other rays, as those of mirrors, meet it
    /// No ray meets the surface, whatever its alpha, but its whole emission lights what it would if it were there.
    bool invisible_light = false;
    bool use_vertex_color = false;  ///< base_color (and alpha) times the mesh's vertex colours
};

/// Values at points of the unit square, of which those of the first and last row and column lie on its edges; linear in
/// between. Rows by growing v, in each of them u grows. Where there are several such tables they are behind each other.
struct MeasuredTable {
    int width = 0, height = 0;
    std::vector<float> values;
};

/// What was measured of how a surface reflects, as files of the RGL's database of materials have it: Dupuy and Jakob
/// 2018, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering". Directions are points of the
/// unit square: u the root of theta / (pi / 2), v as phi goes from -pi to pi.
struct MeasuredBrdf {
    std::string name;                     ///< of its file
    std::vector<float> theta{0}, phi{0};  ///< of the directions that the tables are for, radians, ascending
    MeasuredTable ndf, sigma;             ///< facets by their normal; their area as seen from a direction
    MeasuredTable vndf;                   ///< for each theta of each phi: how facets by their normal count there
    MeasuredTable luminance;              ///< the same: how light counts, over the square that vndf makes even
    MeasuredTable color;                  ///< over that square, too: red, green, blue for each theta of each phi
    bool color_is_per_facet = true;       ///< what is reflected is color * ndf / (4 sigma), else color alone

    /// Alike from all sides: normals' phi counts from the direction's.
    bool is_isotropic() const { return phi.size() <= 2; }
};

// ---------------------------------------------------------------------------------------------------- geometry

/// Where a mesh's vertices are at a time: as many as it has.
struct MeshKey {
    double time = 0;  ///< seconds
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;  ///< empty where the mesh has none
};

/// Triangles. Vectors per vertex are empty or as long as positions.
struct Mesh {
    std::string name;
    std::vector<Vec3f> positions;
    std::vector<Vec3f> normals;
    std::vector<Vec4f> tangents;         ///< w = +-1, the sign of the bitangent, as in glTF
    std::vector<Vec2f> uvs[2];           ///< v grows downwards in the image (glTF); OBJ importers flip
    std::vector<Vec4f> colors;           ///< linear, with alpha
    std::vector<std::uint32_t> indices;  ///< three a triangle
    /// Empty, or two and more by ascending time: vertices move along straight lines from one to the next, and stand
    /// still before the first and after the last. `positions` and `normals` are then the pose at rest, which is not
    /// shown.
    std::vector<MeshKey> motion;
    bool movable = false;  ///< its vertices will be other ones in later pictures: see SceneEdit
};

/// The normal points out; a negative radius turns it inwards (a hollow). Moves from center to center_end while the
/// shutter time goes from 0 to 1 second.
struct Sphere {
    Vec3d center;
    double radius = 1;
    std::optional<Vec3d> center_end;
};
/// corner, corner + edge_u, corner + edge_v, ...; the normal is along cross(edge_u, edge_v).
struct Rectangle {
    Vec3d corner, edge_u, edge_v;
};
/// Axis-aligned in its node's space; turned by the node's transform. Normals point out.
struct Box {
    Vec3d min, max;
};
struct Disk {
    Vec3d center, normal;
    double radius = 1;
};
struct MeshInstance {
    int mesh = -1;
};

enum class CurveBasis {
    linear,       ///< n points make n - 1 lines
    bezier,       ///< cubic; 3 n + 1 points make n segments, which share their ends
    bspline,      ///< cubic, uniform; n points make n - 3 segments, which pass near them
    catmull_rom,  ///< n points make n - 3 segments, which pass through all points but the first and the last
};
/// Where the control points of curves are at a time, and how thick: as many as the curves have.
struct CurvesKey {
    double time = 0;  ///< seconds
    std::vector<Vec3f> points;
    std::vector<float> radii;
};
/// Many curves of one kind, as of hair: their points one after the other, and how many each has.
struct Curves {
    std::string name;
    CurveBasis basis = CurveBasis::bspline;
    bool ribbons = false;  ///< flat bands that face each ray; else round
    std::vector<Vec3f> points;
    std::vector<float> radii;  ///< as many; half the width of a ribbon
    std::vector<std::uint32_t> counts;
    /// As Mesh::motion: control points and radii change linearly from one key to the next. `points` and `radii` are
    /// then not shown.
    std::vector<CurvesKey> motion;
};
struct CurvesInstance {
    int curves = -1;
};
/// Many balls.
struct Points {
    std::string name;
    std::vector<Vec3f> centers;
    std::vector<float> radii;  ///< as many, above 0
};
struct PointsInstance {
    int points = -1;
};

struct Shape {
    std::variant<MeshInstance, Sphere, Rectangle, Box, Disk, CurvesInstance, PointsInstance> geometry;
    int material = -1;  ///< -1: grey diffuse
    std::string name;   ///< for messages and ids; may be empty
};

// ---------------------------------------------------------------------------------------------------- lights, camera

enum class LightKind {
    point,
    spot,
    directional,
    projector,    ///< a point from which a picture is projected through a frustum
    goniometric,  ///< a point whose intensity is a picture over all directions, or an IES file's
    beam,         ///< parallel light from a flat area
};

/// What an angle of view is measured across.
enum class FovAxis { smaller, larger, width, height, diagonal };

/// How a spot's light falls from its inner to its outer cone.
enum class SpotFalloff {
    square,  ///< as the square of the cosine's share of the way: KHR_lights_punctual
    smooth,  ///< as a smooth step of that share: pbrt
    linear,  ///< as the angle's share of the way: Mitsuba
};

/// By what a light's intensity is multiplied, direction by direction.
struct LightPicture {
    int image = -1;  ///< -1: none, which is white
    ColorSpace color_space = ColorSpace::srgb;
    bool nearest = false;  ///< the nearest pixel's value, instead of what lies between four
};

/// A light without a surface, at the origin of its node, shining along the node's -z (all but point lights). Of a
/// picture the right is at the node's +x, the top at +y, whatever the node's scale; where the node mirrors, it is
/// mirrored.
struct Light {
    std::string name;
    LightKind kind = LightKind::point;
    /// Directional, beam: irradiance (lux) at normal incidence; others: radiant intensity (candela), multiplied by the
    /// picture.
    Color intensity{1, 1, 1};
    double inner_angle = 0, outer_angle = 0.7853981633974483;  ///< spot: half angles, falling between
    double angle = 0;  ///< directional: angular diameter of the disk it comes from; 0 is a delta
    /// Spot: stretched over a square that touches the outer cone. Projector: with square pixels. Goniometric: an
    /// equal-area square as Environment has it, its middle along -z; or a file whose name ends with .ies (LM-63), of
    /// candela, whose nadir is along -z and whose plane of 0 degrees is at +x.
    LightPicture picture{};
    SpotFalloff falloff = SpotFalloff::square;
    double fov = 0.7853981633974483;  ///< projector: full angle of the picture
    FovAxis fov_axis = FovAxis::smaller;
    /// Beam: the area across the node's z that it comes from, along x and y, in the node's own measure: a rectangle, or
    /// an ellipse. Where the node shears it, light goes along its normal.
    double width = 1, height = 1;
    bool round = false;
    /// Projector: the picture is what arrives on a screen across the axis at a distance of 1 (lux), not what is sent.
    bool flat_field = false;
    /// Projector, goniometric: the intensity is the flux of all directions together (lumen) instead, however bright the
    /// picture is.
    bool intensity_is_flux = false;
};

enum class EnvironmentKind {
    none,
    constant,
    gradient,
    image,
    studio,        ///< three soft lights around what is shown, for a camera that looks along -z, and a dim room
    sky,           ///< a clear sky over grey ground, computed from the air; the sun too if sun_disk
    cube,          ///< six pictures, the faces of a cube around everything
    equal_area,    ///< a square picture of all directions, each with its share of the area, as pbrt-v4 has them
    hosek_wilkie,  ///< a clear sky by the formula of Hosek and Wilkie, without its sun, nothing below the horizon
};

/// What a ray sees that leaves the scene, and what lights it from there.
struct Environment {
    EnvironmentKind kind = EnvironmentKind::none;
    Color color{1, 1, 1};                       ///< constant: radiance; others: multiplied
    Color bottom{1, 1, 1}, top{0.5f, 0.7f, 1};  ///< gradient: mixed by (1 + y) / 2 of the direction's up component
    int image = -1;                             ///< equirectangular or equal-area, linear (8-bit files: sRGB)
    /// Of a picture, above 0: it is made as bright as lights a surface, which faces its top (of an equal-area one, its
    /// middle), by this many lux; colours are multiplied afterwards.
    double illuminance = 0;
    /// Cube: towards +x, -x, +y, -y, +z, -z, turned as OpenGL has them; linear (8-bit files: sRGB), over their alpha.
    std::array<int, 6> faces{-1, -1, -1, -1, -1, -1};
    Transform world_from_environment;  ///< rotation; the image's middle looks along +x, its top along +y.
                                       ///< Equal-area: the middle along +z, its right along +x, its bottom along +y
    /// Sky: where the sun is; up is +y. A white surface that faces the sun above the air has a radiance of 1: times
    /// 42,000 that is nits.
    Vec3d to_sun{-0.4, 0.6, 0.7};
    bool sun_disk = true;
    /// Hosek-Wilkie, which has to_sun too, and a radiance in W/m^2/sr/nm, of around 0.1: 1 (clear) to 10 (haze), and 0
    /// to 1, of the ground that lights the air.
    double turbidity = 3, ground_albedo = 0.3;
    bool sky_ground = true;  ///< sky: grey ground below the horizon, in the light of sun and sky; else nothing
};

enum class CameraKind {
    perspective,
    orthographic,
    spherical,  ///< all directions: equirectangular, `up` at the top, the direction of look_at in the middle
    equal_area  ///< all directions, each with its share of the picture, as pbrt-v4 has it: `up` in the middle, the
                ///< direction of look_at at the top, its opposite at all corners
};

/// In the space of its node: looks from position to look_at.
struct Camera {
    std::string name;
    CameraKind kind = CameraKind::perspective;
    Vec3d position{0, 0, 0}, look_at{0, 0, -1}, up{0, 1, 0};
    double fov_y = 0.6981317007977318;  ///< perspective: full vertical angle
    double height = 2;                  ///< orthographic: metres from the bottom to the top of the picture
    /// Above 0: fov_y and height are those of a picture of this width / height; one of another shape keeps the angle,
    /// or the length, across fov_axis.
    double fov_aspect = 0;
    FovAxis fov_axis = FovAxis::height;
    double aspect = 0;  ///< width / height; 0: as the picture
    /// What is seen is moved by so many of its widths to the right and of its heights up, without turning the camera: a
    /// lens that is shifted, or a part of a larger picture.
    double shift_x = 0, shift_y = 0;
    double aperture = 0;                         ///< diameter of the lens in metres
    double focus_distance = 0;                   ///< metres along the view axis; 0: the distance to look_at
    double shutter_open = 0, shutter_close = 0;  ///< seconds
};

// ---------------------------------------------------------------------------------------------------- the scene

/// Where a node is at a time.
struct NodeKey {
    double time = 0;  ///< seconds
    Transform parent_from_node;
};

/// A place in the scene. A node may be the child of several nodes: that makes instances. Cycles are an error.
struct Node {
    std::string name;
    Transform parent_from_node;  ///< at rest: not used where there is motion
    /// Empty, or two and more by ascending time. Between them each is taken for a stretching along axes of the node,
    /// a rotation and a translation: the first and the last change linearly, the rotation turns steadily, the shorter
    /// way round. Before the first and after the last the node stands still. Cameras and lights don't move: they stand
    /// where they are when the shutter opens.
    std::vector<NodeKey> motion;
    std::vector<int> children;
    std::vector<Shape> shapes;
    int light = -1, camera = -1;
    bool movable = false;  ///< it will stand elsewhere in later pictures, with what is below it: see SceneEdit
};

/// Temperatures of light that can be told to be white.
inline constexpr double min_white_kelvin = 1000, max_white_kelvin = 25000;

/// Render settings that a scene file may give; an option of the command line overrides them.
struct RenderHints {
    std::optional<int> width, height, samples, max_depth, roulette_depth;
    std::optional<std::string> filter;    ///< box, gaussian, blackman-harris, tent
    std::optional<double> filter_radius;  ///< pixels that it reaches from its middle
    std::optional<bool> light_sampling;
    std::optional<double> exposure;       ///< stops (ev)
    std::optional<double> white_balance;  ///< kelvin: light of this temperature is shown as white
    std::optional<Color> background;  ///< what the camera sees instead of the environment, which lights all the same
    bool own_light = false;           ///< the file's light is meant as it is, however dim: none is added
    std::optional<std::string> tonemap;
    std::optional<std::string> build;  ///< fast, default, high: work for the tree, see tree_build.h
};

struct SceneDescription {
    std::string file;                          ///< where it came from, for messages
    std::vector<std::filesystem::path> files;  ///< all that were read for it, its own first; not those of images
    std::vector<ImageFile> images;
    std::vector<Texture> textures;
    std::vector<Material> materials;
    std::vector<MeasuredBrdf> measured;
    std::vector<Mesh> meshes;
    std::vector<Curves> curves;
    std::vector<Points> points;
    std::vector<Light> lights;
    std::vector<Camera> cameras;
    std::vector<Node> nodes;
    std::vector<int> roots;  ///< nodes without a parent that are part of the scene
    Environment environment;
    RenderHints hints;
};

}  // namespace fathom
