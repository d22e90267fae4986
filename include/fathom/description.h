// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "fathom/api.h"
#include "fathom/vector.h"

/// The contents of a scene as plain data, independent of file formats. Importers fill it from files, and programs fill
/// it to make a scene in code.
///
/// Objects refer to each other by index into the vectors of SceneDescription; -1 means none. Units are meters, radians
/// and seconds; radiance and colors are linear Rec.709, and a radiance of 1 is 1 nit. World space is right-handed and y
/// points up. docs/scene-format.md describes the same parameters with examples.
namespace fathom {

// ---------------------------------------------------------------------------------------------------- textures

/// An encoded image: PNG, JPEG, WebP, AVIF, HDR, EXR, PFM, KTX2 or a format of stb_image. It is either a file or a
/// block of bytes.
struct ImageFile {
    std::string name;              ///< Name of an embedded image, for messages.
    std::filesystem::path path;    ///< The file; empty if `bytes` are given.
    std::vector<std::byte> bytes;  ///< The encoded file, if it is embedded in the scene file.
};

/// Encoding of the 8- and 16-bit values of a color image. HDR, EXR and PFM are always linear.
enum class ColorSpace {
    srgb,   ///< sRGB transfer function (IEC 61966-2-1).
    linear  ///< No transfer function, for numbers and normals.
};
/// What an image texture contains outside texture coordinates 0 to 1.
enum class Wrap {
    repeat,     ///< The image is repeated.
    clamp,      ///< The nearest pixel of the border.
    mirror,     ///< The image is repeated, every other copy mirrored.
    black,      ///< 0, including alpha.
    octahedral  ///< Folded across each edge, for octahedral maps of directions. It is meant for both axes.
};

/// A color parameter: `value`, multiplied by the texture if there is one.
struct ColorInput {
    Color value{1, 1, 1};  ///< Constant factor.
    int texture = -1;      ///< Index into SceneDescription::textures; -1: none.
};
/// Channel number that selects the luminance of a texture: 0.2126 r + 0.7152 g + 0.0722 b.
inline constexpr int luminance_channel = 4;

/// A number parameter: `value`, multiplied by a channel of the texture if there is one.
struct FloatInput {
    float value = 1;   ///< Constant factor.
    int texture = -1;  ///< Index into SceneDescription::textures; -1: none.
    int channel = 0;   ///< Channel of the texture: 0 red, 1 green, 2 blue, 3 alpha, or luminance_channel.
};

/// Function that a texture computes. Here p is the position in the texture's space (world space by default), and u and
/// v are transformed texture coordinates. "From color_a to color_b by x" is color_a + x (color_b - color_a), without
/// limiting x.
enum class TextureKind {
    image,          ///< Image, looked up bilinearly or at the nearest pixel in full resolution.
    checker_uv,     ///< color_a where floor(scale u) + floor(scale v) is even, otherwise color_b.
    checker_space,  ///< color_b where sin(scale x) sin(scale y) sin(scale z) < 0, otherwise color_a.
    noise,          ///< From color_a to color_b by 0.5 (1 + n(scale p)) with Perlin noise n (Perlin 2002, hashed).
    turbulence,     ///< From color_a to color_b by the sum of |n(2^i scale p)| / 2^i over octaves i.
    marble,         ///< From color_a to color_b by 0.5 (1 + sin(scale z + turbulence_weight turbulence(p))).
    fbm,            ///< From color_a to color_b by the sum of gain^i n(1.99^i scale p) over octaves i, as in pbrt-v4.
    wrinkled,       ///< As fbm with |n| instead of n, plus 0.2 gain^octaves for the octaves that are left out.
    windy,          ///< From color_a to color_b by fbm(scale p) with 6 octaves times |fbm(0.1 scale p)| with 3.
    veined_marble,  ///< Bands of scale y + turbulence_weight fbm(scale p) in fixed grays, as pbrt-v4's marble.
    dots,           ///< color_b in disks of radius 0.35 in about half of the cells of (scale u, scale v), otherwise
                    ///< color_a; as in pbrt-v4.
    coordinates,    ///< Texture coordinates as a color: red is u, green is v, blue is 0.
    facing,         ///< From color_a to color_b by the absolute cosine between geometric normal and direction.
    mix,            ///< From color_a to color_b by factor.
    scale,          ///< color_a times color_b.
    uv_transform,   ///< color_a, with its texture evaluated at the transformed texture coordinates of this texture.
    ramp,           ///< Color of factor: linear interpolation between the colors of stops.
    vertex_color,   ///< Vertex color of the mesh; white if it has none.
    invert,         ///< 1 - color_a, at least 0.
    clamp,          ///< color_a, limited to 0 to 1.
};
/// Number of values of TextureKind.
inline constexpr int texture_kind_count = 20;

/// Source of the texture coordinates of image, checker_uv, dots, coordinates and uv_transform. Here (x, y, z) is the
/// position in the texture's space.
enum class TextureMapping {
    uv,           ///< Texture coordinates of the surface.
    spherical,    ///< u: angle about z, counted from x, over 2 pi; v: angle to z over pi.
    cylindrical,  ///< u: 0.5 plus the angle about z from -pi to pi over 2 pi; v: z.
    planar        ///< u: x; v: y.
};

/// A stop of a ramp: the color at a number.
struct RampStop {
    float position = 0;  ///< Number at which the ramp has this color.
    Color color;         ///< Color of the ramp at `position`.
};

/// A node of the texture graph. Its inputs may refer to other textures, up to 16 deep and without cycles. A texture has
/// three color channels and alpha; alpha is 1 where all inputs are constant colors.
struct Texture {
    std::string name;  ///< Name for messages and scene files; may be empty.
    /// Function that the texture computes. It decides which of the members below apply.
    TextureKind kind = TextureKind::image;

    // Kind image.
    int image = -1;                                     ///< Index into SceneDescription::images.
    ColorSpace color_space = ColorSpace::srgb;          ///< Encoding of 8- and 16-bit images.
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;  ///< What is outside 0 to 1 along u and v.
    bool nearest = false;                               ///< Looks up the nearest pixel, not bilinearly.
    /// If not 0, the image (its first channel) is a height map, and the texture is its normal map. White is higher than
    /// black by this fraction of the image's width.
    float height_scale = 0;

    // Kinds image, checker_uv, dots, coordinates and uv_transform: texture coordinates are
    // uv_offset + rotation(uv_scale * uv).
    TextureMapping mapping = TextureMapping::uv;  ///< Source of the texture coordinates.
    int uv_set = 0;                               ///< Set of texture coordinates of the mesh, 0 or 1.
    Vec2f uv_offset{0, 0}, uv_scale{1, 1};        ///< Offset and scale of the texture coordinates.
    float uv_rotation = 0;                        ///< Rotation in radians, as in KHR_texture_transform.
    /// Places the texture in world space: for kinds that use p, and for all mappings except uv. Must not be singular.
    Transform world_from_texture;

    // Procedural kinds.
    float scale = 1;               ///< Frequency: all kinds whose formula has a scale.
    float turbulence_weight = 10;  ///< marble, veined_marble: strength of the distortion of the bands.
    int octaves = 7;               ///< turbulence, marble, fbm, wrinkled, veined_marble: number of octaves, 1 to 16.
    float gain = 0.5f;         ///< fbm, wrinkled, veined_marble: amplitude of an octave over that of the one before.
    Vec3d direction{0, 1, 0};  ///< facing: direction in world space, of any length above 0.
    /// Color inputs of all kinds whose formula has color_a and color_b.
    ColorInput color_a{{0, 0, 0}, -1}, color_b{{1, 1, 1}, -1};
    FloatInput factor;            ///< mix, ramp: the number that selects the color.
    std::vector<RampStop> stops;  ///< ramp: 2 to 16 stops in ascending order of position.
};

// ---------------------------------------------------------------------------------------------------- materials

/// Reflection model of a material.
enum class MaterialKind {
    none,        ///< Black; for surfaces that only emit light.
    unlit,       ///< Appears in base_color whatever the light, also in mirrors and through glass. It doesn't illuminate
                 ///< other surfaces.
    diffuse,     ///< Lambertian; with roughness above 0 energy-preserving Oren-Nayar (Portsmouth et al. 2024, "EON").
    metal,       ///< GGX conductor; base_color is the reflectance at normal incidence, and roughness 0 is a mirror.
    fuzz_metal,  ///< Metal of "Ray Tracing in One Weekend": mirror direction plus fuzz times a random point of the unit
                 ///< sphere.
    glass,       ///< Smooth or rough dielectric, solid or thin. The inside of a solid can absorb and scatter light.
    plastic,     ///< Dielectric boundary, smooth or rough, over a diffuse body of base_color.
    /// Hair fiber: a rough absorbing cylinder of glass with tilted scales (Chiang et al. 2016). It is meant for curves;
    /// on other shapes fibers run along growing u, and v is the position across a fiber.
    hair,
    /// Layers in the manner of OpenPBR: sheen over coat over a mixture of metal and dielectric. Below the boundary of
    /// the dielectric, light is reflected diffusely, transmitted diffusely, or refracted. By default it is the
    /// metallic-roughness model of glTF 2.0.
    principled,
    /// Disney's BSDF (Burley 2012, 2015): a sum of microfacet, diffuse, sheen and clear coat lobes.
    disney,
    measured,  ///< Measured reflectance: SceneDescription::measured.
    mix,       ///< Two materials, of which a path meets material_b with probability factor, otherwise material_a.
    two_sided  ///< material_a on the side of the geometric normal, material_b on the other side.
};
/// Number of values of MaterialKind.
inline constexpr int material_kind_count = 13;

/// Effect of a material's alpha.
enum class AlphaMode {
    opaque,  ///< Alpha is ignored.
    mask,    ///< The surface is visible where alpha is at least alpha_cutoff.
    blend    ///< Alpha is the opacity: a ray meets the surface with this probability.
};

/// A material. Its kind decides which members apply; the headings and comments name these kinds. Members of other kinds
/// are ignored. Colors that are reflectances or transmittances are 0 to 1.
struct Material {
    std::string name;                           ///< Name for messages and scene files; may be empty.
    MaterialKind kind = MaterialKind::diffuse;  ///< Reflection model.

    // --- Base parameters of several kinds
    /// Reflectance; for unlit the visible color, for hair the color of much hair. All kinds except glass, measured,
    /// mix, two_sided and none.
    ColorInput base_color{{0.8f, 0.8f, 0.8f}, -1};
    /// Perceptual roughness, 0 smooth to 1 rough; the GGX alpha is its square. All kinds with a surface except
    /// fuzz_metal, hair and measured.
    FloatInput roughness{0, -1, 1};
    FloatInput metallic{0, -1, 2};  ///< principled, disney: fraction of metal, 0 to 1.
    float fuzz = 0;                 ///< fuzz_metal: size of the random offset, 0 (mirror) to 1.
    float ior = 1.5f;  ///< glass, plastic, principled, disney: index of refraction relative to empty space.

    // --- Inside of solids: glass, and principled and disney with transmission
    Color attenuation_color{1, 1, 1};     ///< Fraction of white light that remains after attenuation_distance.
    double attenuation_distance = 0;      ///< Distance in meters that attenuation_color is for; 0: a clear solid.
    Color transmission_scatter{0, 0, 0};  ///< Scattering coefficient times attenuation_distance.
    /// Mean cosine of the Henyey-Greenstein phase function, -0.99 (backward) to 0.99 (forward).
    float transmission_scatter_anisotropy = 0;
    /// Counts scattering events inside as bounces if there is a RenderSettings::max_depth.
    bool transmission_scatter_bounces = false;
    /// Where solids overlap, the one with the highest priority counts; among equal ones the one entered last (Schmidt
    /// and Budge 2002, "Simple Nested Dielectrics in Ray Traced Images").
    int priority = 0;
    /// glass, principled: fraction of light that remains after entering and leaving a solid, or passing a thin sheet.
    ColorInput transmission_color;
    /// glass, principled, disney: a sheet without thickness, which doesn't deflect transmitted light.
    bool thin = false;

    // --- principled: dielectric base. disney also has transmission and diffuse_transmission
    FloatInput transmission{0, -1, 0};          ///< Fraction of the light below the boundary that is refracted.
    float dispersion = 0;                       ///< 20 / Abbe number; glass has 0.3 to 0.9.
    FloatInput diffuse_transmission{0, -1, 3};  ///< Fraction of the diffuse light that leaves on the other side.
    ColorInput diffuse_transmission_color;      ///< Color of diffuse transmission.
    /// Adds diffuse transmission to diffuse reflection instead of subtracting it. Together they are limited to 1.
    bool diffuse_transmission_added = false;
    /// Fraction of the diffuse light that enters the solid, is scattered there, and leaves it diffusely.
    FloatInput subsurface{0, -1, 0};
    ColorInput subsurface_color{{0.8f, 0.8f, 0.8f}, -1};       ///< Reflectance of a half-space in uniform light.
    FloatInput subsurface_radius{0.01f, -1, 0};                ///< Mean free path in meters.
    ColorInput subsurface_radius_scale{{1, 0.5f, 0.25f}, -1};  ///< Factor of subsurface_radius for each channel.
    float subsurface_scatter_anisotropy = 0;                   ///< Mean cosine of scattering, -0.99 to 0.99.
    FloatInput diffuse_roughness{0, -1, 0};                    ///< Oren-Nayar roughness of diffuse reflection, 0 to 1.
    FloatInput specular{1, -1, 3};                             ///< Strength of the dielectric's reflection, 0 to 1.
    /// principled: tint of the dielectric's reflection at normal incidence; values above 1 raise the reflectance, at
    /// most to 1. glass, plastic: factor of the reflection at all angles, 0 to 1.
    ColorInput specular_color;

    // --- principled: metal base
    ColorInput edge_color;  ///< Tint at 82 degrees, a factor of Schlick's reflectance.
    /// Real and imaginary part of the index of refraction. Where k is above 0, Fresnel's equations give the
    /// reflectance; base_color and edge_color should then describe the same metal.
    Color conductor_eta{0, 0, 0}, conductor_k{0, 0, 0};

    // --- Microfacets: metal, glass, plastic, principled, disney
    /// principled, disney: stretches microfacets along the tangent, 0 to 1. principled: the alpha along the tangent
    /// goes from roughness^2 to 1 with the square of anisotropy.
    FloatInput anisotropy{0, -1, 2};
    /// principled: anisotropy is the roughness along the tangent, and roughness that across it.
    bool two_roughnesses = false;
    double anisotropy_rotation = 0;  ///< principled: rotation of the tangent towards the bitangent in radians.
    /// principled: texture whose red and green are the direction of stretching; 0.5 stands for 0. It is applied before
    /// anisotropy_rotation.
    int anisotropy_texture = -1;
    /// metal, glass, plastic, principled: Beckmann distribution instead of GGX, with the same alpha.
    bool beckmann = false;
    /// metal, glass, plastic, principled: separable masking and shadowing of GGX instead of height-correlated.
    bool separable = false;

    // --- plastic
    float optical_thickness = 0;   ///< Optical thickness of a gray absorbing layer between boundary and body.
    bool nonlinear = true;         ///< Light reflected between boundary and body is tinted by the body each time.
    float inner_reflectance = -1;  ///< Fraction of light from below that the boundary reflects; -1: by its microfacets.

    // --- glass, plastic, principled
    /// Compensates for the light that single scattering by rough microfacets loses (Turquin 2019, "Practical multiple
    /// scattering compensation for microfacet models").
    bool energy_compensation = true;

    // --- principled: coat, sheen and thin film. disney also has coat
    FloatInput coat{0, -1, 0};            ///< Strength of the coat, 0 to 1.
    ColorInput coat_color;                ///< Fraction of light that the coat transmits.
    FloatInput coat_roughness{0, -1, 1};  ///< Perceptual roughness of the coat, 0 to 1.
    float coat_ior = 1.5f;                ///< Index of refraction of the coat, 1 to 3.
    float coat_darkening = 1;             ///< Fraction of the interreflection between coat and base to include, 0 to 1.
    int coat_normal_texture = -1;         ///< Tangent-space normal map of the coat; -1: normals of the mesh.
    float coat_normal_scale = 1;          ///< Factor of x and y of the coat's normal map.
    ColorInput sheen_color{{0, 0, 0}, -1};    ///< Reflectance of the sheen.
    FloatInput sheen_roughness{0.3f, -1, 3};  ///< Roughness of the sheen, 0 (upright fibers) to 1.
    /// Attenuates the layers below the sheen by the darker of both directions, as in glTF, which is reciprocal but
    /// loses some light. Otherwise only the outgoing direction counts.
    bool sheen_reciprocal = false;
    FloatInput thin_film{0, -1, 0};              ///< Fraction of the surface that the film covers, 0 to 1.
    FloatInput thin_film_thickness{400, -1, 1};  ///< Thickness of the film in nanometers.
    float thin_film_ior = 1.3f;                  ///< Index of refraction of the film, 1 to 3.

    // --- disney
    FloatInput flatness{0, -1, 0};       ///< Blends diffuse reflection with an approximation of subsurface scattering.
    FloatInput specular_tint{0, -1, 0};  ///< How far the dielectric's reflection has the hue of base_color, 0 to 1.
    FloatInput sheen{0, -1, 0};          ///< Strength of the reflection at grazing angles, 0 to 1.
    FloatInput sheen_tint{0, -1, 0};     ///< How far the sheen has the hue of base_color, 0 to 1.
    FloatInput coat_gloss{0, -1, 0};     ///< Gloss of the coat: 0 is an alpha of 0.1, 1 an alpha of 0.001.

    // --- measured
    int measured = -1;  ///< Index into SceneDescription::measured.

    // --- mix, two_sided. A mixture has its own emission, alpha and displacement; those of its materials are ignored
    int material_a = -1, material_b = -1;  ///< Materials, which may be mixtures themselves, up to 16 deep.
    FloatInput factor{0.5f, -1, 0};        ///< mix: probability of material_b, 0 to 1.

    // --- hair. Its color is given by the first that is above 0: absorption, melanin (both), base_color
    ColorInput absorption{{0, 0, 0}, -1};     ///< Absorption coefficient times the radius of the fiber.
    float eumelanin = 0, pheomelanin = 0;     ///< Concentrations of brown to black and of red to yellow pigment.
    FloatInput beta_m{0.3f, -1, 1};           ///< Roughness along the fiber, 0 to 1.
    FloatInput beta_n{0.3f, -1, 1};           ///< Roughness around the fiber, 0 to 1.
    double scale_tilt = 0.03490658503988659;  ///< Angle of the scales to the fiber in radians (2 degrees by default).
    float hair_ior = 1.55f;                   ///< Index of refraction of the fiber, 1 to 3.

    // --- All kinds, except as noted
    ColorInput emission{{0, 0, 0}, -1};  ///< Emitted radiance in nits. Not for unlit.
    bool emission_two_sided = false;     ///< Emits on both sides; by default only on the side of the geometric normal.
    /// Tangent-space normal map, green is up; -1: none. Not for hair, unlit, none, mix and two_sided.
    int normal_texture = -1;
    float normal_scale = 1;  ///< Factor of x and y of the normal map.
    /// For meshes without tangents: normal_texture, coat_normal_texture and anisotropy_texture use tangents that follow
    /// the texture coordinates of the map itself (its set and transform), as in glTF. If false, they use tangents of
    /// the mesh's first set.
    bool map_tangents = true;
    /// Height in world-space meters whose slope bends the shading normal (Blinn 1978) before normal_texture does. It
    /// has no effect without a texture.
    FloatInput bump{0, -1, 0};
    /// Height, in units of the shape's own space, by which the surface is moved along its shading normal: value times
    /// (texture - displacement_midlevel). Without a texture its value counts as 1.
    FloatInput displacement{0, -1, 0};
    float displacement_midlevel = 0;  ///< Texture value that doesn't move the surface.
    /// Maximum edge length of displaced triangles, in units of the shape's own space; 0: as fine as the texture.
    double displacement_edge_length = 0;
    AlphaMode alpha_mode = AlphaMode::opaque;  ///< Effect of alpha.
    FloatInput alpha{1, -1, 3};                ///< Opacity, 0 to 1.
    float alpha_cutoff = 0.5f;                 ///< AlphaMode::mask: smallest alpha that is visible.
    bool one_sided = false;           ///< The back reflects nothing. Only for materials that don't transmit light.
    bool single_sided = false;        ///< Camera rays pass through the back of the surface; all other rays meet it.
    bool hidden_from_camera = false;  ///< Camera rays pass through the surface; all other rays meet it.
    /// No ray meets the surface, whatever its alpha, but its emission lights the scene.
    bool invisible_light = false;
    bool use_vertex_color = false;  ///< Multiplies base_color and alpha by the mesh's vertex colors.
};

/// One or more tables of values over the unit square, stored one after the other. Values are at regularly spaced points
/// that include the edges, with bilinear interpolation between them. v grows from row to row, u within a row.
struct MeasuredTable {
    int width = 0, height = 0;  ///< Number of values along u and v, 2 to 4096.
    std::vector<float> values;  ///< width * height values for each table.
};

/// A measured BRDF in the representation of the RGL material database: J. Dupuy and W. Jakob 2018, "An Adaptive
/// Parameterization for Efficient Material Acquisition and Rendering".
///
/// Directions are points (u, v) of the unit square: u is the square root of theta / (pi / 2), and v goes from 0 to 1 as
/// phi goes from -pi to pi. Tables for several incident directions are ordered by phi, then theta.
struct MeasuredBrdf {
    std::string name;  ///< Name of the file it was read from.
    /// Angles of the incident directions that the tables are for, in radians and ascending order.
    std::vector<float> theta{0}, phi{0};
    /// Distribution of microfacet normals, and projected area of the microfacets by direction: one table each.
    MeasuredTable ndf, sigma;
    MeasuredTable vndf;  ///< Distribution of visible normals: a table for each incident direction.
    MeasuredTable
        luminance;        ///< Density for sampling, over the square that `vndf` maps to: a table for each direction.
    MeasuredTable color;  ///< Reflectance over the same square: three tables (R, G, B) for each incident direction.
    bool color_is_per_facet = true;  ///< The BRDF times the cosine is color * ndf / (4 sigma); otherwise it is color.

    /// Returns whether the BRDF is isotropic: phi of outgoing directions is then relative to the incident direction.
    bool is_isotropic() const { return phi.size() <= 2; }
};

// ---------------------------------------------------------------------------------------------------- geometry

/// Vertices of a mesh at one time.
struct MeshKey {
    double time = 0;               ///< Time of the key in seconds.
    std::vector<Vec3f> positions;  ///< One position for each vertex, in the space of the mesh.
    std::vector<Vec3f> normals;    ///< One normal for each vertex; empty if the mesh has none.
};

/// A triangle mesh. Vectors of vertex data are empty or as long as `positions`. Triangles are counterclockwise as seen
/// from the side of the geometric normal.
struct Mesh {
    std::string name;              ///< Name for messages and scene files; may be empty.
    std::vector<Vec3f> positions;  ///< Vertex positions in meters, before the transform of the node.
    std::vector<Vec3f> normals;    ///< Shading normals; empty: those of the triangles.
    std::vector<Vec4f> tangents;   ///< Tangents; w is 1 or -1, the sign of the bitangent, as in glTF.
    std::vector<Vec2f> uvs[2];     ///< Two sets of texture coordinates; v grows downwards in the image, as in glTF.
    std::vector<Vec4f> colors;     ///< Vertex colors, linear with alpha.
    std::vector<std::uint32_t> indices;  ///< Three vertex indices for each triangle.
    /// Empty, or at least two keys in ascending order of time. Vertices move linearly between keys and don't move
    /// before the first and after the last one. `positions` and `normals` are then not rendered.
    std::vector<MeshKey> motion;
    bool movable = false;  ///< Vertices will change between images; see SceneEdit.
};

/// A sphere. Its normals point outwards; a negative radius turns them inwards.
struct Sphere {
    Vec3d center;       ///< Center in the space of the node.
    double radius = 1;  ///< Radius in meters.
    /// Center at time 1 second, for a sphere that moves linearly from `center` at time 0.
    std::optional<Vec3d> center_end;
};
/// A parallelogram with corners corner, corner + edge_u, corner + edge_v and corner + edge_u + edge_v. Its normal is
/// along cross(edge_u, edge_v).
struct Rectangle {
    Vec3d corner, edge_u, edge_v;  ///< One corner, and the edges along u and v.
};
/// A box with faces along the axes of its node's space. Normals point outwards.
struct Box {
    Vec3d min, max;  ///< Opposite corners in the space of the node.
};
/// A flat disk.
struct Disk {
    Vec3d center, normal;  ///< Center, and normal of any length above 0.
    double radius = 1;     ///< Radius in meters.
};
/// A mesh that a node places.
struct MeshInstance {
    int mesh = -1;  ///< Index into SceneDescription::meshes.
};

/// Meaning of the control points of a curve.
enum class CurveBasis {
    linear,       ///< n points make n - 1 straight segments.
    bezier,       ///< 3 n + 1 points make n cubic segments, which share their end points.
    bspline,      ///< n points make n - 3 segments of a uniform cubic B-spline, which passes near the points.
    catmull_rom,  ///< n points make n - 3 cubic segments through all points except the first and the last.
};
/// Control points and radii of curves at one time, as many as the curves have.
struct CurvesKey {
    double time = 0;            ///< Time of the key in seconds.
    std::vector<Vec3f> points;  ///< Control points of all curves.
    std::vector<float> radii;   ///< Radius at each control point.
};
/// A set of curves, such as hair, whose control points are stored one curve after the other.
struct Curves {
    std::string name;                        ///< Name for messages and scene files; may be empty.
    CurveBasis basis = CurveBasis::bspline;  ///< Meaning of the control points.
    bool ribbons = false;                    ///< Flat strips that face each ray; otherwise round curves.
    std::vector<Vec3f> points;               ///< Control points of all curves.
    std::vector<float> radii;                ///< Radius in meters at each control point; half the width of a ribbon.
    std::vector<std::uint32_t> counts;       ///< Number of control points of each curve.
    /// Empty, or at least two keys in ascending order of time. Points and radii change linearly between keys. `points`
    /// and `radii` are then not rendered.
    std::vector<CurvesKey> motion;
};
/// Curves that a node places.
struct CurvesInstance {
    int curves = -1;  ///< Index into SceneDescription::curves.
};
/// A set of spheres that take little memory.
struct Points {
    std::string name;            ///< Name for messages and scene files; may be empty.
    std::vector<Vec3f> centers;  ///< Center of each sphere.
    std::vector<float> radii;    ///< Radius of each sphere in meters, above 0.
};
/// Points that a node places.
struct PointsInstance {
    int points = -1;  ///< Index into SceneDescription::points.
};

/// Geometry with a material, in the space of its node.
struct Shape {
    /// Mesh, primitive, curves or points.
    std::variant<MeshInstance, Sphere, Rectangle, Box, Disk, CurvesInstance, PointsInstance> geometry;
    int material = -1;  ///< Index into SceneDescription::materials; -1: gray diffuse (0.8).
    std::string name;   ///< Name for messages; may be empty.
};

// ---------------------------------------------------------------------------------------------------- lights, camera

/// Kind of a light without a surface.
enum class LightKind {
    point,        ///< Emits from a point with the same intensity in all directions.
    spot,         ///< Emits from a point into a cone.
    directional,  ///< Emits from infinitely far away, like the sun.
    projector,    ///< Projects an image from a point through a frustum.
    goniometric,  ///< Emits from a point, with an intensity given by an image of all directions or an IES file.
    beam,         ///< Emits parallel light from a flat area.
    tube,         ///< Emits diffusely from the side of a cylinder, like a fluorescent tube.
};
/// Name of a kind of light, as in scene files.
FATHOM_API const char* light_kind_name(LightKind kind);

/// Axis of the image across which an angle of view is measured.
enum class FovAxis {
    smaller,  ///< Smaller of width and height of the image.
    larger,   ///< Larger of width and height of the image.
    width,    ///< Width of the image.
    height,   ///< Height of the image.
    diagonal  ///< Diagonal of the image.
};

/// How the intensity of a spot light falls from its inner to its outer cone.
enum class SpotFalloff {
    square,  ///< Square of the relative position of the cosine, as in KHR_lights_punctual.
    smooth,  ///< Smooth step of the relative position of the cosine, as in pbrt.
    linear,  ///< Linear in the angle, as in Mitsuba.
};

/// An image that multiplies the intensity of a light in each direction.
struct LightPicture {
    int image = -1;                             ///< Index into SceneDescription::images; -1: none, which is white.
    ColorSpace color_space = ColorSpace::srgb;  ///< Encoding of 8- and 16-bit values.
    bool nearest = false;                       ///< Looks up the nearest pixel, not bilinearly.
};

/// A light that rays do not hit, at the origin of its node. All kinds except point and tube shine along -z of the node;
/// a tube lies along z, with its center at the origin. An image has its right at +x and its top at +y; it is mirrored
/// if the node's transform mirrors.
struct Light {
    std::string name;                   ///< Name for messages and scene files; may be empty.
    LightKind kind = LightKind::point;  ///< Kind, which decides which members apply.
    /// Directional and beam: irradiance at perpendicular incidence in lux. Tube: radiance in nits. Other kinds: radiant
    /// intensity in candela, multiplied by the image.
    Color intensity{1, 1, 1};
    /// Spot: half angles in radians of the cone of full intensity and of the whole cone.
    double inner_angle = 0, outer_angle = 0.7853981633974483;
    /// Directional: angular diameter in radians of the disk that the light comes from; 0: a delta light.
    double angle = 0;
    /// Spot: covers the square around the outer cone. Projector: the projected image, with square pixels. Goniometric:
    /// an equal-area square of all directions with -z in its middle, as EnvironmentKind::equal_area; or a file with the
    /// extension .ies (IES LM-63), in candela, with its nadir along -z and its 0 degree plane at +x.
    LightPicture picture{};
    SpotFalloff falloff = SpotFalloff::square;  ///< Spot: shape of the falloff.
    double fov = 0.7853981633974483;      ///< Projector: full angle of the image in radians, above 0 and below pi.
    FovAxis fov_axis = FovAxis::smaller;  ///< Projector: axis that fov is measured across.
    /// Beam: size of the emitting area along x and y of the node, in units of the node's space. If the node shears it,
    /// light leaves along the normal of the area.
    double width = 1, height = 1;
    bool round = false;  ///< Beam: the area is an ellipse; otherwise a rectangle.
    /// Tube: length of the cylinder without its ends, which do not emit, and its radius, in units of the node's space.
    /// Where the node stretches the cross-section to an ellipse, the radius is that of a circle of the same area.
    double length = 1, radius = 0.013;
    /// Projector: the image is the illuminance in lux on a screen perpendicular to the axis at a distance of 1 m, not
    /// the intensity.
    bool flat_field = false;
    /// Projector, goniometric: intensity is the flux of all directions together in lumens, whatever the brightness of
    /// the image. Tube: intensity is its flux in lumens, whatever its size.
    bool intensity_is_flux = false;
};

/// Kind of an environment.
enum class EnvironmentKind {
    none,          ///< Black.
    constant,      ///< The same radiance from all directions.
    gradient,      ///< Linear in the up component of the direction.
    image,         ///< Equirectangular image.
    studio,        ///< Three soft lights and a dim room, for a camera that looks along -z.
    sky,           ///< Clear sky, computed by a model of the atmosphere, over gray ground; with the sun if sun_disk.
    cube,          ///< Six images on the faces of a cube.
    equal_area,    ///< Square image in which equal solid angles have equal areas, as in pbrt-v4.
    hosek_wilkie,  ///< Clear sky by the formula of Hosek and Wilkie (2012), without sun and ground.
};

/// Light from outside the scene, and what rays see that leave it.
struct Environment {
    EnvironmentKind kind = EnvironmentKind::none;  ///< Kind, which decides which members apply.
    Color color{1, 1, 1};                          ///< constant: radiance in nits; other kinds: factor of the radiance.
    /// gradient: radiance, interpolated by (1 + y) / 2 of the direction's up component.
    Color bottom{1, 1, 1}, top{0.5f, 0.7f, 1};
    int image = -1;  ///< image, equal_area: index into SceneDescription::images; linear (8-bit files: sRGB).
    /// image, cube, equal_area: if above 0, the image is scaled so that it gives this illuminance in lux to a surface
    /// that faces its top (equal_area: its middle). `color` is applied afterwards.
    double illuminance = 0;
    /// cube: images towards +x, -x, +y, -y, +z, -z, oriented as in OpenGL; linear (8-bit files: sRGB). Colors are
    /// divided by alpha.
    std::array<int, 6> faces{-1, -1, -1, -1, -1, -1};
    /// Rotation. An equirectangular image has +x in its middle and +y at its top. An equal_area image has +z in its
    /// middle, +x at its right and +y at its bottom.
    Transform world_from_environment;
    /// sky, hosek_wilkie: direction to the sun, of any length above 0; +y is up. In a sky, a white surface that faces
    /// the sun above the atmosphere has a radiance of 1; a `color` of 42,400 gives nits.
    Vec3d to_sun{-0.4, 0.6, 0.7};
    bool sun_disk = true;  ///< sky: includes the sun itself.
    /// hosek_wilkie: turbidity from 1 (clear) to 10 (hazy), and albedo from 0 to 1 of the ground that lights the air.
    /// The radiance is in W/m^2/sr/nm, about 0.1.
    double turbidity = 3, ground_albedo = 0.3;
    bool sky_ground = true;  ///< sky: gray ground below the horizon, lit by sun and sky; otherwise black.
};

/// Projection of a camera.
enum class CameraKind {
    perspective,   ///< Perspective projection, optionally with a thin lens.
    orthographic,  ///< Parallel projection.
    spherical,     ///< All directions, equirectangular: `up` at the top, the direction of look_at in the middle.
    equal_area  ///< All directions, in a square where equal solid angles have equal areas, as in pbrt-v4: `up` in the
                ///< middle, the direction of look_at at the top, its opposite in all corners.
};

/// A camera in the space of its node. It looks from position to look_at.
struct Camera {
    std::string name;                           ///< Name by which it can be selected; may be empty.
    CameraKind kind = CameraKind::perspective;  ///< Projection of the camera.
    /// Position of the eye, a point in the middle of the image, and the up direction, which need not be perpendicular
    /// to the view direction.
    Vec3d position{0, 0, 0}, look_at{0, 0, -1}, up{0, 1, 0};
    /// perspective: full vertical angle of view in radians (40 degrees by default).
    double fov_y = 0.6981317007977318;
    double height = 2;  ///< orthographic: meters from the bottom to the top of the image.
    /// If above 0, fov_y and height are for an image of this aspect ratio (width / height). For an image of another
    /// aspect ratio, the angle or length across fov_axis is kept.
    double fov_aspect = 0;
    FovAxis fov_axis = FovAxis::height;  ///< Axis that is kept if fov_aspect is above 0.
    double aspect = 0;                   ///< Recommended width / height of the image; 0: any.
    /// perspective, orthographic: lens shift. Moves the contents to the right and up, in widths and heights of the
    /// image, without turning the camera.
    double shift_x = 0, shift_y = 0;
    double aperture = 0;        ///< perspective: diameter of the lens in meters; 0: a pinhole, everything is in focus.
    double focus_distance = 0;  ///< Distance of the focal plane along the view axis in meters; 0: that of look_at.
    double shutter_open = 0, shutter_close = 0;  ///< Shutter times in seconds; equal: no motion blur.
};

// ---------------------------------------------------------------------------------------------------- the scene

/// Transform of a node at one time.
struct NodeKey {
    double time = 0;             ///< Time of the key in seconds.
    Transform parent_from_node;  ///< Invertible transform; all keys of a node mirror, or none does.
};

/// An object with a transform that places shapes, a light, a camera and other nodes. A node that is the child of
/// several nodes is an instance in each of them. Nodes may be nested 256 deep, without cycles.
struct Node {
    std::string name;            ///< Name for messages; may be empty.
    Transform parent_from_node;  ///< Transform of a node that doesn't move; ignored if there is motion.
    /// Empty, or at least two keys in ascending order of time. Each is decomposed into stretch, rotation and
    /// translation (Higham 1986, polar decomposition). Between keys, stretch and translation change linearly, and the
    /// rotation turns at constant speed the shorter way. Before the first key and after the last one the node doesn't
    /// move. Cameras and directional lights don't move with a node: they are placed where it is when the shutter opens.
    std::vector<NodeKey> motion;
    std::vector<int> children;    ///< Nodes placed in the space of this node.
    std::vector<Shape> shapes;    ///< Geometry in the space of this node.
    int light = -1, camera = -1;  ///< Light and camera in the space of this node; -1: none.
    bool movable = false;         ///< The node and its children will move between images; see SceneEdit.
};

/// Range of color temperatures for white balance, in kelvin.
inline constexpr double min_white_kelvin = 1000, max_white_kelvin = 25000;

/// Render settings that a scene file may contain; empty members are not given. Scene::compile and RenderJob ignore
/// them: programs apply them, and options of the command line override them.
struct RenderHints {
    /// Size of the image in pixels, samples per pixel, and the settings of the same names in RenderSettings.
    std::optional<int> width, height, samples, max_depth, roulette_depth;
    std::optional<std::string> filter;    ///< Pixel filter: box, gaussian, blackman-harris or tent.
    std::optional<double> filter_radius;  ///< Radius of the filter in pixels.
    std::optional<bool> light_sampling;   ///< Next event estimation.
    std::optional<double> exposure;       ///< Exposure in stops.
    std::optional<double> white_balance;  ///< Color temperature in kelvin that is shown as white.
    std::optional<Color> background;      ///< Radiance that the camera sees instead of the environment.
    bool own_light = false;               ///< The file's light is intended as it is: compile_lit() adds none.
    std::optional<std::string> tonemap;   ///< Name of a tone curve, see tonemap_names.
    std::optional<std::string> build;     ///< Quality of the BVH: fast, standard, high or compact, see TreeBuild.
};

/// A complete scene.
struct SceneDescription {
    std::string file;                          ///< File that the scene was read from, for messages; may be empty.
    std::vector<std::filesystem::path> files;  ///< All files that were read, `file` first, images excluded.
    std::vector<ImageFile> images;             ///< Images of textures, lights and the environment.
    std::vector<Texture> textures;             ///< Textures, which materials and other textures refer to.
    std::vector<Material> materials;           ///< Materials, which shapes and mixtures refer to.
    std::vector<MeasuredBrdf> measured;        ///< Measured BRDFs of materials.
    std::vector<Mesh> meshes;                  ///< Triangle meshes, which shapes place.
    std::vector<Curves> curves;                ///< Sets of curves, which shapes place.
    std::vector<Points> points;                ///< Sets of spheres, which shapes place.
    std::vector<Light> lights;                 ///< Lights without a surface, which nodes place.
    std::vector<Camera> cameras;               ///< Cameras, which nodes place; the first one is the default.
    std::vector<Node> nodes;                   ///< Nodes, which place shapes, lights and cameras.
    std::vector<int> roots;                    ///< Indices of the nodes at the top of the scene.
    Environment environment;                   ///< Light from outside the scene.
    RenderHints hints;                         ///< Render settings of the file.
};

}  // namespace fathom
