// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Records of the kinds of lights, which LightRecord::own holds, and the list of kinds. Lengths and positions are in
/// render space, or in the space that LightRecord::motion names; directions are unit vectors.
///
/// Each record has the functions by which the light tree bounds the light, in the .cpp file of its kind:
///     LightBall ball(const Shutter&) const      bounding ball of its points
///     void set_emission(LightBounds&, const LightRecord&, double power) const
/// A kind of light without a surface is also compiled from the description:
///     static bool is_for(const Light&)          whether the light of the description is of this kind
///     static std::optional<double> compile(const PlacedLight&, LightRecord&)
///                                               sets the record; returns the power; nothing: it emits nothing
///     void set_axes(const Light&, const Transform& render_from_node)
///                                               sets everything that depends on orientation and scale of the node
///     static double node_radius(const Light&)   radius of its bounding ball in the space of its node
///     void add_places(std::vector<Vec3f>&) const
///                                               adds points whose convex hull contains the light
#include <optional>

#include "fathom/description.h"
#include "lights/records.h"

namespace fathom {

/// Kind of a light. Each has a record below and a class in kinds/ that samples it.
enum class LightRecordKind : std::uint32_t {
    rectangle,
    parallelogram,
    triangle,
    sphere,
    disk,
    point,
    spot,
    directional,
    environment,
    curve,     ///< a curve segment, whose geometry is in the tables of curves
    pictured,  ///< a spot, projector or goniometric light, whose intensity is multiplied by an image
    beam,      ///< parallel light from a flat area
    tube,      ///< the side of a cylinder, without ends
};

struct LightBall;
struct LightBounds;
struct PlacedLight;
struct Shutter;

/// Beginning of the records of flat lights.
struct FlatLightRecord {
    float normal[3] = {};  ///< unit normal, on the emitting side if the light is one-sided
    float area = 0;

    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

struct RectangleLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::rectangle;
    FlatLightRecord flat;
    float corner[3] = {};
    float u[3] = {}, v[3] = {};  ///< unit vectors along the edges
    float length_u = 0, length_v = 0;
    float center[3] = {};
    float diagonal = 0;  ///< length of the diagonal

    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

struct ParallelogramLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::parallelogram;
    FlatLightRecord flat;
    float corner[3] = {};
    float edge_u[3] = {}, edge_v[3] = {};  ///< edges from the corner

    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

struct TriangleLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::triangle;
    FlatLightRecord flat;
    float corner[3] = {};
    float edge_u[3] = {}, edge_v[3] = {};  ///< edges from the corner

    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

struct DiskLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::disk;
    FlatLightRecord flat;
    float center[3] = {};
    float radius = 0;

    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

struct SphereLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::sphere;
    float center[3] = {};    ///< center at time 0
    float velocity[3] = {};  ///< displacement per unit of shutter time
    float radius = 0;        ///< negative if the sphere emits inwards
    float area = 0;

    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

/// A curve segment; LightRecord::primitive and instance refer to its geometry in the tables of curves.
struct CurveLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::curve;

    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

/// A point light; LightRecord::radiance holds the intensity.
struct PointLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::point;
    float position[3] = {};

    static bool is_for(const Light&);
    static std::optional<double> compile(const PlacedLight&, LightRecord&);
    void set_axes(const Light&, const Transform&) {}
    static double node_radius(const Light&) { return 0; }
    void add_places(std::vector<Vec3f>&) const;
    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

/// The cone of a spot, which is also the beginning of PicturedLightRecord. LightRecord::radiance holds the intensity.
struct SpotLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::spot;
    float position[3] = {};
    float axis[3] = {};           ///< direction in which it shines
    float outer = 0;              ///< 1 - cos of the half angle of the outer cone
    float falloff = 0;            ///< width of the falloff inside the outer cone, in units of 1 - cos
    float is_smooth = 0;          ///< 1 for smoothstep falloff, 0 for squared
    float linear_from = 0;        ///< linear falloff: half angle of the outer cone in radians; 0 for other falloffs
    float linear_per_radian = 0;  ///< linear falloff: 1 / (outer angle - inner angle)

    static bool is_for(const Light&);
    static std::optional<double> compile(const PlacedLight&, LightRecord&);
    void set_axes(const Light&, const Transform& render_from_node);
    static double node_radius(const Light&) { return 0; }
    void add_places(std::vector<Vec3f>&) const;
    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

/// A spot, projector or goniometric light whose intensity is multiplied by an image.
struct PicturedLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::pictured;
    SpotLightRecord spot;       ///< cone that contains or cuts the image; outer >= 2: all directions
    float right[3] = {};        ///< direction of the image's right
    float top[3] = {};          ///< direction of the image's top
    std::uint32_t picture = 0;  ///< index into LightTables::light_pictures

    static bool is_for(const Light&);
    static std::optional<double> compile(const PlacedLight&, LightRecord&);
    void set_axes(const Light&, const Transform& render_from_node);
    static double node_radius(const Light&) { return 0; }
    void add_places(std::vector<Vec3f>&) const;
    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

/// A directional light; LightRecord::radiance holds the radiance of the disk, or the irradiance if one_minus_cos is 0.
struct DirectionalLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::directional;
    float axis[3] = {};       ///< direction in which it shines
    float one_minus_cos = 0;  ///< 1 - cos of the half angle of the disk of directions; 0: a delta light

    static bool is_for(const Light&);
    static std::optional<double> compile(const PlacedLight&, LightRecord&);
    void set_axes(const Light&, const Transform& render_from_node);
    static double node_radius(const Light&) { return 0; }
    void add_places(std::vector<Vec3f>&) const {}
    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

/// A beam; LightRecord::radiance holds the irradiance at perpendicular incidence.
struct BeamLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::beam;
    float center[3] = {};
    float half_u[3] = {},
          half_v[3] =
              {};        ///< vectors from the center to the middles of the sides, or conjugate half-axes of an ellipse
    float axis[3] = {};  ///< direction in which it shines: along the normal of the area
    float is_round = 0;  ///< 1 for an ellipse, 0 for a parallelogram
    float area = 0;

    static bool is_for(const Light&);
    static std::optional<double> compile(const PlacedLight&, LightRecord&);
    void set_axes(const Light&, const Transform& render_from_node);
    static double node_radius(const Light&);
    void add_places(std::vector<Vec3f>&) const;
    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

/// A cylinder without ends that emits outwards; LightRecord::radiance holds its radiance.
struct TubeLightRecord {
    static constexpr LightRecordKind kind = LightRecordKind::tube;
    float center[3] = {};
    float half_axis[3] = {};  ///< vector from the center to an end
    float radius = 0;

    static bool is_for(const Light&);
    static std::optional<double> compile(const PlacedLight&, LightRecord&);
    void set_axes(const Light&, const Transform& render_from_node);
    static double node_radius(const Light&);
    void add_places(std::vector<Vec3f>&) const;
    LightBall ball(const Shutter&) const;
    void set_emission(LightBounds& to, const LightRecord& light, double power) const;
};

/// A list of the record types of light kinds.
template <class... Own>
struct LightRecordList {
    /// Calls f.template operator()<Own>() for each record.
    template <class F>
    static void for_each(F&& f)
    {
        (f.template operator()<Own>(), ...);
    }
};

/// Records of all kinds except environments, which have a table of their own.
using LightRecords =
    LightRecordList<RectangleLightRecord, ParallelogramLightRecord, TriangleLightRecord, DiskLightRecord,
                    SphereLightRecord, CurveLightRecord, PointLightRecord, SpotLightRecord, PicturedLightRecord,
                    DirectionalLightRecord, BeamLightRecord, TubeLightRecord>;

/// Calls f(record) with the record of the light's kind.
template <class F>
void visit_light(const LightRecord& light, F&& f)
{
    LightRecords::for_each([&]<class Own>() {
        if (light.is<Own>()) f(light.get<Own>());
    });
}

}  // namespace fathom
