// SPDX-License-Identifier: Apache-2.0
#include "formats/mitsuba/serialized.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cstring>
#include <limits>

#include "fathom/error.h"

namespace fathom::mitsuba {

namespace {

enum Flags : std::uint32_t {
    has_normals = 0x1,
    has_uvs = 0x2,
    has_colors = 0x8,
    is_double = 0x2000,
};
constexpr std::uint16_t sign = 0x041c;
constexpr std::size_t header_bytes = 4;

/// Decompresses a deflate stream incrementally, so that memory grows with the data that actually exists.
class Inflated {
public:
    Inflated(const std::string& file, std::size_t index, const char* bytes, std::size_t size)
        : file_(file), index_(index), left_(size)
    {
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes));
        feed();
        if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
    }
    Inflated(const Inflated&) = delete;
    Inflated& operator=(const Inflated&) = delete;
    ~Inflated() { inflateEnd(&stream_); }

    template <class T>
    T value()
    {
        T value;
        read(&value, sizeof value);
        return value;
    }
    template <class T>
    std::vector<T> values(std::uint64_t count)
    {
        constexpr std::uint64_t piece = 1 << 18;
        std::vector<T> all;
        while (count > 0) {
            const std::uint64_t now = std::min(count, piece);
            const std::size_t before = all.size();
            all.resize(before + now);
            read(all.data() + before, now * sizeof(T));
            count -= now;
        }
        return all;
    }
    [[noreturn]] void fail(const std::string& message) const
    {
        throw Error(file_, fmt::format("mesh {}", index_), message);
    }

private:
    void feed()
    {
        const std::size_t now = std::min<std::size_t>(left_, 1 << 30);
        stream_.avail_in = uInt(now);
        left_ -= now;
    }
    void read(void* to, std::size_t size)
    {
        stream_.next_out = static_cast<Bytef*>(to);
        stream_.avail_out = uInt(size);  // size of one piece, far below 4 GB
        while (stream_.avail_out > 0) {
            if (stream_.avail_in == 0) feed();
            const int result = inflate(&stream_, Z_SYNC_FLUSH);
            if (stream_.avail_out == 0) return;
            if (result == Z_OK && (stream_.avail_in > 0 || left_ > 0)) continue;
            fail(result == Z_STREAM_END || stream_.avail_in == 0 ? "is truncated" : "its deflated data is damaged");
        }
    }

    const std::string& file_;
    std::size_t index_, left_;
    z_stream stream_{};
};

template <class T, class Vector>
std::vector<Vector> vectors(const std::vector<T>& numbers)
{
    constexpr std::size_t n = sizeof(Vector) / sizeof(float);
    std::vector<Vector> result(numbers.size() / n);
    for (std::size_t i = 0; i < result.size(); ++i) {
        float v[n];
        for (std::size_t k = 0; k < n; ++k) v[k] = float(numbers[n * i + k]);
        std::memcpy(&result[i], v, sizeof v);
    }
    return result;
}

template <class T>
void read_vertices(Inflated& in, std::uint32_t flags, std::uint64_t count, Mesh& mesh)
{
    mesh.positions = vectors<T, Vec3f>(in.values<T>(3 * count));
    if (flags & has_normals) mesh.normals = vectors<T, Vec3f>(in.values<T>(3 * count));
    if (flags & has_uvs) mesh.uvs[0] = vectors<T, Vec2f>(in.values<T>(2 * count));
    if (flags & has_colors) {
        for (const Vec3f& c : vectors<T, Vec3f>(in.values<T>(3 * count))) mesh.colors.push_back({c.x, c.y, c.z, 1});
    }
}

template <class T>
T at(const std::string& bytes, std::size_t place)
{
    T value;
    std::memcpy(&value, bytes.data() + place, sizeof value);
    return value;
}

}  // namespace

SerializedFile::SerializedFile(std::string file, std::string bytes) : file_(std::move(file)), bytes_(std::move(bytes))
{
    const auto fail = [&](const char* message) { throw Error(file_, "", message); };
    if (bytes_.size() < header_bytes + 4 || at<std::uint16_t>(bytes_, 0) != sign)
        fail("is not a file of serialized meshes");
    const int version = at<std::uint16_t>(bytes_, 2);
    if (version != 3 && version != 4) fail("has an unsupported version of serialized meshes: 3 and 4 are supported");
    const std::size_t count = at<std::uint32_t>(bytes_, bytes_.size() - 4);
    const std::size_t each = version == 4 ? 8 : 4;
    if (count == 0 || count > (bytes_.size() - 4) / each) fail("its list of meshes is damaged");
    const std::size_t list = bytes_.size() - 4 - count * each;
    if (list < header_bytes) fail("its list of meshes is damaged");
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t offset =
            version == 4 ? at<std::uint64_t>(bytes_, list + 8 * i) : at<std::uint32_t>(bytes_, list + 4 * i);
        const std::uint64_t before = i == 0 ? 0 : offsets_.back();
        if ((i == 0 ? offset != 0 : offset <= before) || offset > list - header_bytes ||
            at<std::uint16_t>(bytes_, offset) != sign)
            fail("its list of meshes is damaged");
        offsets_.push_back(offset);
        versions_.push_back(at<std::uint16_t>(bytes_, offset + 2));
        if (i > 0) ends_.push_back(offset);
    }
    ends_.push_back(list);
}

Mesh SerializedFile::mesh(std::size_t index) const
{
    const std::size_t first = offsets_[index] + header_bytes;
    Inflated in(file_, index, bytes_.data() + first, ends_[index] - first);
    const auto flags = in.value<std::uint32_t>();
    Mesh mesh;
    if (versions_[index] >= 4)
        while (const char c = in.value<char>())
            if (mesh.name.size() < 1000) mesh.name += c;
    const auto vertices = in.value<std::uint64_t>(), triangles = in.value<std::uint64_t>();
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max() / 3;
    if (vertices > most || triangles > most) in.fail("has more vertices or triangles than are supported");
    if (flags & is_double)
        read_vertices<double>(in, flags, vertices, mesh);
    else
        read_vertices<float>(in, flags, vertices, mesh);
    mesh.indices = in.values<std::uint32_t>(3 * triangles);
    for (std::uint32_t i : mesh.indices)
        if (i >= vertices) in.fail(fmt::format("has a triangle with vertex {}, but only {} vertices", i, vertices));
    return mesh;
}

}  // namespace fathom::mitsuba
