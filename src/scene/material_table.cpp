#include "scene/material_table.h"

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
    {principled, "principled", "metallic-roughness of glTF 2.0"},
    {unlit, "unlit", "shows its colour whatever the light, and lights nothing"},
    {none, "none", "black, for lamps"},
};
static_assert(std::size(kinds) == material_kind_count);

constexpr std::uint32_t all = (1u << material_kind_count) - 1;
constexpr std::uint32_t scattering = all & ~kind_bits(none, unlit);

constexpr const char* alpha_modes[] = {"opaque", "mask", "blend"};
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
    {"thin", kind_bits(glass), &Material::thin, "a sheet without thickness, which light passes straight on"},
    {"roughness", scattering & ~kind_bits(fuzz_metal), &Material::roughness, "0 smooth to 1 rough", 0, 1},
    {"metallic", kind_bits(principled), &Material::metallic, "0 dielectric to 1 metal", 0, 1},
    {"fuzz", kind_bits(fuzz_metal), &Material::fuzz, "0 mirror to 1", 0, 1},
    {"ior", kind_bits(glass, principled), &Material::ior, "index of refraction", 0.01, 100},
    {"attenuation_color",
     kind_bits(glass),
     &Material::attenuation_color,
     "what is left of white light after attenuation_distance",
     0,
     1,
     1,
     {},
     "must not be above 1: glass takes light away"},
    {"attenuation_distance", kind_bits(glass), &Material::attenuation_distance, "metres; 0: clear", 0},
    {"priority", kind_bits(glass), &Material::priority,
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
