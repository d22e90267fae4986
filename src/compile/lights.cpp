#include <algorithm>
#include <cmath>
#include <numbers>

#include "compile/compiler.h"

namespace fathom {

namespace {

Rgb spectrum(Color c)
{
    return {c.r, c.g, c.b};
}
double luminance(const float* c)
{
    return 0.2126 * double(c[0]) + 0.7152 * double(c[1]) + 0.0722 * double(c[2]);
}
/// Without cancellation where the angle is small.
double one_minus_cos(double angle)
{
    const double s = std::sin(angle / 2);
    return 2 * s * s;
}
/// Directions in float don't tell the parts of a narrower disk apart.
constexpr double least_angle = 1e-6;

void put(float* to, Vec3d v)
{
    to[0] = float(v.x), to[1] = float(v.y), to[2] = float(v.z);
}

class LightCompiler {
public:
    explicit LightCompiler(Compiler& c) : c_(c), t_(c.tables) {}

    void run(const std::vector<LightOccurrence>& lights)
    {
        scene_radius_ = radius();
        for (ShapeRecord& shape : t_.shapes) add_emissive(shape);
        for (const LightOccurrence& light : lights) add_light(light);
        add_environment();
        make_distribution();
    }

private:
    double radius() const
    {
        double r = 1;
        for (const Vec3f& p : t_.positions) r = std::max(r, length(to_double(p)));
        for (const QuadRecord& q : t_.quads) r = std::max(r, length(to_double(q.corner)));
        for (const SphereRecord& s : t_.spheres)
            r = std::max(r, length(to_double(s.center)) + std::abs(double(s.radius)));
        return r;
    }

    /// One light per primitive of a shape that emits.
    void add_emissive(ShapeRecord& shape)
    {
        const std::uint32_t shape_index = std::uint32_t(&shape - t_.shapes.data());
        const MaterialRecord& material = t_.materials[shape.material];
        if (!(material.flags & MaterialRecord::emits) || (material.flags & MaterialRecord::unlit)) return;
        // What moves in other ways than spheres do is found by the directions that surfaces choose, not sampled.
        if (shape.moving_vertices > 0 || (shape.flags & ShapeRecord::only_instanced)) return;
        const std::uint32_t first = shape.first_primitive;
        if (first < t_.primitive_count() && t_.shape_of_primitive[first] != shape_index) return;  // of an instance
        // So are curves, which have no sampling.
        if (first >= t_.first_curve() && first < t_.first_point()) return;
        shape.light_base = std::uint32_t(t_.lights.size());
        for (std::uint32_t p = shape.first_primitive;
             p < t_.primitive_count() && t_.shape_of_primitive[p] == shape_index; ++p) {
            LightRecord light = primitive_light(p, shape.flags & ShapeRecord::flipped);
            light.primitive = p;
            const bool varied = material.emission_texture != no_index || (shape.flags & ShapeRecord::alpha_tested);
            light.material = varied ? shape.material : no_index;
            light.two_sided = (material.flags & MaterialRecord::two_sided_emission) != 0;
            std::copy(material.emission.begin(), material.emission.end(), light.radiance);
            // Power; a texture is taken for half as bright as its factor.
            add(light, luminance(light.radiance) * light.area * std::numbers::pi * (light.two_sided ? 2 : 1));
        }
    }

    LightRecord primitive_light(std::uint32_t p, bool flipped) const
    {
        LightRecord light;
        const double side = flipped ? -1 : 1;
        if (p < t_.first_quad()) {
            const std::uint32_t* v = &t_.triangles[3 * std::size_t(p)];
            const Vec3d a = to_double(t_.positions[v[0]]), u = to_double(t_.positions[v[1]]) - a,
                        w = to_double(t_.positions[v[2]]) - a;
            const Vec3d n = cross(u, w);
            light.kind = std::uint32_t(LightRecordKind::triangle);
            put(light.position, a), put(light.edge_u, u), put(light.edge_v, w);
            put(light.normal, normalize(n) * side);
            light.area = float(length(n) / 2);
        } else if (p < t_.first_sphere()) {
            const QuadRecord& q = t_.quads[p - t_.first_quad()];
            const Vec3d u = to_double(q.edge_u), v = to_double(q.edge_v), n = cross(u, v);
            const bool right_angle = std::abs(dot(u, v)) <= 1e-6 * length(u) * length(v);
            light.kind = std::uint32_t(right_angle ? LightRecordKind::rectangle : LightRecordKind::parallelogram);
            put(light.position, to_double(q.corner));
            put(light.edge_u, right_angle ? normalize(u) : u), put(light.edge_v, right_angle ? normalize(v) : v);
            put(light.normal, normalize(n) * side);
            light.length_u = float(length(u)), light.length_v = float(length(v));
            light.area = float(length(n));
            put(light.center, to_double(q.corner) + (u + v) * 0.5);
            light.radius = float(length(u + v));
        } else if (p < t_.first_disk()) {
            const SphereRecord& s = t_.spheres[p - t_.first_sphere()];
            light.kind = std::uint32_t(LightRecordKind::sphere);
            put(light.position, to_double(s.center)), put(light.motion, to_double(s.motion));
            light.radius = s.radius;
            light.area = float(4 * std::numbers::pi * double(s.radius) * double(s.radius));
        } else if (p >= t_.first_point()) {
            const Vec4f& point = t_.points[p - t_.first_point()];
            light.kind = std::uint32_t(LightRecordKind::sphere);
            put(light.position, {point.x, point.y, point.z});
            light.radius = point.w;
            light.area = float(4 * std::numbers::pi * double(point.w) * double(point.w));
        } else {
            const DiskRecord& d = t_.disks[p - t_.first_disk()];
            light.kind = std::uint32_t(LightRecordKind::disk);
            put(light.position, to_double(d.center)), put(light.normal, to_double(d.normal));
            light.radius = d.radius;
            light.area = float(std::numbers::pi * double(d.radius) * double(d.radius));
        }
        return light;
    }

    void add_light(const LightOccurrence& occurrence)
    {
        const Light& l = *occurrence.light;
        LightRecord light;
        light.two_sided = 1;
        const Rgb intensity = spectrum(l.intensity);
        std::copy(intensity.begin(), intensity.end(), light.radiance);
        put(light.position, occurrence.render_from_node.point({0, 0, 0}));
        put(light.edge_u, normalize(occurrence.render_from_node.vector({0, 0, -1})));
        if (l.kind == LightKind::directional) {
            light.kind = std::uint32_t(LightRecordKind::directional);
            put(light.position, {0, 0, 0});
            if (l.angle > least_angle) {
                // Irradiance E of a disk of half angle a at normal incidence is its radiance times pi sin^2 a.
                const double half = std::min(l.angle / 2, std::numbers::pi / 2), s = std::sin(half);
                light.radius = float(one_minus_cos(half));
                for (float& r : light.radiance) r = float(r / (std::numbers::pi * s * s));
            }
            add(light, luminance(intensity.data()) * std::numbers::pi * scene_radius_ * scene_radius_);
            return;
        }
        // Intensity is per world unit squared of distance; render space is scaled.
        for (float& r : light.radiance) r = float(r * c_.space.scale * c_.space.scale);
        light.kind = std::uint32_t(l.kind == LightKind::spot ? LightRecordKind::spot : LightRecordKind::point);
        const double outer = one_minus_cos(l.outer_angle);
        light.outer = float(outer);
        light.falloff = float(outer - one_minus_cos(std::min(l.inner_angle, l.outer_angle)));
        add(light, luminance(light.radiance) * 4 * std::numbers::pi);
    }

    void add_environment()
    {
        const Environment& e = c_.scene.environment;
        EnvironmentRecord& t = t_.environment;
        t.kind = std::uint32_t(e.kind);
        t.color = spectrum(e.color);
        t.bottom = spectrum(e.bottom);
        t.top = spectrum(e.top);
        if (e.kind == EnvironmentKind::none) return;
        const Transform inverse = e.world_from_environment.inverse();
        for (std::size_t i = 0; i < 9; ++i) t.environment_from_render[i] = float(inverse.m[i / 3][i % 3]);
        // A constant or a gradient is found well enough by the directions that surfaces choose.
        if (e.kind != EnvironmentKind::image || t.width == 0) return;
        const double mean = make_environment_distribution();
        if (mean <= 0) return;
        t.light = std::uint32_t(t_.lights.size());
        LightRecord light;
        light.kind = std::uint32_t(LightRecordKind::environment);
        light.two_sided = 1;
        add(light, mean * std::numbers::pi * 4 * std::numbers::pi * scene_radius_ * scene_radius_ / 4);
    }

    /// Cumulative distributions over rows and, within a row, pixels, by luminance times the solid angle. Bilinear
    /// lookup spreads a pixel's light over its neighbours, so each cell has the mean of the 3x3 around it. Returns mean
    /// radiance.
    double make_environment_distribution()
    {
        EnvironmentRecord& t = t_.environment;
        const int w = t.width, h = t.height;
        const auto value = [&](int x, int y) {
            x = (x + w) % w;
            y = std::clamp(y, 0, h - 1);
            const float* texel = &t.texels[(std::uint64_t(y) * std::uint64_t(w) + std::uint64_t(x)) * 4];
            const float c[3] = {texel[0] * t.color[0], texel[1] * t.color[1], texel[2] * t.color[2]};
            return std::max(0.0, luminance(c));
        };
        t.marginal.assign(std::size_t(h) + 1, 0);
        t.conditional.assign(std::size_t(h) * std::size_t(w + 1), 0);
        std::vector<double> rows(std::size_t(h) + 1);
        double weight = 0;
        for (int y = 0; y < h; ++y) {
            const double sine = std::sin((y + 0.5) * std::numbers::pi / h);
            std::vector<double> sum(std::size_t(w) + 1);
            for (int x = 0; x < w; ++x) {
                double v = 0;
                for (int dy = -1; dy <= 1; ++dy)
                    for (int dx = -1; dx <= 1; ++dx) v += value(x + dx, y + dy) / 9;
                sum[std::size_t(x) + 1] = sum[std::size_t(x)] + v;
            }
            float* row = &t.conditional[std::size_t(y) * std::size_t(w + 1)];
            for (int x = 0; x <= w; ++x)
                row[x] =
                    sum[std::size_t(w)] > 0 ? float(sum[std::size_t(x)] / sum[std::size_t(w)]) : float(x) / float(w);
            rows[std::size_t(y) + 1] = rows[std::size_t(y)] + sum[std::size_t(w)] * sine;
            weight += sine * w;
        }
        const double total = rows[std::size_t(h)];
        for (int y = 0; y <= h; ++y)
            t.marginal[std::size_t(y)] = total > 0 ? float(rows[std::size_t(y)] / total) : float(y) / float(h);
        return total / weight;
    }

    void add(const LightRecord& light, double power)
    {
        t_.lights.push_back(light);
        powers_.push_back(power);
    }

    /// Lights are chosen by power, but none with less than a hundredth of the mean.
    void make_distribution()
    {
        double total = 0;
        for (double p : powers_) total += p;
        const double floor = powers_.empty() ? 0 : 0.01 * total / double(powers_.size());
        double sum = 0;
        for (double& p : powers_) sum += p = std::max(p, floor);
        t_.light_cdf.assign(1, 0);
        double running = 0;
        for (std::size_t i = 0; i < powers_.size(); ++i) {
            running += powers_[i];
            t_.light_cdf.push_back(sum > 0 ? float(running / sum) : float(i + 1) / float(powers_.size()));
            // The probability that the float table gives, not the one that was meant.
            t_.lights[i].pmf = t_.light_cdf[i + 1] - t_.light_cdf[i];
        }
    }

    Compiler& c_;
    SceneTables& t_;
    std::vector<double> powers_;
    double scene_radius_ = 1;
};

}  // namespace

void compile_lights(Compiler& c, const std::vector<LightOccurrence>& lights)
{
    LightCompiler(c).run(lights);
}

}  // namespace fathom
