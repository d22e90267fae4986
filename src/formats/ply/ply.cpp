// SPDX-License-Identifier: Apache-2.0
#include "formats/ply/ply.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "formats/common/srgb.h"
#include "formats/io/large_pages.h"
#include "formats/mesh/face_colors.h"
#include "formats/mesh/mesh_cleanup.h"
#include "formats/mesh/point_cloud.h"
#include "formats/ply/ply_body.h"
#include "formats/ply/ply_colors.h"
#include "formats/ply/ply_faces.h"
#include "formats/ply/ply_header.h"

namespace fathom {

namespace {

/// Integers are sRGB codes, floats are linear.
float color_channel(double value, PlyType type, bool is_alpha)
{
    if (type == PlyType::f32 || type == PlyType::f64) return float(value);
    const double c = value / (type == PlyType::u16 ? 65535 : 255);
    return is_alpha ? float(c) : linear_from_srgb(c);
}

class PlyReader {
public:
    PlyReader(InputFile& input, PlyAttribute colors)
        : file_(input.name()),
          colors_(std::move(colors)),
          window_(input),
          header_(read_ply_header(file_, window_)),
          body_(file_, window_, header_.format, header_.lines + 1)
    {
    }

    PlyData read()
    {
        for (const PlyElement& element : header_.elements) {
            // Impossible counts are rejected before memory is allocated. In ASCII each number takes at least two bytes.
            const std::size_t least =
                header_.format == PlyFormat::ascii ? 2 * element.properties.size() : element.min_size();
            if (least > 0 && element.count > (body_.bytes_left() + 1) / least)
                body_.fail(fmt::format("{} elements '{}' do not fit into the file, which is truncated", element.count,
                                       printable(element.name)));
            if (element.name == "vertex")
                read_vertices(element);
            else if (element.name == "face")
                read_faces(element);
            else if (element.name == "tristrips")
                read_strips(element);
            else if (element.name == "curve")
                read_curves(element);
            else if (least > 0)
                for (std::size_t i = 0; i < element.count; ++i)
                    for (const PlyProperty& property : element.properties) body_.skip(property);
        }
        faces_.flush_waiting_faces();
        check_curves();
        if (!data_.face_colors.empty()) data_.face_colors.resize(mesh_.indices.size() / 3, white);
        return std::move(data_);
    }

private:
    /// Destination of a vertex property: an array of floats and an offset in it; null to skip the property.
    struct Target {
        float* data = nullptr;
        std::size_t stride = 0;
        enum { plain, flipped, color, alpha } kind = plain;
    };

    template <class T>
    static Target target(std::vector<T>& to, std::size_t count, std::size_t component)
    {
        if (to.size() != count) {
            reserve_large(to, count);
            to.resize(count);
        }
        return {&to.data()->x + component, sizeof(T) / sizeof(float), Target::plain};
    }

    Target target_of(const std::string& name, std::size_t count)
    {
        Target t;
        const auto is = [&](auto... names) { return ((name == names) || ...); };
        if (is("x", "y", "z")) return target(mesh_.positions, count, std::size_t(name[0] - 'x'));
        if (is("nx", "ny", "nz")) return target(mesh_.normals, count, std::size_t(name[1] - 'x'));
        if (is("u", "s", "texture_u", "texture_s")) return target(mesh_.uvs[0], count, 0);
        if (is("v", "t", "texture_v", "texture_t")) {
            t = target(mesh_.uvs[0], count, 1);
            t.kind = Target::flipped;
            return t;
        }
        // fathom::save_scene writes u0 and v0 with v downward, as scenes store it: flipping v on each way could lose
        // bits.
        if (is("u0", "v0")) return target(mesh_.uvs[0], count, name[0] == 'v');
        if (is("u1", "v1")) return target(mesh_.uvs[1], count, name[0] == 'v');
        if (is("tx", "ty", "tz")) return target(mesh_.tangents, count, std::size_t(name[1] - 'x'));
        if (is("tw")) return target(mesh_.tangents, count, 3);
        if (is("radius")) {
            data_.radii.resize(count);
            return {data_.radii.data(), 1, Target::plain};
        }
        return t;
    }

    static Target target_in(std::vector<Vec4f>& colors, std::size_t count, PlyChannel channel)
    {
        if (colors.empty()) colors.assign(count, white);
        Target t = target(colors, count, std::size_t(channel.index));
        if (channel.is_encoded) t.kind = channel.index == 3 ? Target::alpha : Target::color;
        return t;
    }

    /// Expands a single-number attribute to gray.
    static void spread_number(std::vector<Vec4f>& colors, const std::vector<PlyChannel>& channels)
    {
        int used = 0;
        for (const PlyChannel& c : channels)
            if (c.index >= 0) used |= c.is_encoded ? 2 : 1 << c.index;
        if (used == 1)
            for (Vec4f& c : colors) c.y = c.z = c.x;
    }

    void read_vertices(const PlyElement& element)
    {
        if (element.count == 0) return;
        if (element.count > std::numeric_limits<std::uint32_t>::max()) body_.fail("there are more than 2^32 vertices");
        std::vector<PlyChannel> channels(element.properties.size());
        if (!colors_.of_faces) channels = channels_of(element, colors_.name);
        std::vector<Target> targets;
        targets.reserve(element.properties.size());
        for (std::size_t k = 0; k < channels.size(); ++k) {
            const PlyProperty& p = element.properties[k];
            targets.push_back(p.is_list                ? Target{}
                              : channels[k].index >= 0 ? target_in(mesh_.colors, element.count, channels[k])
                                                       : target_of(p.name, element.count));
        }
        if (mesh_.positions.empty()) body_.fail("the vertices have no x, y and z");
        read_rows(element, targets);
        spread_number(mesh_.colors, channels);
        faces_.flush_waiting_faces();
    }

    void read_rows(const PlyElement& element, const std::vector<Target>& targets)
    {
        if (body_.is_native() && !element.has_lists()) return read_native_vertices(element, targets);
        for (std::size_t i = 0; i < element.count; ++i)
            for (std::size_t k = 0; k < targets.size(); ++k) {
                if (targets[k].data)
                    store(targets[k], i, body_.number(element.properties[k].type), element.properties[k].type);
                else
                    body_.skip(element.properties[k]);
            }
    }

    static void store(const Target& t, std::size_t i, double value, PlyType type)
    {
        if (t.kind == Target::flipped) value = 1 - value;
        t.data[i * t.stride] = t.kind == Target::color || t.kind == Target::alpha
                                   ? color_channel(value, type, t.kind == Target::alpha)
                                   : float(value);
    }

    /// Reads fixed-size vertices in native byte order, in blocks of rows that fit into the cache, one property at a
    /// time.
    void read_native_vertices(const PlyElement& element, const std::vector<Target>& targets)
    {
        const std::size_t stride = element.min_size(), most = std::max<std::size_t>(1, (128 << 10) / stride);
        for (std::size_t first = 0; first < element.count; first += most) {
            const std::size_t rows = std::min(most, element.count - first);
            const char* data = body_.take(rows * stride);
            for (std::size_t k = 0; k < targets.size(); ++k) {
                const PlyType type = element.properties[k].type;
                Target t = targets[k];
                if (t.data) {
                    t.data += first * t.stride;
                    read_column(data, stride, rows, type, t);
                }
                data += size_of(type);
            }
        }
    }
    static void read_column(const char* p, std::size_t stride, std::size_t count, PlyType type, const Target& t)
    {
        if (type == PlyType::f32 && t.kind == Target::plain) {
            for (std::size_t i = 0; i < count; ++i) std::memcpy(t.data + i * t.stride, p + i * stride, sizeof(float));
            return;
        }
        visit_type(type, [&]<class T>() {
            for (std::size_t i = 0; i < count; ++i, p += stride) {
                T value;
                std::memcpy(&value, p, sizeof value);
                store(t, i, double(value), type);
            }
        });
    }

    void read_faces(const PlyElement& element)
    {
        const auto is_indices = [](const PlyProperty& p) {
            return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
        };
        reserve_large(mesh_.indices, mesh_.indices.size() + 3 * element.count);
        if (element.properties.size() == 1 && is_indices(element.properties[0]) && body_.is_native() &&
            element.properties[0].count_type == PlyType::u8 && size_of(element.properties[0].type) == 4 &&
            element.properties[0].type != PlyType::f32 && !faces_.is_waiting())
            return read_native_faces(element);
        const std::vector<PlyChannel> channels = channels_of(element, colors_.name);
        const bool has_colors =
            std::any_of(channels.begin(), channels.end(), [](PlyChannel c) { return c.index >= 0; });
        std::vector<Vec4f> color(1, white);
        for (std::size_t i = 0; i < element.count; ++i) {
            bool has_corners = false;
            for (std::size_t k = 0; k < channels.size(); ++k) {
                const PlyProperty& property = element.properties[k];
                if (is_indices(property))
                    read_corners(property), has_corners = true;
                else if (channels[k].index >= 0)
                    store(target_in(color, 1, channels[k]), 0, body_.number(property.type), property.type);
                else
                    body_.skip(property);
            }
            if (has_colors) spread_number(color, channels);
            if (has_corners) faces_.add_polygon(corners_, i, has_colors ? &color[0] : nullptr);
        }
    }

    void read_corners(const PlyProperty& property)
    {
        const std::size_t count = body_.list_length(property.count_type);
        corners_.clear();
        for (std::size_t k = 0; k < count; ++k) {
            const double index = body_.number(property.type);
            // Values beyond the range of integers map to an invalid index.
            corners_.push_back(std::abs(index) < 0x1p53 ? std::int64_t(index) : std::int64_t(1) << 53);
        }
    }

    /// Fast path for the usual layout, a length byte and 32-bit indices: reads runs of triangles without branches on
    /// types.
    void read_native_faces(const PlyElement& element)
    {
        for (std::size_t i = 0; i < element.count;) {
            const std::size_t triangles = read_native_triangles(i, element.count - i);
            i += triangles;
            if (triangles > 0 || i == element.count) continue;
            corners_.resize(static_cast<unsigned char>(*body_.take(1)));
            const char* data = body_.take(4 * corners_.size());
            for (std::int64_t& corner : corners_) {
                std::int32_t index;
                std::memcpy(&index, data, 4);
                corner = index;
                data += 4;
            }
            faces_.add_polygon(corners_, i++, nullptr);
        }
    }

    /// Reads the following triangles that are in one piece and returns their number.
    std::size_t read_native_triangles(std::size_t face, std::size_t most)
    {
        constexpr std::size_t row = 13;
        std::uint32_t corners[3 * 1024];
        const std::string_view piece = body_.peek(row);
        most = std::min({most, piece.size() / row, std::size(corners) / 3});
        std::size_t count = 0;
        std::uint32_t largest = 0;
        for (; count < most && piece[row * count] == 3; ++count) {
            std::uint32_t* const triangle = corners + 3 * count;
            std::memcpy(triangle, piece.data() + row * count + 1, row - 1);
            largest = std::max({largest, triangle[0], triangle[1], triangle[2]});
        }
        if (count > 0 && largest >= mesh_.positions.size())
            for (std::size_t k = 0; k < 3 * count; ++k) faces_.check_index(std::int32_t(corners[k]), face + k / 3);
        mesh_.indices.insert(mesh_.indices.end(), corners, corners + 3 * count);
        body_.take(row * count);
        return count;
    }

    void read_curves(const PlyElement& element)
    {
        for (std::size_t i = 0; i < element.count; ++i)
            for (const PlyProperty& property : element.properties) {
                if (property.name != "vertices" || property.is_list)
                    body_.skip(property);
                else
                    data_.curve_counts.push_back(read_count(property, i));
            }
    }
    std::uint32_t read_count(const PlyProperty& property, std::size_t curve)
    {
        const double count = body_.number(property.type);
        if (!(count >= 0 && count <= double(std::numeric_limits<std::uint32_t>::max()))) fail_curve(curve, count);
        return std::uint32_t(count);
    }
    void check_curves() const
    {
        for (std::size_t i = 0; i < data_.curve_counts.size(); ++i)
            if (data_.curve_counts[i] > mesh_.positions.size()) fail_curve(i, data_.curve_counts[i]);
    }
    [[noreturn]] void fail_curve(std::size_t curve, double count) const
    {
        throw Error(file_, fmt::format("curve {}", curve),
                    fmt::format("expected {} vertices, but there are only {}", count, mesh_.positions.size()));
    }

    /// Reads triangle strips (`tristrips`), as Stanford's files have.
    void read_strips(const PlyElement& element)
    {
        for (std::size_t i = 0; i < element.count; ++i)
            for (const PlyProperty& property : element.properties) {
                if (property.is_list && property.name == "vertex_indices")
                    read_corners(property), faces_.add_strip(corners_, i);
                else
                    body_.skip(property);
            }
    }

    static constexpr Vec4f white{1, 1, 1, 1};

    const std::string& file_;
    const PlyAttribute colors_;
    InputWindow window_;
    PlyHeader header_;
    PlyBody body_;
    PlyData data_;
    Mesh& mesh_ = data_.mesh;
    PlyFaces faces_{file_, data_};
    PlyFaces::Corners corners_;
};

SceneDescription point_cloud(PlyData points, const std::filesystem::path& file, LoadContext& context)
{
    const std::string name = file.string();
    context.warnings.add(name + ": colors of points are not supported: gray is used", !points.mesh.colors.empty());
    SceneDescription scene;
    scene.file = name;
    Points cloud;
    if (points.radii.empty())
        cloud = fitting_points(std::move(points.mesh.positions), name, context.warnings);
    else
        cloud.centers = std::move(points.mesh.positions), cloud.radii = std::move(points.radii);
    cloud.name = file.stem().string();
    add_point_cloud(scene, std::move(cloud));
    if (scene.points.empty()) throw Error(name, "", "none of its points is finite");
    return scene;
}

}  // namespace

PlyData read_ply_data(InputFile& input, const PlyAttribute& colors)
{
    input.skip_byte_order_mark();
    return PlyReader(input, colors).read();
}

SceneDescription read_ply(const std::filesystem::path& file, InputFile& input, LoadContext& context)
{
    const std::string name = file.string();
    PlyData data = read_ply_data(input);
    Mesh& mesh = data.mesh;
    if (mesh.positions.empty()) throw Error(name, "", "it contains no vertices");
    if (mesh.indices.empty() && data.bad_faces == 0) return point_cloud(std::move(data), file, context);
    if (mesh.indices.empty())
        throw Error(name, "", "it contains no triangles: its faces have fewer than three vertices");
    context.warnings.add(name + ": faces with fewer than three vertices are ignored", data.bad_faces);
    mesh.name = file.stem().string();
    if (mesh.colors.empty() && !data.face_colors.empty()) set_face_colors(mesh, data.face_colors);
    clean_mesh(mesh, name, context.mesh_faults);

    SceneDescription scene;
    scene.file = name;
    Node node;
    node.name = mesh.name;
    Shape shape{MeshInstance{0}, -1, mesh.name};
    if (!mesh.colors.empty()) {
        Material colored;
        colored.name = "vertex colors";
        colored.base_color.value = {1, 1, 1};
        colored.use_vertex_color = true;
        scene.materials.push_back(std::move(colored));
        shape.material = 0;
    }
    node.shapes.push_back(std::move(shape));
    scene.meshes.push_back(std::move(mesh));
    scene.nodes.push_back(std::move(node));
    scene.roots = {0};
    return scene;
}

}  // namespace fathom
