// SPDX-License-Identifier: Apache-2.0
#include "fathom/film_file.h"

#include <ImfChannelList.h>
#include <ImfStringAttribute.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <unistd.h>
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "fathom/error.h"
#include "fathom/memory.h"
#include "film/file/format.h"
#include "film/file/packing.h"
#include "film/film_data.h"
#include "image/codecs/exr_parts.h"

namespace fathom {

namespace {

using namespace film_format;

/// A regular file that any thread may read at any offset.
class InputFile {
public:
    explicit InputFile(const std::filesystem::path& file) : name(file.string())
    {
        // Without O_NONBLOCK, opening a named pipe would wait for a writer.
        descriptor_ = open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
        if (descriptor_ < 0) throw Error(name, "", reason(errno));
        struct stat status{};
        const int found = fstat(descriptor_, &status) == 0 ? 0 : errno;
        if (found == 0 && S_ISREG(status.st_mode)) {
            size = std::uint64_t(status.st_size);
            return;
        }
        close(descriptor_);
        throw Error(name, "", found == 0 ? "this is not a file" : reason(found));
    }
    InputFile(const InputFile&) = delete;
    InputFile& operator=(const InputFile&) = delete;
    ~InputFile() { close(descriptor_); }

    void read(std::uint64_t place, unsigned char* to, std::size_t count) const
    {
        while (count > 0) {
            const ssize_t got = pread(descriptor_, to, count, off_t(place));
            if (got == 0) throw Error(name, "", "the file is truncated");
            if (got < 0 && errno != EINTR) throw Error(name, "", reason(errno));
            if (got < 0) continue;
            to += got, place += std::uint64_t(got), count -= std::size_t(got);
        }
    }

    std::string name;
    std::uint64_t size = 0;

private:
    static std::string reason(int error) { return "can't be read: " + std::generic_category().message(error); }
    int descriptor_ = -1;
};

/// Reads the bytes of the file up to the end of its EXR headers.
std::vector<unsigned char> read_headers(const InputFile& file)
{
    // Headers usually take a few thousand bytes; films with many layers need more.
    constexpr std::uint64_t first_guess = 1 << 16, most = 1 << 26;
    std::vector<unsigned char> bytes;
    for (std::uint64_t size = first_guess;; size *= 8) {
        const std::size_t before = bytes.size();
        bytes.resize(std::min({size, file.size, most}));
        file.read(before, bytes.data() + before, bytes.size() - before);
        if (bytes.size() < 8 || std::memcmp(bytes.data(), "\x76\x2f\x31\x01", 4) != 0)
            throw Error(file.name, "", "this is not a film file: film files are OpenEXR");
        if (const auto end = exr_headers_end(bytes.data(), bytes.size())) {
            bytes.resize(*end);
            return bytes;
        }
        if (bytes.size() < size) throw Error(file.name, "", "the file is truncated or damaged");
    }
}

/// Runs an action and adds the file name to its errors, since the code that handles sums does not know it.
template <class Action>
auto with_file_name(const std::string& file, const char* place, Action action)
{
    try {
        return action();
    } catch (const Error& error) {
        if (!error.file().empty()) throw;
        throw Error(file, error.place().empty() ? place : error.place(), error.message());
    }
}

/// Adds the sums of one scanline to the film; the file stores them channel by channel.
void add_line(const unsigned char* sums, const Packing& packing, Film::Data& film, std::size_t y,
              std::vector<unsigned char>& packed, std::vector<std::uint32_t>& pixels)
{
    constexpr std::size_t block = 64, word = sizeof(std::uint32_t);
    const auto width = std::size_t(film.width), words = std::size_t(packing.words());
    const std::size_t stride = packing.stride(), pixel = std::size_t(film.layout.words);
    packed.resize(block * stride);
    pixels.resize(block * pixel);
    for (std::size_t x = 0; x < width; x += block) {
        const std::size_t count = std::min(block, width - x);
        for (std::size_t w = 0; w < words; ++w)
            for (std::size_t i = 0; i < count; ++i)
                std::memcpy(&packed[i * stride + w * word], sums + (w * width + x + i) * word, word);
        packing.unpack(packed.data(), count, pixels.data());
        for (std::size_t i = 0; i < count; ++i) film.add_pixel(y * width + x + i, &pixels[i * pixel]);
    }
}

}  // namespace

struct FilmFile::Data {
    explicit Data(const std::filesystem::path& path) : file(path) {}

    InputFile file;
    FilmKey key;
    std::vector<SampleRange> samples;
    std::uint64_t dropped = 0;
    std::vector<std::string> channels;
    std::map<std::string, std::string> attributes;
    std::string packing, checksum;
    std::vector<unsigned char> start;  ///< all bytes before the scanlines
    std::size_t line = 0;              ///< bytes per scanline
    std::size_t sums = 0;              ///< offset of the sums within a scanline
    int words = 0;                     ///< words of packed sums per pixel

    void read_start();
    void read_attributes(const Imf::Header& header);
    void read_channels(const Imf::Header& header);
    void read_line(std::size_t y, std::vector<unsigned char>& line_bytes) const;
};

void FilmFile::Data::read_start()
{
    start = read_headers(file);
    const std::string& name = file.name;
    const Imf::Header header = read_exr_header({name, start.data(), start.size(), start.size()});
    read_attributes(header);
    const RenderSettings& settings = key.settings;
    const auto& window = header.dataWindow();
    if (window.min.x != 0 || window.min.y != 0 || window.max.x != settings.width - 1 ||
        window.max.y != settings.height - 1)
        throw Error(
            name, "",
            fmt::format("its image does not have {}x{} pixels, unlike its sums", settings.width, settings.height));
    constexpr unsigned char tiles_parts_deep = 0x1a;
    if (header.compression() != Imf::NO_COMPRESSION || (start[5] & tiles_parts_deep) != 0)
        throw Error(name, "", "another program has rewritten its sums: they must be stored as Fathom wrote them");
    read_channels(header);
    const auto height = std::uint64_t(settings.height);
    line = line_header_bytes + line_bytes(header);
    if (file.size != start.size() + height * (sizeof(std::uint64_t) + line))
        throw Error(name, "", "the file is truncated or damaged");
    const std::size_t headers = start.size();
    start.resize(headers + height * sizeof(std::uint64_t));
    file.read(headers, start.data() + headers, start.size() - headers);
}

void FilmFile::Data::read_attributes(const Imf::Header& header)
{
    for (auto a = header.begin(); a != header.end(); ++a)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
            attributes[a.name()] = text->value();
    const auto take = [&](const char* attribute) {
        const auto found = attributes.find(attribute);
        if (found == attributes.end())
            throw Error(file.name, "",
                        fmt::format("contains no sums to merge (no '{}'): render it with --mergeable", attribute));
        const std::string value = std::move(found->second);
        attributes.erase(found);
        return value;
    };
    if (const std::string written = take(version_attribute); written != version)
        throw Error(file.name, version_attribute,
                    fmt::format("its sums have version {}, this program reads version {}", written, version));
    key = with_file_name(file.name, key_attribute, [&] { return FilmKey::parse(take(key_attribute)); });
    samples = with_file_name(file.name, samples_attribute, [&] { return parse_samples(take(samples_attribute)); });
    dropped = with_file_name(file.name, dropped_attribute, [&] { return parse_number(take(dropped_attribute)); });
    packing = take(packing_attribute);
    checksum = take(checksum_attribute);
}

void FilmFile::Data::read_channels(const Imf::Header& header)
{
    const RenderSettings& settings = key.settings;
    words =
        with_file_name(file.name, packing_attribute, [&] { return Packing(FilmLayout(settings), packing).words(); });
    int found = 0;
    std::size_t place = line_header_bytes;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
        const std::string name = c.name();
        if (c.channel().xSampling != 1 || c.channel().ySampling != 1)
            throw Error(file.name, name, "channels of a film file must have one value per pixel");
        if (found < words && name == sums_channel(found)) {
            if (c.channel().type != Imf::UINT) throw Error(file.name, name, "sums must be integers");
            if (found++ == 0) sums = place;
        } else {
            if (found > 0 && found < words) break;
            channels.push_back(name);
        }
        place += value_size(c.channel().type) * std::size_t(settings.width);
    }
    if (found != words) throw Error(file.name, "", fmt::format("channel '{}' is missing", sums_channel(found)));
}

void FilmFile::Data::read_line(std::size_t y, std::vector<unsigned char>& bytes) const
{
    bytes.resize(line);
    file.read(start.size() + y * line, bytes.data(), line);
    std::int32_t numbers[2];
    std::memcpy(numbers, bytes.data(), sizeof numbers);
    if (numbers[0] != std::int32_t(y) || std::size_t(numbers[1]) != line - line_header_bytes)
        throw Error(file.name, fmt::format("line {}", y), "the file is damaged");
}

FilmFile::FilmFile(const std::filesystem::path& file) : data_(std::make_unique<Data>(file))
{
    try {
        data_->read_start();
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw Error(file.string(), "", error.what());
    }
}
FilmFile::FilmFile(FilmFile&&) noexcept = default;
FilmFile& FilmFile::operator=(FilmFile&&) noexcept = default;
FilmFile::~FilmFile() = default;

const FilmKey& FilmFile::key() const
{
    return data_->key;
}
const std::vector<SampleRange>& FilmFile::samples() const
{
    return data_->samples;
}
std::uint64_t FilmFile::invalid_samples() const
{
    return data_->dropped;
}
const std::vector<std::string>& FilmFile::channels() const
{
    return data_->channels;
}
const std::map<std::string, std::string>& FilmFile::attributes() const
{
    return data_->attributes;
}
std::uint64_t FilmFile::size_bytes() const
{
    return data_->file.size;
}

void FilmFile::add_to(Film& film) const
{
    const Data& from = *data_;
    Film::Data& to = film.data();
    with_file_name(from.file.name, "", [&] { to.register_samples(from.key, from.samples, from.dropped); });
    const Packing packing(to.layout, from.packing);
    struct Buffers {
        std::vector<unsigned char> line, packed;
        std::vector<std::uint32_t> pixels;
    };
    tbb::enumerable_thread_specific<Buffers> buffers;
    std::vector<std::uint64_t> checksums(std::size_t(to.height));
    tbb::parallel_for(std::size_t(0), checksums.size(), [&](std::size_t y) {
        Buffers& b = buffers.local();
        from.read_line(y, b.line);
        checksums[y] = line_checksum(b.line.data(), from.line);
        add_line(b.line.data() + from.sums, packing, to, y, b.packed, b.pixels);
    });
    if (file_checksum(from.start, checksums) != from.checksum)
        throw Error(from.file.name, "", "the file is damaged: its checksum does not match");
}

Film FilmFile::read() const
{
    const RenderSettings& settings = data_->key.settings;
    const double bytes = double(settings.width) * settings.height * 4 * FilmLayout(settings).words;
    if (bytes > double(available_memory_bytes()))
        throw Error(data_->file.name, "",
                    fmt::format("its film needs {:.1f} GB of memory, {}", bytes / 1e9, available_memory_text()));
    Film film(data_->key);
    add_to(film);
    return film;
}

}  // namespace fathom
