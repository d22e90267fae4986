#include "ray_sets.h"

#include <cmath>
#include <ctime>
#include <limits>

namespace fathom::bench {

double now(int threads)
{
    timespec t{};
    clock_gettime(threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
    return double(t.tv_sec) + double(t.tv_nsec) * 1e-9;
}

RayArrays RaySet::arrays(std::size_t first, std::size_t n) const
{
    return {
        &o[0][first], &o[1][first], &o[2][first], &d[0][first], &d[1][first], &d[2][first], &t_max[first], nullptr, n};
}

namespace {

constexpr float infinity_f = std::numeric_limits<float>::infinity();

struct Point {
    Vec3d p, n;
};

Vec3d wide(Vec3f a)
{
    return {a.x, a.y, a.z};
}

class Maker {
public:
    Maker(const Mesh& mesh, const Bvh& bvh) : mesh_(mesh), bvh_(bvh)
    {
        Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
        for (const Vec3f& p : mesh.tables.positions) {
            low = {std::min(low.x, double(p.x)), std::min(low.y, double(p.y)), std::min(low.z, double(p.z))};
            high = {std::max(high.x, double(p.x)), std::max(high.y, double(p.y)), std::max(high.z, double(p.z))};
        }
        diagonal_ = length(high - low);
    }

    RaySet primary(std::size_t parts)
    {
        constexpr int width = 1920, height = 1080;
        const View& view = mesh_.view;
        const Vec3d forward = normalize(view.look_at - view.position), right = normalize(cross(forward, view.up)),
                    up = cross(right, forward);
        const double scale = std::tan(view.x_fov_deg * M_PI / 360) / (width / 2.0);
        RaySet set;
        set.kind = "primary";
        set.coherent = true;
        std::size_t pixel = 0;
        for (std::uint32_t code = 0; code < 2048 * 2048; ++code) {
            const int x = compact(code), y = compact(code >> 1);
            if (x >= width || y >= height || pixel++ / 1024 % parts != 0) continue;
            const double sx = (x + uniform() - width / 2.0) * scale, sy = (height / 2.0 - y - uniform()) * scale;
            add(set, view.position, normalize(forward + right * sx + up * sy), infinity_f);
        }
        finish(set);
        return set;
    }

    /// Where the rays of a set hit, facing them; misses are left out.
    std::vector<Point> hits(const RaySet& set)
    {
        const std::size_t n = set.count();
        std::vector<float> t(n), u(n), v(n);
        std::vector<std::uint32_t> primitive(n), instance(n);
        bvh_.closest(set.arrays(0, n), {t.data(), u.data(), v.data(), primitive.data(), instance.data()}, set.coherent);
        std::vector<Point> points;
        for (std::size_t i = 0; i < n; ++i) {
            if (primitive[i] == 0xffffffffu) continue;
            const SceneTables& tables = mesh_.tables;
            const std::uint32_t* corners = &tables.triangles[3 * std::size_t(primitive[i])];
            const Vec3d a = wide(tables.positions[corners[0]]), b = wide(tables.positions[corners[1]]),
                        c = wide(tables.positions[corners[2]]);
            const Vec3d o{set.o[0][i], set.o[1][i], set.o[2][i]}, d{set.d[0][i], set.d[1][i], set.d[2][i]};
            Vec3d normal = normalize(cross(b - a, c - a));
            if (dot(normal, d) > 0) normal = -normal;
            points.push_back({o + d * double(t[i]) + normal * (diagonal_ * 1e-5), normal});
        }
        return points;
    }

    RaySet diffuse(const std::vector<Point>& points, const char* kind, double reach, bool shadow)
    {
        RaySet set;
        set.kind = kind;
        set.shadow = shadow;
        for (const Point& point : points) {
            const double z = 2 * uniform() - 1, phi = 2 * M_PI * uniform(), r = std::sqrt(std::max(0.0, 1 - z * z));
            const Vec3d d = point.n + Vec3d{r * std::cos(phi), r * std::sin(phi), z};
            add(set, point.p, length(d) > 1e-6 ? normalize(d) : point.n, float(reach));
        }
        finish(set);
        return set;
    }

    /// Towards points of a square lamp above the camera, below whatever is there.
    RaySet shadow(const std::vector<Point>& points)
    {
        const View& view = mesh_.view;
        RaySet probe;
        add(probe, view.position, normalize(view.up), infinity_f);
        finish(probe);
        float t = 0, u = 0, v = 0;
        std::uint32_t primitive = 0, instance = 0;
        bvh_.closest(probe.arrays(0, 1), {&t, &u, &v, &primitive, &instance}, false);
        const double distance = std::min(double(t) * 0.8, diagonal_), side = distance * 0.25;
        RaySet set;
        set.kind = "shadow";
        set.shadow = set.coherent = true;
        for (const Point& point : points) {
            const Vec3d lamp = view.position + normalize(view.up) * distance +
                               Vec3d{side * (uniform() - 0.5), 0, side * (uniform() - 0.5)};
            const Vec3d d = lamp - point.p;
            add(set, point.p, normalize(d), float(length(d) * 0.9999));
        }
        finish(set);
        return set;
    }

    double diagonal() const { return diagonal_; }

private:
    static int compact(std::uint32_t x)
    {
        x &= 0x55555555u;
        x = (x | x >> 1) & 0x33333333u;
        x = (x | x >> 2) & 0x0f0f0f0fu;
        x = (x | x >> 4) & 0x00ff00ffu;
        return int((x | x >> 8) & 0xffffu);
    }
    double uniform()
    {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return double(state_ >> 11) * 0x1p-53;
    }
    static void add(RaySet& set, Vec3d o, Vec3d d, float t_max)
    {
        set.o[0].push_back(float(o.x)), set.o[1].push_back(float(o.y)), set.o[2].push_back(float(o.z));
        set.d[0].push_back(float(d.x)), set.d[1].push_back(float(d.y)), set.d[2].push_back(float(d.z));
        set.t_max.push_back(t_max);
    }
    static void finish(RaySet& set)
    {
        for (auto* a : {&set.o[0], &set.o[1], &set.o[2], &set.d[0], &set.d[1], &set.d[2], &set.t_max})
            a->resize(a->size() + RaySet::padding, 1.f);
    }

    const Mesh& mesh_;
    const Bvh& bvh_;
    double diagonal_ = 0;
    std::uint64_t state_ = 1;
};

}  // namespace

std::vector<RaySet> make_ray_sets(const Mesh& mesh, const Bvh& bvh, std::size_t parts)
{
    Maker maker(mesh, bvh);
    std::vector<RaySet> sets;
    sets.push_back(maker.primary(parts));
    const std::vector<Point> first = maker.hits(sets[0]);
    sets.push_back(maker.shadow(first));
    sets.push_back(maker.diffuse(first, "bounce-1", infinity_f, false));
    const RaySet second = maker.diffuse(maker.hits(sets[2]), "bounce-2", infinity_f, false);
    sets.push_back(maker.diffuse(maker.hits(second), "bounce-3", infinity_f, false));
    sets.push_back(maker.diffuse(first, "occlusion", maker.diagonal() * 0.02, true));
    return sets;
}

}  // namespace fathom::bench
