// SPDX-License-Identifier: Apache-2.0
#include "dataset/npz_file.h"

#include <fmt/format.h>
#include <zlib.h>
#include <cerrno>
#include <cstring>

#include "fathom/error.h"

namespace fathom::cli {

namespace {

constexpr std::uint64_t max_zip_bytes = 0xfffffffeu;

void put(std::string& bytes, std::uint64_t number, int size)
{
    for (int i = 0; i < size; ++i) bytes += char(number >> (8 * i) & 0xff);
}

/// The header of a .npy file (NumPy's format 1.0), padded to a multiple of 64 bytes.
std::string npy_header(const std::string& description, const std::vector<std::size_t>& shape)
{
    std::string text = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}{}), }}", description,
                                   fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
    while ((10 + text.size() + 1) % 64 != 0) text += ' ';
    text += '\n';
    std::string header("\x93NUMPY\x01\x00", 8);
    put(header, text.size(), 2);
    return header + text;
}

/// A raw deflate stream, at a level that costs less time than rendering noise away.
std::string deflated(const std::string& bytes)
{
    z_stream stream{};
    if (deflateInit2(&stream, 1, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
    std::string result(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = uInt(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(result.data());
    stream.avail_out = uInt(result.size());
    ::deflate(&stream, Z_FINISH);
    result.resize(stream.total_out);
    deflateEnd(&stream);
    return result;
}

}  // namespace

NpzFile::NpzFile(const std::filesystem::path& file) : name_(file.string()), stream_(file, std::ios::binary)
{
    if (!stream_) throw Error(name_, "", std::string("can't write: ") + std::strerror(errno));
}

void NpzFile::add(const std::string& name, const std::string& description, const std::vector<std::size_t>& shape,
                  const void* bytes, std::size_t size)
{
    std::string content = npy_header(description, shape);
    content.append(static_cast<const char*>(bytes), size);
    if (content.size() > max_zip_bytes) throw Error(name_, name, "an array of 4 GB or more doesn't fit");
    const std::string packed = deflated(content);
    const auto checksum = std::uint32_t(crc32(0, reinterpret_cast<const Bytef*>(content.data()), uInt(content.size())));
    entries_.push_back({name + ".npy", checksum, std::uint32_t(packed.size()), std::uint32_t(content.size()),
                        std::uint32_t(position_)});
    const Entry& e = entries_.back();
    // Local header: signature, version 2.0, flags, deflate, time and date (1980-01-01), sizes, name.
    std::string header("PK\x03\x04", 4);
    put(header, 20, 2), put(header, 0, 2), put(header, 8, 2), put(header, 0, 2), put(header, 0x21, 2);
    put(header, e.checksum, 4), put(header, e.stored, 4), put(header, e.size, 4);
    put(header, e.name.size(), 2), put(header, 0, 2);
    write(header + e.name);
    write(packed);
}

void NpzFile::finish()
{
    const std::uint64_t begin = position_;
    for (const Entry& e : entries_) {
        std::string header("PK\x01\x02", 4);
        put(header, 20, 2), put(header, 20, 2), put(header, 0, 2), put(header, 8, 2), put(header, 0, 2);
        put(header, 0x21, 2), put(header, e.checksum, 4), put(header, e.stored, 4), put(header, e.size, 4);
        put(header, e.name.size(), 2), put(header, 0, 2), put(header, 0, 2), put(header, 0, 2), put(header, 0, 2);
        put(header, 0, 4), put(header, e.offset, 4);
        write(header + e.name);
    }
    std::string end("PK\x05\x06", 4);
    put(end, 0, 2), put(end, 0, 2), put(end, entries_.size(), 2), put(end, entries_.size(), 2);
    put(end, position_ - begin, 4), put(end, begin, 4), put(end, 0, 2);
    write(end);
    stream_.close();
    if (!stream_) throw Error(name_, "", std::string("can't write: ") + std::strerror(errno));
}

void NpzFile::write(const std::string& bytes)
{
    position_ += bytes.size();
    if (position_ > max_zip_bytes) throw Error(name_, "", "arrays of 4 GB or more don't fit into a file");
    stream_.write(bytes.data(), std::streamsize(bytes.size()));
    if (!stream_) throw Error(name_, "", std::string("can't write: ") + std::strerror(errno));
}

}  // namespace fathom::cli
