// SPDX-License-Identifier: Apache-2.0
#include "formats/obj/obj.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <set>

#include "formats/common/srgb.h"
#include "formats/mesh/mesh_cleanup.h"
#include "formats/mesh/point_cloud.h"
#include "formats/mesh/polygon.h"
#include "formats/obj/line_blocks.h"
#include "formats/obj/obj_piece.h"
#include "formats/obj/vertex_join.h"

namespace fathom {

namespace {

/// Joins the pieces of a file in order, and handles everything that depends on earlier lines.
class ObjReader {
public:
    ObjReader(const std::filesystem::path& file, InputFile& input, LoadContext& context)
        : file_(file), name_(file.string()), input_(input), context_(context), warnings_(context.warnings)
    {
    }

    SceneDescription read()
    {
        input_.skip_byte_order_mark();
        read_pieces();
        warn_of_unknown_materials();
        if (positions_.empty()) throw Error(name_, "", "it contains no vertices: is it an OBJ file?");
        join_ = {};
        scene_.file = name_;
        for (auto& [key, part] : parts_) add_part(*part);
        scene_.roots.resize(scene_.nodes.size());
        for (std::size_t i = 0; i < scene_.roots.size(); ++i) scene_.roots[i] = int(i);
        if (corners_seen_ == 0 && cloud_.empty()) cloud_ = positions_.take();
        Points points = fitting_points(std::move(cloud_), name_, warnings_);
        points.name = "points";
        add_point_cloud(scene_, std::move(points));
        return std::move(scene_);
    }

private:
    void warn(const char* message, std::size_t times = 1) { warnings_.add(name_ + ": " + message, times); }

    /// Parses pieces in parallel and joins them in order.
    void read_pieces()
    {
        const std::size_t threads =
            std::min<std::size_t>(std::size_t(tbb::this_task_arena::max_concurrency()),
                                  tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
        // Twice the number of threads keeps all of them busy during joining. A single thread uses one piece, which
        // stays in its cache.
        std::vector<ObjPiece> pieces(threads == 1 ? 1 : 2 * threads);
        LineBlocks blocks(input_);
        std::size_t count = 0;
        tbb::parallel_pipeline(pieces.size(),
                               tbb::make_filter<void, ObjPiece*>(tbb::filter_mode::serial_in_order,
                                                                 [&](tbb::flow_control& control) -> ObjPiece* {
                                                                     ObjPiece& piece = pieces[count++ % pieces.size()];
                                                                     if (!blocks.next(piece.text)) control.stop();
                                                                     return &piece;
                                                                 }) &
                                   tbb::make_filter<ObjPiece*, ObjPiece*>(tbb::filter_mode::parallel,
                                                                          [&](ObjPiece* piece) {
                                                                              read_until_error(*piece);
                                                                              return piece;
                                                                          }) &
                                   tbb::make_filter<ObjPiece*, void>(tbb::filter_mode::serial_in_order,
                                                                     [&](ObjPiece* piece) { join(*piece); }));
    }

    /// Parses a piece up to the first error, which join() reports after all earlier lines.
    void read_until_error(ObjPiece& piece) const
    {
        try {
            read_obj_piece(piece, name_, 1);
        } catch (const Error&) {
            piece.is_damaged = true;
        }
    }

    void join(ObjPiece& piece)
    {
        const ObjCounts before{positions_.size(), uvs_.size(), normals_.size()};
        append(piece);
        auto event = piece.events.begin();
        std::size_t run = 0;
        event_line_ = {piece.text.data(), line_};
        for (std::size_t face = 0; face < piece.face_ends.size(); ++face) {
            for (; event != piece.events.end() && event->face <= face; ++event) take(*event, before);
            while (run + 1 < piece.runs.size() && piece.runs[run + 1].first_face <= face) ++run;
            so_far_ = sum(before, piece.runs[run].counts);
            join_face(piece, face);
        }
        for (; event != piece.events.end(); ++event) take(*event, before);
        // Parsing again from the right line number throws the error with its line.
        if (piece.is_damaged) read_obj_piece(piece, name_, line_);
        line_ += piece.lines;
        warn("line elements are ignored", piece.drawn_lines);
        warn("curves and free-form surfaces are ignored", piece.free_forms);
        warn("statements that are not recognized are ignored", piece.unknown_lines);
    }

    static ObjCounts sum(const ObjCounts& a, const ObjCounts& b)
    {
        return {a.positions + b.positions, a.uvs + b.uvs, a.normals + b.normals};
    }

    void append(const ObjPiece& piece)
    {
        const std::size_t before = positions_.size();
        positions_.append(piece.positions);
        uvs_.append(piece.uvs);
        normals_.append(piece.normals);
        if (std::max({positions_.size(), uvs_.size(), normals_.size()}) >= std::size_t(ObjCorner::most))
            throw Error(name_, "", "it contains more than two billion vertices");
        if (!piece.colors.empty()) {
            if (colors_.empty()) first_color_ = before + piece.first_color;
            colors_.resize(before + piece.first_color, ObjPiece::no_color);
            colors_.append(piece.colors);
            for (const Vec4f& c : piece.colors) max_color_ = std::max({max_color_, c.x, c.y, c.z});
        } else if (!colors_.empty()) {
            colors_.resize(positions_.size(), ObjPiece::no_color);
        }
    }

    void take(const ObjPiece::Event& event, const ObjCounts& before)
    {
        switch (event.kind) {
            case ObjPiece::Event::object:
                object_ = event.rest;
                part_ = nullptr;
                return;
            case ObjPiece::Event::material:
                return use_material(event.rest);
            case ObjPiece::Event::library:
                return read_library(event.rest);
            case ObjPiece::Event::points:
                so_far_ = sum(before, event.counts);
                return read_points(event.rest);
        }
    }

    /// Reads the vertices of a point element, one for each word.
    void read_points(std::string_view rest)
    {
        auto& [at, line] = event_line_;
        const char* const begin = rest.data();
        line += std::size_t(std::count(at, begin, '\n'));
        at = begin;
        TextScanner scan(name_, rest, line, '#');
        for (std::string_view word = scan.word(); !word.empty(); word = scan.word())
            cloud_.push_back(positions_[index(scan, word, so_far_.positions, "vertex")]);
    }

    /// Resolves an index as written in the file; throws Error if it is out of range.
    static std::uint32_t index(const TextScanner& scan, std::string_view word, std::size_t size, const char* what)
    {
        const long long i = read_obj_index(scan, word), from_zero = i > 0 ? i - 1 : i + (long long)size;
        if (i == 0 || from_zero < 0 || from_zero >= (long long)size)
            scan.fail(fmt::format("{} {} is out of range: there are {} so far", what, i, size));
        return std::uint32_t(from_zero);
    }

    static bool find(std::int32_t i, std::size_t size, std::uint32_t& from_zero)
    {
        const std::int64_t at = i > 0 ? std::int64_t(i) - 1 : i + std::int64_t(size);
        from_zero = std::uint32_t(at);
        return i != 0 && at >= 0 && at < std::int64_t(size);
    }

    /// Resolves a face corner; false if an index is out of range. Missing normals are tolerated and reported.
    bool find(const ObjCorner& corner, ObjVertex& v)
    {
        v = {0, ObjVertex::none, ObjVertex::none};
        if (!find(corner.position, so_far_.positions, v.position)) return false;
        if (corner.uv != ObjCorner::absent && !find(corner.uv, so_far_.uvs, v.uv)) return false;
        if (corner.normal != ObjCorner::absent && !find(corner.normal, so_far_.normals, v.normal)) {
            warn("normal indices out of range are replaced by normals of the adjacent faces");
            v.normal = ObjVertex::missing;
        }
        return true;
    }

    void join_face(const ObjPiece& piece, std::size_t face)
    {
        const std::size_t begin = face > 0 ? piece.face_ends[face - 1] : 0, count = piece.face_ends[face] - begin;
        corners_.resize(count);
        bool has_normals = true;
        for (std::size_t k = 0; k < count; ++k) {
            if (!find(piece.corners[begin + k], corners_[k])) fail_at(piece, face);
            has_normals &= corners_[k].normal != ObjVertex::none;
        }
        corners_seen_ += count;
        if (count < 3) return warn("faces with fewer than three vertices are ignored");
        ObjPart& part = part_for(has_normals);
        part.has_colors |= so_far_.positions > first_color_;
        if (count == 3) {
            for (const ObjVertex& corner : corners_) add_corner(part, corner);
            return;
        }
        points_.clear();
        for (const ObjVertex& corner : corners_) points_.push_back(positions_[corner.position]);
        triangles_.clear();
        triangulate(points_, triangles_);
        for (const std::uint32_t i : triangles_) add_corner(part, corners_[i]);
    }
    void add_corner(ObjPart& part, ObjVertex corner)
    {
        if (!part.has_normals) corner.normal = ObjVertex::none;
        part.indices.push_back(join_(part, corner, so_far_.positions));
    }

    /// Finds the line of a face again to report what is wrong with it.
    [[noreturn]] void fail_at(const ObjPiece& piece, std::size_t face) const
    {
        TextScanner scan(name_, piece.text, line_, '#');
        for (;; scan.next_line()) {
            const std::string_view key = scan.word();
            if ((key == "f" || key == "fo") && face-- == 0) break;
        }
        for (std::string_view word = scan.word(); !word.empty(); word = scan.word()) {
            index(scan, word.substr(0, word.find('/')), so_far_.positions, "vertex");
            word.remove_prefix(std::min(word.size(), word.find('/')));
            if (word.size() > 1 && word[1] != '/')
                index(scan, word.substr(1, word.find('/', 1) - 1), so_far_.uvs, "texture coordinate");
        }
        scan.fail("a vertex index is out of range");
    }

    ObjPart& part_for(bool has_normals)
    {
        if (part_ && part_->has_normals == has_normals) return *part_;
        auto& part = parts_[{object_, material_, has_normals}];
        if (!part) {
            part = std::make_unique<ObjPart>();
            part->number = std::uint32_t(parts_.size());
            part->name = printable(object_);
            part->material = material_;
            part->has_normals = has_normals;
        }
        part_ = part.get();
        return *part_;
    }

    void use_material(std::string_view name)
    {
        part_ = nullptr;
        auto found = materials_.find(name);
        if (found == materials_.end()) found = materials_.find(before_comment(name));
        material_ = found == materials_.end() ? -1 : found->second;
        if (material_ < 0 && unknown_materials_.insert(std::string(name)).second && unknown_materials_.size() == 1)
            first_unknown_material_ = name;
    }
    void warn_of_unknown_materials()
    {
        if (unknown_materials_.empty()) return;
        const std::string first = printable(first_unknown_material_);
        warnings_.add(unknown_materials_.size() == 1
                          ? fmt::format("{}: there is no material named '{}': gray is used", name_, first)
                          : fmt::format("{}: {} materials are not defined, the first is '{}': gray is used", name_,
                                        thousands_separated(unknown_materials_.size()), first));
    }

    bool read_library_file(std::string_view name)
    {
        const std::filesystem::path file = context_.locate(file_.parent_path() / std::string(name));
        std::error_code error;
        if (!std::filesystem::is_regular_file(file, error)) return false;
        if (!libraries_.insert(file).second) return true;
        read_mtl(file, context_.read(file), scene_, materials_, warnings_);
        return true;
    }

    /// Reads material libraries: one file whose name may contain spaces, or several.
    void read_library(std::string_view rest)
    {
        if (read_library_file(rest)) return;
        rest = before_comment(rest);
        if (read_library_file(rest)) return;
        TextScanner names(name_, rest);
        for (std::string_view name = names.word(); !name.empty(); name = names.word())
            if (!read_library_file(name))
                warnings_.add(fmt::format("{}: the material file '{}' is missing", name_, printable(name)));
    }

    void add_part(ObjPart& part)
    {
        Mesh mesh = mesh_of(part);
        int material = part.material;
        if (!mesh.colors.empty()) material = with_vertex_colors(material);
        part = {};
        clean_mesh(mesh, name_, context_.mesh_faults);
        if (mesh.indices.empty()) return;
        Node node;
        node.name = mesh.name;
        node.shapes.push_back({MeshInstance{int(scene_.meshes.size())}, material, node.name});
        scene_.nodes.push_back(std::move(node));
        scene_.meshes.push_back(std::move(mesh));
    }

    Mesh mesh_of(ObjPart& part) const
    {
        Mesh mesh;
        mesh.name = part.name;
        mesh.indices = part.indices.take();
        const auto fill = [&](auto& values, const auto& value) {
            reserve_large(values, part.vertices());
            values.resize(part.vertices());
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part.vertices(), 1 << 14), [&](const auto& range) {
                for (std::size_t i = range.begin(); i < range.end(); ++i) values[i] = value(part.vertex(i));
            });
        };
        fill(mesh.positions, [&](const ObjVertex& v) { return positions_[v.position]; });
        if (part.has_normals)
            fill(mesh.normals, [&](const ObjVertex& v) {
                return v.normal == ObjVertex::missing ? Vec3f{0, 0, 0} : normals_[v.normal];
            });
        if (part.has_uvs)
            fill(mesh.uvs[0], [&](const ObjVertex& v) { return v.uv == ObjVertex::none ? Vec2f{0, 0} : uvs_[v.uv]; });
        if (part.has_colors) fill(mesh.colors, [&](const ObjVertex& v) { return linear_color(colors_[v.position]); });
        return mesh;
    }
    /// Decodes sRGB colors, whose range is 0 to 1 or, by some programs, 0 to 255: then a value exceeds 2.
    Vec4f linear_color(Vec4f c) const
    {
        if (c.w == ObjPiece::no_color.w) return {1, 1, 1, 1};
        const double scale = max_color_ > 2 ? 255 : 1;
        const auto channel = [&](float x) { return linear_from_srgb(std::max(0.0, double(x) / scale)); };
        return {channel(c.x), channel(c.y), channel(c.z), 1};
    }

    int with_vertex_colors(int material)
    {
        if (const auto found = colored_.find(material); found != colored_.end()) return found->second;
        Material m;
        m.base_color.value = {1, 1, 1};
        if (material >= 0) m = scene_.materials[std::size_t(material)];
        m.use_vertex_color = true;
        scene_.materials.push_back(std::move(m));
        return colored_[material] = int(scene_.materials.size()) - 1;
    }

    const std::filesystem::path& file_;
    std::string name_;
    InputFile& input_;
    LoadContext& context_;
    Warnings& warnings_;
    SceneDescription scene_;

    ChunkedArray<Vec3f> positions_, normals_;
    ChunkedArray<Vec2f> uvs_;
    ChunkedArray<Vec4f> colors_;  ///< colors as written in the file; empty, or one for each position
    float max_color_ = 0;
    std::size_t first_color_ = std::size_t(-1);
    std::map<std::string, int, std::less<>> materials_;
    std::set<std::filesystem::path> libraries_;  ///< libraries read so far
    std::map<int, int> colored_;
    std::set<std::string> unknown_materials_;
    std::string first_unknown_material_;

    std::string object_;
    int material_ = -1;
    std::map<std::tuple<std::string, int, bool>, std::unique_ptr<ObjPart>> parts_;
    ObjPart* part_ = nullptr;  ///< part of the last face; nullptr after a change of object or material
    VertexJoin join_;

    std::size_t line_ = 1;  ///< first line of the current piece
    ObjCounts so_far_;      ///< elements defined before the current face
    std::pair<const char*, std::size_t> event_line_{nullptr, 1};
    std::vector<Vec3f> cloud_;  ///< vertices that `p` refers to
    std::size_t corners_seen_ = 0;
    std::vector<ObjVertex> corners_;  ///< corners of the current face
    std::vector<Vec3f> points_;
    std::vector<std::uint32_t> triangles_;
};

}  // namespace

SceneDescription read_obj(const std::filesystem::path& file, InputFile& input, LoadContext& context)
{
    return ObjReader(file, input, context).read();
}

}  // namespace fathom
