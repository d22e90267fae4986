// SPDX-License-Identifier: Apache-2.0
#include <ImfChannelList.h>
#include <ImfStringAttribute.h>
#include <ImfVersion.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <algorithm>
#include <cstring>

#include "base/large_memory.h"
#include "base/output_file.h"
#include "fathom/error.h"
#include "fathom/film_file.h"
#include "film/file/format.h"
#include "film/file/packing.h"
#include "film/film_data.h"
#include "image/codecs/exr_parts.h"

namespace fathom {

namespace {

using namespace film_format;

/// OpenEXR output stream to memory.
class MemoryOutput : public Imf::OStream {
public:
    MemoryOutput() : Imf::OStream("film") {}

    void write(const char from[], int size) override { bytes.insert(bytes.end(), from, from + size); }
    std::uint64_t tellp() override { return bytes.size(); }
    void seekp(std::uint64_t) override { throw Error("", "", "headers are written sequentially"); }

    std::vector<unsigned char> bytes;
};

bool has_long_names(const Imf::Header& header)
{
    constexpr std::size_t short_name = 31;
    for (auto a = header.begin(); a != header.end(); ++a)
        if (std::strlen(a.name()) > short_name) return true;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        if (std::strlen(c.name()) > short_name) return true;
    return false;
}

std::vector<unsigned char> header_bytes(const Imf::Header& header)
{
    MemoryOutput out;
    const std::uint32_t start[] = {std::uint32_t(Imf::MAGIC), has_long_names(header) ? 2u | Imf::LONG_NAMES_FLAG : 2u};
    out.write(reinterpret_cast<const char*>(start), sizeof start);
    header.writeTo(out);
    return std::move(out.bytes);
}

void add_attributes(Imf::Header& header, const Film::Data& film, const Packing& packing)
{
    const auto add = [&](const char* name, const std::string& value) {
        header.insert(name, Imf::StringAttribute(value));
    };
    add(version_attribute, version);
    add(key_attribute, film.key.text());
    add(samples_attribute, text_of(film.samples));
    add(dropped_attribute, fmt::format("{}", film.dropped));
    add(packing_attribute, packing.text());
    add(checksum_attribute, std::string(checksum_digits, '0'));
}

/// Writes the scanlines of a film file directly: OpenEXR would make three copies in one thread, and the sums of a 4K
/// film with all layers take 2 GB.
class LineWriter {
public:
    LineWriter(const Film::Data& film, const Packing& packing, const ExrChannels& picture)
        : film_(film), packing_(packing), picture_(picture)
    {
    }

    /// Writes the channels of a scanline, sorted by name.
    void write(std::size_t y, unsigned char* to) const
    {
        const auto width = std::size_t(film_.width);
        bool sums_are_written = false;
        const Imf::ChannelList& channels = picture_.header.channels();
        for (auto c = channels.begin(); c != channels.end(); ++c) {
            const ExrChannels::Channel* const channel = find(c.name());
            if (channel) {
                copy(*channel, y, to);
                to += width * value_size(channel->type);
            } else if (!sums_are_written) {
                write_sums(y, to);
                to += width * std::size_t(packing_.words()) * sizeof(std::uint32_t);
                sums_are_written = true;
            }
        }
    }

private:
    const ExrChannels::Channel* find(const std::string& name) const
    {
        const auto found = std::find_if(picture_.channels.begin(), picture_.channels.end(),
                                        [&](const ExrChannels::Channel& channel) { return channel.name == name; });
        return found == picture_.channels.end() ? nullptr : &*found;
    }
    void copy(const ExrChannels::Channel& channel, std::size_t y, unsigned char* to) const
    {
        const auto width = std::size_t(film_.width);
        const char* from = channel.first + y * width * channel.stride;
        // A constant size lets the compiler inline the copy instead of calling memcpy for each value.
        const auto copy_values = [&](auto size) {
            for (std::size_t x = 0; x < width; ++x, from += channel.stride, to += size) std::memcpy(to, from, size);
        };
        if (value_size(channel.type) == 2)
            copy_values(std::integral_constant<std::size_t, 2>());
        else
            copy_values(std::integral_constant<std::size_t, 4>());
    }
    /// Packs blocks of pixels and distributes their words to the channels while they are in the cache.
    void write_sums(std::size_t y, unsigned char* to) const
    {
        constexpr std::size_t block = 64, word = sizeof(std::uint32_t);
        const auto width = std::size_t(film_.width), words = std::size_t(packing_.words());
        const std::size_t stride = packing_.stride();
        std::vector<unsigned char> packed(block * stride);
        std::vector<std::uint32_t> last;
        for (std::size_t x = 0; x < width; x += block) {
            const std::size_t count = std::min(block, width - x);
            packing_.pack(pixels(y * width + x, count, last), count, packed.data());
            for (std::size_t w = 0; w < words; ++w) {
                unsigned char* const plane = to + (w * width + x) * word;
                for (std::size_t i = 0; i < count; ++i)
                    std::memcpy(plane + i * word, &packed[i * stride + w * word], word);
            }
        }
    }

    /// Pointer to some pixels that is readable past their end: the last pixels of the film are copied to a padded
    /// buffer.
    const std::uint32_t* pixels(std::size_t first, std::size_t count, std::vector<std::uint32_t>& copy) const
    {
        const auto pixel = std::size_t(film_.layout.words);
        if ((first + count) * pixel < film_.words.size()) return film_.pixel(first);
        copy.assign(film_.pixel(first), film_.pixel(first) + count * pixel);
        copy.resize(copy.size() + Packing::slack / sizeof(std::uint32_t));
        return copy.data();
    }

    const Film::Data& film_;
    const Packing& packing_;
    const ExrChannels& picture_;
};

}  // namespace

struct FilmSnapshot::Data {
    LargeArray<unsigned char> bytes;  ///< at least `size` bytes
    std::size_t size = 0;

    void reserve(std::size_t wanted)
    {
        size = wanted;
        // The margin lets later snapshots reuse the memory when sums of more samples need another byte.
        if (bytes.size() < wanted) bytes = {}, bytes = LargeArray<unsigned char>(wanted + wanted / 16);
    }
};

FilmSnapshot::FilmSnapshot() : data_(std::make_unique<Data>()) {}
FilmSnapshot::FilmSnapshot(FilmSnapshot&&) noexcept = default;
FilmSnapshot& FilmSnapshot::operator=(FilmSnapshot&&) noexcept = default;
FilmSnapshot::~FilmSnapshot() = default;

std::size_t FilmSnapshot::size_bytes() const
{
    return data_->size;
}

void FilmSnapshot::take(const Film& film, const Image& picture, const WriteOptions& options)
{
    const Film::Data& data = film.data();
    if (picture.width != data.width || picture.height != data.height)
        throw Error("", "", "the image does not have the film's size");
    const Packing packing(data);
    ExrChannels channels(picture, options);
    for (const ExrChannels::Channel& channel : channels.channels)
        if (channel.name.rfind("sums.", 0) == 0)
            throw Error("", channel.name, "a layer of the image has a name that is reserved for the film's sums");
    channels.header.compression() = Imf::NO_COMPRESSION;
    add_attributes(channels.header, data, packing);
    for (int word = 0; word < packing.words(); ++word)
        channels.header.channels().insert(sums_channel(word), Imf::Channel(Imf::UINT));

    std::vector<unsigned char> start = header_bytes(channels.header);
    const auto height = std::size_t(data.height);
    const std::size_t line = line_header_bytes + line_bytes(channels.header);
    const std::size_t first_line = start.size() + height * sizeof(std::uint64_t);
    for (std::size_t y = 0; y < height; ++y) {
        const std::uint64_t place = first_line + y * line;
        const auto* const bytes = reinterpret_cast<const unsigned char*>(&place);
        start.insert(start.end(), bytes, bytes + sizeof place);
    }
    data_->reserve(first_line + height * line);

    const LineWriter writer(data, packing, channels);
    std::vector<std::uint64_t> checksums(height);
    tbb::parallel_for(std::size_t(0), height, [&](std::size_t y) {
        unsigned char* const to = data_->bytes.data() + first_line + y * line;
        const std::int32_t numbers[] = {std::int32_t(y), std::int32_t(line - line_header_bytes)};
        std::memcpy(to, numbers, sizeof numbers);
        writer.write(y, to + line_header_bytes);
        checksums[y] = line_checksum(to, line);
    });
    const std::string checksum = file_checksum(start, checksums);
    std::copy(checksum.begin(), checksum.end(), start.begin() + std::ptrdiff_t(checksum_offset(start)));
    std::copy(start.begin(), start.end(), data_->bytes.data());
}

void FilmSnapshot::write(const std::filesystem::path& file, const std::filesystem::path& previous) const
{
    OutputFile output(file);
    output.write_whole(data_->bytes.data(), data_->size);
    output.commit(previous);
}

void write_film(const std::filesystem::path& file, const Film& film, const Image& picture, const WriteOptions& options)
{
    try {
        FilmSnapshot snapshot;
        snapshot.take(film, picture, options);
        snapshot.write(file);
    } catch (const std::bad_alloc&) {
        throw Error(file.string(), "", "can't write: not enough memory for the film's sums");
    } catch (const Error& error) {
        throw Error(file.string(), error.place(), error.message());
    }
}

}  // namespace fathom
