// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "compile/compiler.h"
#include "geometry/compile/instancing.h"
#include "geometry/compile/poses.h"
#include "geometry/shapes/curve.h"
#include "lights/compile/kind.h"
#include "lights/compile/motion_bounds.h"
#include "lights/sky/sky.h"
#include "lights/tree/build_tree.h"
#include "materials/compile/inputs.h"
#include "math/luminance.h"

namespace fathom {

namespace {

class LightCompiler {
public:
    explicit LightCompiler(Compiler& c) : c_(c), t_(c.tables), scene_radius_(c.space.radius)
    {
        t_.lights.clear();
        t_.light_cdf.clear();
        t_.black_lights.clear();
        t_.light_pictures.clear();
        t_.light_places.clear();
        t_.described_lights.clear();
        const Vec3d& center = c.space.ball_center;
        t_.ball_center = {float(center.x), float(center.y), float(center.z)};
        t_.ball_radius = float(c.space.ball_radius);
    }

    void run(const FlattenedScene& all)
    {
        const std::vector<FlattenedLight>& lights = all.lights;
        motions_ = &all.motions;
        for (ShapeRecord& shape : t_.shapes) add_emissive(shape);
        for (std::uint32_t i = 0; i < t_.instances.size(); ++i) add_emissive_instance(i);
        for (const FlattenedLight& light : lights)
            if (light.light->kind != LightKind::directional) add_light(light);
        t_.positioned_lights = std::uint32_t(t_.lights.size());
        for (const FlattenedLight& light : lights)
            if (light.light->kind == LightKind::directional) add_light(light);
        add_environment();
        add_sun();
        make_distribution();
        build_light_tree(t_, powers_, double(t_.shutter_open), double(t_.shutter_close), extents_);
    }

private:
    /// Whether the shape's surfaces are lights that are sampled.
    bool is_sampled(const ShapeRecord& shape) const
    {
        const MaterialRecord& material = t_.materials[shape.material];
        return material.features.has(MaterialFeature::emits) && !material.features.has(MaterialFeature::unlit);
    }

    /// Adds the lights of a shape outside instances.
    void add_emissive(ShapeRecord& shape)
    {
        shape.light_base = no_index;
        const std::uint32_t first = shape.first_primitive;
        if ((shape.flags & ShapeRecord::only_instanced) || !is_sampled(shape)) return;
        if (first < t_.primitive_count() && &t_.shapes[t_.shape_of_primitive[first]] != &shape) return;
        add_primitives(shape, first, no_index, Transform(), nullptr);
    }

    /// Adds the lights of an instance. The instance has a shape of its own, whose light_base is their first index.
    void add_emissive_instance(std::uint32_t index)
    {
        const InstanceRecord& instance = t_.instances[index];
        ShapeRecord& shape = t_.shapes[instance.shape];
        if (!is_sampled(shape)) return;
        const bool is_round = shape.first_primitive >= t_.first_sphere();
        const std::uint32_t first = t_.shapes[instance.mesh_shape].first_primitive;
        if (instance.pose_count() > 0) {
            const LightMotionBounds path(std::span(t_.poses).subspan(instance.first_pose(), instance.pose_count()));
            if (!is_round || path.keeps_shape()) add_primitives(shape, first, index, Transform(), &path);
            return;
        }
        Transform object_from_render;
        for (std::size_t i = 0; i < 12; ++i)
            object_from_render.m[i / 4][i % 4] = double(instance.object_from_render[i]);
        const Transform render_from_object = object_from_render.inverse();
        double factor;
        if (is_round && !is_similarity(render_from_object, factor)) return;
        add_primitives(shape, first, index, render_from_object, nullptr);
    }

    /// Adds a light for each primitive. path: poses of the instance, if it moves; to_render: transform of a static
    /// instance.
    void add_primitives(ShapeRecord& shape, std::uint32_t first, std::uint32_t instance, const Transform& to_render,
                        const LightMotionBounds* path)
    {
        const MaterialRecord& material = t_.materials[shape.material];
        const bool flipped = to_render.determinant() < 0 || (shape.flags & ShapeRecord::flipped);
        const bool is_masked =
            (shape.flags & ShapeRecord::alpha_tested) && !material.features.has(MaterialFeature::invisible_light);
        const bool varied = material.emission_texture != no_index || is_masked;
        shape.light_base = std::uint32_t(t_.lights.size());
        const std::uint32_t same = first < t_.primitive_count() ? t_.shape_of_primitive[first] : no_index;
        for (std::uint32_t p = first; p < t_.primitive_count() && t_.shape_of_primitive[p] == same; ++p) {
            LightRecord light = primitive_light(p, flipped, to_render);
            light.primitive = p;
            light.instance = instance;
            light.material = varied ? shape.material : no_index;
            if (material.features.has(MaterialFeature::two_sided_emission)) light.flags |= LightRecord::two_sided;
            if (material.features.has(MaterialFeature::invisible_light)) light.flags |= LightRecord::not_hit_by_rays;
            std::copy(material.emission.begin(), material.emission.end(), light.radiance);
            // Power of a light. Curves emit from their outside only.
            const bool is_curve = light.is<CurveLightRecord>();
            const bool moves = path || shape.moving_vertices > 0;
            const double area = is_curve ? add_curve_extent(p, shape, to_render, path)
                                : moves  ? set_motion(light, {p, shape.moving_vertices, flipped, to_render, path})
                                         : area_of(light);
            const int sides = light.flags & LightRecord::two_sided && !is_curve ? 2 : 1;
            const double factor = texture_factor(material, shape, p);
            add(light, luminance(light.radiance) * area * std::numbers::pi * sides * factor, factor == 0);
        }
    }

    /// Factor of the power of a primitive by its emission texture: its mean luminance on triangles, 0 on black ones,
    /// and 1 where it is unknown.
    double texture_factor(const MaterialRecord& material, const ShapeRecord& shape, std::uint32_t primitive)
    {
        if (material.emission_texture == no_index || primitive >= t_.first_quad()) return 1;
        const TextureRecord& texture = t_.textures[material.emission_texture];
        const auto known = c_.textured_emissions.try_emplace(material.emission_texture, t_, texture).first;
        return known->second.over(texture, t_, shape, primitive).value_or(1);
    }

    /// End points of a curve segment's pieces at one of its motion keys.
    std::vector<CurvePoint<double>> piece_ends(std::uint32_t segment, const ShapeRecord& shape, std::size_t key) const
    {
        const CurveRecord& curve = t_.curves[segment];
        const bool linear = shape.flags & ShapeRecord::linear_curves;
        CurvePoint<double> points[4];
        for (std::size_t i = 0; i < (linear ? 2 : 4); ++i) {
            const Vec4f& v = t_.curve_points[curve.first_point + key * shape.moving_vertices + i];
            points[i] = {double(v.x), double(v.y), double(v.z), double(v.w)};
        }
        std::vector<CurvePoint<double>> ends;
        for (std::uint32_t k = 0; k <= curve.pieces; ++k) {
            const double u = double(k) / curve.pieces;
            ends.push_back(linear ? between(points[0], points[1], u) : bezier(points, u));
        }
        return ends;
    }

    /// Records the bounds of a curve segment; returns its mean area as a round curve. to_render must be a similarity.
    double add_curve_extent(std::uint32_t p, const ShapeRecord& shape, const Transform& to_render,
                            const LightMotionBounds* path)
    {
        const auto place = [](const CurvePoint<double>& q) { return Vec3d{q.x, q.y, q.z}; };
        // Motion is linear between keys: a ball that contains the curve at both keys contains it in between.
        std::vector<std::vector<CurvePoint<double>>> keys;
        const std::size_t times = shape.moving_vertices > 0 ? t_.vertex_times.size() : 1;
        keys.reserve(times);
        for (std::size_t k = 0; k < times; ++k) keys.push_back(piece_ends(p - t_.first_curve(), shape, k));
        Vec3d center;
        for (const auto& ends : keys)
            center = center + (place(ends.front()) + place(ends.back())) * (0.5 / double(times));
        double radius = 0, area = 0;
        for (const auto& ends : keys)
            for (std::size_t k = 0; k < ends.size(); ++k) {
                radius = std::max(radius, length(place(ends[k]) - center) + ends[k].r);
                if (k == 0) continue;
                const double way = length(place(ends[k]) - place(ends[k - 1]));
                area += std::numbers::pi * (ends[k - 1].r + ends[k].r) * way / double(times);
            }
        const double scale = scale_of(to_render);
        LightExtent extent{std::uint32_t(t_.lights.size()), to_render.point(center), radius * scale, {}};
        if (path) path->set_bounding_ball(center, radius, extent);
        extents_.push_back(extent);
        return area * (path ? path->mean_area_factor() : scale * scale);
    }

    struct Motion {
        std::uint32_t primitive;
        std::uint32_t vertices;  ///< number of vertices of the mesh, if they move
        bool flipped;
        const Transform& to_render;
        const LightMotionBounds* path;
    };
    /// Sets the motion of a primitive's light and records its bounds. Returns its mean area.
    double set_motion(LightRecord& light, const Motion& m)
    {
        if (light.instance != no_index) light.motion |= LightRecord::placed;
        // The stretch of an instance may shear the rectangle.
        if (m.path && !m.path->keeps_shape() && light.is<RectangleLightRecord>()) to_parallelogram(light);
        LightExtent extent{std::uint32_t(t_.lights.size()), {}, 0, {}};
        LightBall ball = own_ball(light);
        double area = area_of(light);
        const bool is_flat = !light.is<SphereLightRecord>();
        NormalCone normals{is_flat ? to_vector(light.get<FlatLightRecord>().normal) : Vec3d{}, 1};
        if (m.vertices > 0) {
            light.motion |= LightRecord::vertices_move;
            // Normals of instanced lights are transformed by the instance's map, which already handles flipped normals.
            if (m.flipped && light.instance == no_index) light.motion |= LightRecord::flipped;
            ball = bound_moving_triangle(m, normals, area);
        }
        extent.center = ball.center, extent.radius = ball.radius;
        if (m.path) {
            m.path->set_bounding_ball(ball.center, ball.radius, extent);
            normals = m.vertices > 0 ? NormalCone() : m.path->cone(normals.axis);
            area *= m.path->mean_area_factor();
        }
        extent.axis = normals.axis, extent.cos_turned = normals.cosine;
        extents_.push_back(extent);
        return area;
    }

    /// Area of a primitive's light other than a curve.
    static double area_of(const LightRecord& light)
    {
        return double(light.is<SphereLightRecord>() ? light.get<SphereLightRecord>().area
                                                    : light.get<FlatLightRecord>().area);
    }
    /// Bounding ball of a light of a moving instance in the instance's space, including a sphere's own motion.
    LightBall own_ball(const LightRecord& light) const
    {
        const Shutter shutter{double(t_.shutter_open), double(t_.shutter_close)};
        LightBall ball;
        visit_light(light, [&](const auto& own) { ball = own.ball(shutter); });
        if (!light.is<TriangleLightRecord>()) return ball;
        // The ball is centered at the centroid, as in bound_moving_triangle() for triangles whose vertices move.
        const auto triangle = light.get<TriangleLightRecord>();
        const Vec3d p = to_vector(triangle.corner), u = to_vector(triangle.edge_u), v = to_vector(triangle.edge_v);
        const Vec3d c = p + (u + v) * (1.0 / 3);
        return {c, std::max({length(p - c), length(p + u - c), length(p + v - c)})};
    }
    static void to_parallelogram(LightRecord& light)
    {
        const auto r = light.get<RectangleLightRecord>();
        ParallelogramLightRecord p{.flat = r.flat};
        for (int i = 0; i < 3; ++i) {
            p.corner[i] = r.corner[i];
            p.edge_u[i] = r.u[i] * r.length_u, p.edge_v[i] = r.v[i] * r.length_v;
        }
        light.set(p);
    }

    /// Bounds of a triangle over all keys. Between keys its corners move linearly, and its normal is a weighted mean of
    /// three cross products of edges.
    LightBall bound_moving_triangle(const Motion& m, NormalCone& normals, double& mean_area) const
    {
        struct Corners {
            Vec3d a, u, v;
        };
        const std::uint32_t* vertex = &t_.triangles[3 * std::size_t(m.primitive)];
        std::vector<Corners> keys;
        for (std::size_t k = 0; k < t_.vertex_times.size(); ++k) {
            const auto at = [&](int i) {
                return m.to_render.point(to_double(t_.positions[vertex[i] + k * m.vertices]));
            };
            const Vec3d a = at(0);
            keys.push_back({a, at(1) - a, at(2) - a});
        }
        Vec3d center;
        for (const Corners& c : keys) center = center + (c.a + (c.u + c.v) * (1.0 / 3)) * (1 / double(keys.size()));
        double radius = 0;
        mean_area = 0;
        const double side = m.flipped ? -1 : 1;
        std::vector<Vec3d> directions;
        for (std::size_t k = 0; k < keys.size(); ++k) {
            const Corners& c = keys[k];
            for (const Vec3d& p : {c.a, c.a + c.u, c.a + c.v}) radius = std::max(radius, length(p - center));
            mean_area += length(cross(c.u, c.v)) / 2 / double(keys.size());
            directions.push_back(cross(c.u, c.v) * side);
            if (k + 1 < keys.size())
                directions.push_back((cross(c.u, keys[k + 1].v) + cross(keys[k + 1].u, c.v)) * side);
        }
        normals = cone_around(directions);
        return {center, radius};
    }

    /// Makes the record of a primitive's light. flipped: the normal is opposite to the edges' cross product, after
    /// transformation. to_render: must be a similarity for round primitives.
    LightRecord primitive_light(std::uint32_t p, bool flipped, const Transform& to_render) const
    {
        LightRecord light;
        const double side = flipped ? -1 : 1;
        if (p < t_.first_quad())
            light.set(triangle_light(p, side, to_render));
        else if (p < t_.first_sphere())
            set_quad(light, t_.quads[p - t_.first_quad()], side, to_render);
        else if (p < t_.first_disk())
            light.set(sphere_light(t_.spheres[p - t_.first_sphere()], to_render));
        else if (p < t_.first_curve())
            light.set(disk_light(t_.disks[p - t_.first_disk()], to_render));
        else if (p < t_.first_point())
            light.set(CurveLightRecord());
        else {
            const Vec4f& point = t_.points[p - t_.first_point()];
            light.set(
                sphere_light({.center = {point.x, point.y, point.z}, .motion = {}, .radius = point.w}, to_render));
        }
        return light;
    }

    TriangleLightRecord triangle_light(std::uint32_t p, double side, const Transform& to_render) const
    {
        const std::uint32_t* v = &t_.triangles[3 * std::size_t(p)];
        const auto vertex = [&](int k) { return to_render.point(to_double(t_.positions[v[k]])); };
        const Vec3d a = vertex(0), u = vertex(1) - a, w = vertex(2) - a;
        const Vec3d n = cross(u, w);
        TriangleLightRecord light;
        store(light.corner, a), store(light.edge_u, u), store(light.edge_v, w);
        store(light.flat.normal, normalize(n) * side);
        light.flat.area = float(length(n) / 2);
        return light;
    }

    static void set_quad(LightRecord& light, const QuadRecord& q, double side, const Transform& to_render)
    {
        const Vec3d corner = to_render.point(to_double(q.corner));
        const Vec3d u = to_render.vector(to_double(q.edge_u)), v = to_render.vector(to_double(q.edge_v)),
                    n = cross(u, v);
        FlatLightRecord flat;
        store(flat.normal, normalize(n) * side);
        flat.area = float(length(n));
        if (std::abs(dot(u, v)) > 1e-6 * length(u) * length(v)) {
            ParallelogramLightRecord p{.flat = flat};
            store(p.corner, corner), store(p.edge_u, u), store(p.edge_v, v);
            return light.set(p);
        }
        RectangleLightRecord r{.flat = flat};
        store(r.corner, corner);
        store(r.u, normalize(u)), store(r.v, normalize(v));
        r.length_u = float(length(u)), r.length_v = float(length(v));
        store(r.center, corner + (u + v) * 0.5);
        r.diagonal = float(length(u + v));
        light.set(r);
    }

    static SphereLightRecord sphere_light(const SphereRecord& s, const Transform& to_render)
    {
        const double radius = double(s.radius) * scale_of(to_render);
        SphereLightRecord light;
        store(light.center, to_render.point(to_double(s.center)));
        store(light.velocity, to_render.vector(to_double(s.motion)));
        light.radius = float(radius);
        light.area = float(4 * std::numbers::pi * radius * radius);
        return light;
    }

    static DiskLightRecord disk_light(const DiskRecord& d, const Transform& to_render)
    {
        const double radius = double(d.radius) * scale_of(to_render);
        DiskLightRecord light;
        store(light.center, to_render.point(to_double(d.center)));
        store(light.flat.normal, normalize(to_render.vector(to_double(d.normal))));
        light.radius = float(radius);
        light.flat.area = float(std::numbers::pi * radius * radius);
        return light;
    }

    /// Scale factor of a similarity.
    static double scale_of(const Transform& t) { return length(t.vector({1, 0, 0})); }

    void add_light(const FlattenedLight& occurrence)
    {
        LightRecords::for_each([&]<class Own>() {
            if constexpr (requires { Own::is_for; })
                if (Own::is_for(*occurrence.light)) add_light_as<Own>(occurrence);
        });
    }

    template <class Own>
    void add_light_as(const FlattenedLight& occurrence)
    {
        const Light& l = *occurrence.light;
        LightRecord light;
        light.flags = LightRecord::two_sided;
        const Rgb intensity = spectrum(l.intensity);
        std::copy(intensity.begin(), intensity.end(), light.radiance);
        const std::function<PicturedIntensity()> add_picture = [&] { return add_light_picture(c_, l); };
        const PlacedLight placed{l, occurrence.render_from_node, c_.space.scale, scene_radius_, add_picture};
        const std::optional<double> power = Own::compile(placed, light);
        if (!power) return;
        if (occurrence.motion >= 0) {
            const std::vector<PoseRecord> poses = pose_tables((*motions_)[std::size_t(occurrence.motion)]);
            Own own = light.get<Own>();
            own.set_axes(l, Transform());
            light.set(own);
            set_poses(light, poses);
            add_extent(poses, Own::node_radius(l));
        } else
            light.get<Own>().add_places(t_.light_places);
        add(light, *power);
        t_.described_lights.push_back(index_of(l));
    }
    /// Index of a light in the description; no_index for the sun, which is part of the environment.
    std::uint32_t index_of(const Light& light) const
    {
        const Light* const first = c_.scene.lights.data();
        const std::less<> before;
        const bool is_described = !before(&light, first) && before(&light, first + c_.scene.lights.size());
        return is_described ? std::uint32_t(&light - first) : no_index;
    }

    void set_poses(LightRecord& light, const std::vector<PoseRecord>& poses)
    {
        light.motion = LightRecord::has_poses;
        light.instance = append_poses(t_, poses, c_.scene.file);
        t_.moving = true;
    }

    /// Records the bounds of the next light, which moves with the poses. radius: radius of its bounding ball, in node
    /// space.
    void add_extent(const std::vector<PoseRecord>& poses, double radius)
    {
        const LightMotionBounds path(poses);
        LightExtent extent{std::uint32_t(t_.lights.size()), {}, 0, {}};
        path.set_bounding_ball({}, radius, extent);
        const NormalCone directions = path.cone({0, 0, -1});
        extent.axis = directions.axis, extent.cos_turned = directions.cosine;
        extents_.push_back(extent);
    }

    void add_environment()
    {
        EnvironmentRecord& t = t_.environment;
        t.light = no_index;
        // Constant and gradient environments are left to BSDF sampling.
        if (t.mean_luminance <= 0) return;
        t.light = std::uint32_t(t_.lights.size());
        LightRecord light;
        light.kind = std::uint32_t(LightRecordKind::environment);
        light.flags = LightRecord::two_sided;
        t_.described_lights.push_back(no_index);
        add(light, t.mean_luminance * std::numbers::pi * 4 * std::numbers::pi * scene_radius_ * scene_radius_ / 4);
    }

    /// Adds the sun of an analytic sky, if it is above the horizon.
    void add_sun()
    {
        const Environment& e = c_.scene.environment;
        if (e.kind != EnvironmentKind::sky || !e.sun_disk || !(e.to_sun.y > 0)) return;
        const Color irradiance = Sky::sun_irradiance(e.to_sun);
        Light sun;
        sun.kind = LightKind::directional;
        sun.intensity = {irradiance.r * e.color.r, irradiance.g * e.color.g, irradiance.b * e.color.b};
        sun.angle = Sky::sun_angle;
        // These are the rows of the node's frame, whose z axis points at the sun.
        const Vec3d z = normalize(e.world_from_environment.vector(e.to_sun));
        const Vec3d x = normalize(cross(std::abs(z.y) < 0.9 ? Vec3d{0, 1, 0} : Vec3d{1, 0, 0}, z)), y = cross(z, x);
        Transform render_from_node;
        for (int row = 0; row < 3; ++row) {
            const auto of = [&](const Vec3d& v) { return row == 0 ? v.x : row == 1 ? v.y : v.z; };
            render_from_node.m[row][0] = of(x), render_from_node.m[row][1] = of(y), render_from_node.m[row][2] = of(z);
        }
        add_light({&sun, render_from_node});
    }

    void add(const LightRecord& light, double power, bool is_black = false)
    {
        t_.lights.push_back(light);
        t_.black_lights.push_back(is_black);
        powers_.push_back(power);
    }

    /// Builds the selection probabilities by power, with a minimum of a hundredth of the mean. Black lights are not
    /// selected, unless all are black.
    void make_distribution()
    {
        double total = 0;
        for (double p : powers_) total += p;
        const double floor = total > 0 ? 0.01 * total / double(powers_.size()) : 1;
        double sum = 0;
        const auto black = std::count(t_.black_lights.begin(), t_.black_lights.end(), 1u);
        if (black == 0 || std::size_t(black) == powers_.size()) t_.black_lights.clear();
        for (std::size_t i = 0; i < powers_.size(); ++i)
            if (t_.black_lights.empty() || !t_.black_lights[i]) sum += powers_[i] = std::max(powers_[i], floor);
        t_.light_cdf.assign(1, 0);
        double running = 0;
        for (std::size_t i = 0; i < powers_.size(); ++i) {
            running += powers_[i];
            t_.light_cdf.push_back(float(running / sum));
            // The probability is the difference of two floats of the table, so that pmf and selection agree exactly.
            t_.lights[i].pmf = t_.light_cdf[i + 1] - t_.light_cdf[i];
        }
    }

    Compiler& c_;
    SceneTables& t_;
    std::vector<double> powers_;
    std::vector<LightExtent> extents_;
    const std::vector<std::vector<NodeKey>>* motions_ = nullptr;
    const double scene_radius_;
};

}  // namespace

void compile_lights(Compiler& c, const FlattenedScene& occurrences)
{
    LightCompiler(c).run(occurrences);
}

}  // namespace fathom
