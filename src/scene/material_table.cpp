#include "scene/material_table.h"

#include <numbers>

namespace fathom {

namespace {

using P = Parameter<Material>;
using enum MaterialKind;

constexpr KindName<MaterialKind> kinds[] = {
    {diffuse, "diffuse", "Lambertian; energy-preserving Oren-Nayar where roughness > 0"},
    {metal, "metal", "GGX conductor; color is the reflectance at normal incidence"},
    {fuzz_metal, "fuzz_metal",
     "the report's metal: mirror direction plus fuzz times a random point of the unit sphere"},
    {glass, "glass", "dielectric"},
    {principled, "principled", "layers: sheen over coat over metal or dielectric; metallic-roughness of glTF 2.0"},
    {unlit, "unlit", "shows its colour whatever the light, and lights nothing"},
    {none, "none", "black, for lamps"},
};
static_assert(std::size(kinds) == material_kind_count);

constexpr std::uint32_t all = (1u << material_kind_count) - 1;
constexpr std::uint32_t scattering = all & ~kind_bits(none, unlit);

constexpr const char* alpha_modes[] = {"opaque", "mask", "blend"};
constexpr const char* mean_cosine = "mean cosine of scattering: 0 alike to all sides, above 0 on, below back";
constexpr const char* more_light = "a reflectance above 1 would make light out of nothing";

const P parameters[] = {
    {"color", kind_bits(unlit), &Material::base_color, "shown whatever the light", 0},
    {"color", scattering & ~kind_bits(glass), &Material::base_color, "reflectance", 0, 1, 1, {}, more_light},
    {"color",
     kind_bits(glass),
     &Material::transmission_color,
     "what is left of light that went in and out, or through a thin sheet",
     0,
     1,
     1,
     {},
     more_light},
    {"transmission", kind_bits(principled), &Material::transmission,
     "share of what the dielectric's boundary lets in that is refracted", 0, 1},
    {"transmission_color",
     kind_bits(principled),
     &Material::transmission_color,
     "what is left of light that was refracted in and out, or through a thin sheet",
     0,
     1,
     1,
     {},
     more_light},
    {"dispersion", kind_bits(principled), &Material::dispersion, "20 / Abbe's number: glass has 0.3 to 0.9", 0, 40},
    {"diffuse_transmission", kind_bits(principled), &Material::diffuse_transmission,
     "share of what is diffuse that leaves on the other side", 0, 1},
    {"diffuse_transmission_color",
     kind_bits(principled),
     &Material::diffuse_transmission_color,
     "its colour",
     0,
     1,
     1,
     {},
     more_light},
    {"subsurface", kind_bits(principled), &Material::subsurface,
     "share of what is diffuse that goes into the solid, is scattered there, and comes out again", 0, 1},
    {"subsurface_color",
     kind_bits(principled),
     &Material::subsurface_color,
     "what a thick solid gives back of light from everywhere",
     0,
     1,
     1,
     {},
     more_light},
    {"subsurface_radius", kind_bits(principled), &Material::subsurface_radius,
     "metres: mean free path of the channels whose scale is 1", 0},
    {"subsurface_radius_scale", kind_bits(principled), &Material::subsurface_radius_scale,
     "times subsurface_radius: the mean free path of each channel", 0},
    {"subsurface_scatter_anisotropy", kind_bits(principled), &Material::subsurface_scatter_anisotropy, mean_cosine,
     -0.99, 0.99},
    {"diffuse_roughness", kind_bits(principled), &Material::diffuse_roughness,
     "energy-preserving Oren-Nayar where above 0", 0, 1},
    {"specular", kind_bits(principled), &Material::specular, "strength of the dielectric's reflection", 0, 1},
    {"specular_color", kind_bits(principled), &Material::specular_color,
     "tint of the dielectric's reflection at normal incidence; what is above 1 counts up to a reflectance of 1", 0},
    {"edge_color",
     kind_bits(principled),
     &Material::edge_color,
     "metal: tint of Schlick's reflectance at 82 degrees",
     0,
     1,
     1,
     {},
     more_light},
    {"anisotropy", kind_bits(principled), &Material::anisotropy, "how far facets are drawn out along the tangent", 0,
     1},
    {"anisotropy_rotation", kind_bits(principled), &Material::anisotropy_rotation,
     "degrees, from the tangent towards the bitangent", -P::unbounded, P::unbounded, std::numbers::pi / 180},
    {"anisotropy_map", kind_bits(principled), TextureReference<Material>{&Material::anisotropy_texture},
     "direction in red and green, of which 0.5 is 0"},
    {"energy_compensation", kind_bits(principled), &Material::energy_compensation,
     "whether what facets scatter more than once is made up for"},
    {"coat", kind_bits(principled), &Material::coat, "strength of a clear layer over all but the sheen", 0, 1},
    {"coat_color",
     kind_bits(principled),
     &Material::coat_color,
     "what the coat leaves of light that passes it",
     0,
     1,
     1,
     {},
     more_light},
    {"coat_roughness", kind_bits(principled), &Material::coat_roughness, "0 smooth to 1 rough", 0, 1},
    {"coat_ior", kind_bits(principled), &Material::coat_ior, "index of refraction", 1, 3},
    {"coat_darkening", kind_bits(principled), &Material::coat_darkening,
     "how much of the light between coat and base is counted, which saturates and darkens", 0, 1},
    {"coat_normal_map", kind_bits(principled), TextureReference<Material>{&Material::coat_normal_texture},
     "tangent-space normals of the coat, which normal_map does not bend"},
    {"coat_normal_scale", kind_bits(principled), &Material::coat_normal_scale,
     "multiplies x and y of the coat's normal map"},
    {"sheen_color",
     kind_bits(principled),
     &Material::sheen_color,
     "reflectance of fibres that stand on the surface",
     0,
     1,
     1,
     {},
     more_light},
    {"sheen_roughness", kind_bits(principled), &Material::sheen_roughness, "0 upright fibres to 1", 0, 1},
    {"thin_film", kind_bits(principled), &Material::thin_film, "share of the surface that has a thin film", 0, 1},
    {"thin_film_thickness", kind_bits(principled), &Material::thin_film_thickness, "nanometres", 0, 1e5},
    {"thin_film_ior", kind_bits(principled), &Material::thin_film_ior, "index of refraction", 1, 3},
    {"thin", kind_bits(glass, principled), &Material::thin,
     "a sheet without thickness, which light passes straight on"},
    {"roughness", scattering & ~kind_bits(fuzz_metal), &Material::roughness, "0 smooth to 1 rough", 0, 1},
    {"metallic", kind_bits(principled), &Material::metallic, "0 dielectric to 1 metal", 0, 1},
    {"fuzz", kind_bits(fuzz_metal), &Material::fuzz, "0 mirror to 1", 0, 1},
    {"ior", kind_bits(glass), &Material::ior, "index of refraction", 0.01, 100},
    {"ior", kind_bits(principled), &Material::ior, "index of refraction; 10000 stands for a mirror", 0.01, 10000},
    {"attenuation_color",
     kind_bits(glass, principled),
     &Material::attenuation_color,
     "what is left of white light after attenuation_distance",
     0,
     1,
     1,
     {},
     "must not be above 1: glass takes light away"},
    {"attenuation_distance", kind_bits(glass, principled), &Material::attenuation_distance, "metres; 0: clear", 0},
    {"transmission_scatter", kind_bits(glass, principled), &Material::transmission_scatter,
     "coefficient of scattering times attenuation_distance; what the ways lose beyond it is absorbed", 0},
    {"transmission_scatter_anisotropy", kind_bits(glass, principled), &Material::transmission_scatter_anisotropy,
     mean_cosine, -0.99, 0.99},
    {"priority", kind_bits(glass, principled), &Material::priority,
     "where solids overlap, the one of greatest priority is there; of equal ones the one that was entered last", -1000,
     1000},
    {"emission", all & ~kind_bits(unlit), &Material::emission, "light that the surface gives off, in emission_unit", 0},
    {"emission_two_sided", all & ~kind_bits(unlit), &Material::emission_two_sided,
     "else only on the side of the geometric normal"},
    {"normal_map", scattering, TextureReference<Material>{&Material::normal_texture},
     "tangent-space normals, green up"},
    {"normal_scale", scattering, &Material::normal_scale, "multiplies x and y of the normal map"},
    {"alpha", all, &Material::alpha, "opacity; giving it makes alpha_mode 'blend'", 0, 1},
    {.key = "alpha_mode",
     .kinds = all,
     .member = &Material::alpha_mode,
     .meaning = "what alpha does",
     .words = alpha_modes,
     .default_by_use = true},
    {"alpha_cutoff", all, &Material::alpha_cutoff, "mask: visible from this alpha on"},
    {"single_sided", all, &Material::single_sided, "cameras look through it from behind; to other light it is there"},
    {"use_vertex_color", all, &Material::use_vertex_color, "multiply colour and alpha with the mesh's vertex colours"},
};

}  // namespace

std::span<const KindName<MaterialKind>> material_kinds()
{
    return kinds;
}
std::span<const Parameter<Material>> material_parameters()
{
    return parameters;
}

}  // namespace fathom
