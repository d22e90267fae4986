// SPDX-License-Identifier: Apache-2.0
#include "formats/ply/ply_writer.h"

#include <fmt/format.h>

#include <bit>

#include "base/output_file.h"

namespace fathom {

static_assert(std::endian::native == std::endian::little);

std::string PlyFile::header() const
{
    std::string text = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", count_);
    for (const Column& column : columns_) text += fmt::format("property float {}\n", column.name);
    if (triangles_)
        text += fmt::format("element face {}\nproperty list uchar uint vertex_indices\n", triangles_->size() / 3);
    if (curves_) text += fmt::format("element curve {}\nproperty uint vertices\n", curves_->size());
    return text + "end_header\n";
}

void PlyFile::write(const std::filesystem::path& file) const
{
    OutputFile out(file);
    std::string bytes = header();
    const auto flush = [&](std::size_t most) {
        if (bytes.size() <= most) return;
        out.write(bytes.data(), bytes.size());
        bytes.clear();
    };
    constexpr std::size_t piece = 1 << 20;
    for (std::size_t i = 0; i < count_; ++i) {
        for (const Column& column : columns_) bytes.append(column.data + i * column.stride, sizeof(float));
        flush(piece);
    }
    for (std::size_t i = 0; triangles_ && i + 2 < triangles_->size(); i += 3) {
        bytes += char(3);
        bytes.append(reinterpret_cast<const char*>(triangles_->data() + i), 3 * sizeof(std::uint32_t));
        flush(piece);
    }
    if (curves_) bytes.append(reinterpret_cast<const char*>(curves_->data()), curves_->size() * sizeof(std::uint32_t));
    flush(0);
    out.commit();
}

}  // namespace fathom
