// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <utility>

#include "base/output_file.h"
#include "fathom/error.h"
#include "fathom/image.h"
#include "fathom/memory.h"
#include "image/codecs/avif_library.h"
#include "image/codecs/codecs.h"

namespace fathom {

namespace fs = std::filesystem;

namespace {

enum class Format { exr, png, jpeg, webp, avif, hdr };

/// format  overrides the extension of the file if not empty
Format output_format(const fs::path& file, const std::string& format)
{
    std::string extension = format.empty() ? file.extension().string() : "." + format;
    for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
    if (extension == ".exr") return Format::exr;
    if (extension == ".png") return Format::png;
    if (extension == ".jpg" || extension == ".jpeg") return Format::jpeg;
    if (extension == ".webp") return Format::webp;
    if (extension == ".avif") return Format::avif;
    if (extension == ".hdr") return Format::hdr;
    throw Error(file.string(), "",
                fmt::format("can't write {}: the supported formats are .exr, .png, .jpg, .webp, .avif and .hdr",
                            extension.empty() ? "an image without an extension" : "'" + extension + "'"));
}

/// The largest width and height that the format or its library supports.
int largest_side(Format format)
{
    switch (format) {
        case Format::jpeg:
            return 65500;
        case Format::webp:
            return 16383;
        case Format::avif:
            return 16384;  // libavif refuses to read images of more pixels than the square of this
        case Format::png:
            return 1000000;
        default:
            return 1 << 24;
    }
}

void check_format_size(const fs::path& file, Format format, int width, int height)
{
    if (std::max(width, height) > largest_side(format))
        throw Error(file.string(), "",
                    fmt::format("this format supports up to {} pixels per side, but the image has {}x{}",
                                largest_side(format), width, height));
}

void check_consistent(const fs::path& file, const Image& image)
{
    const std::size_t pixels = std::size_t(std::max(image.width, 0)) * std::size_t(std::max(image.height, 0));
    bool consistent = pixels > 0 && !image.layers.empty();
    for (const Image::Layer& layer : image.layers)
        consistent = consistent && !layer.channels.empty() && layer.pixels.size() == pixels * layer.channels.size();
    for (const Image::UintChannel& channel : image.uint_channels)
        consistent = consistent && channel.values.size() == pixels;
    if (!consistent) throw Error(file.string(), "", "can't write an empty image, or layers of a different size");
}

std::string in_gigabytes(double bytes)
{
    return fmt::format("{:.1f} GB", bytes / 1e9);
}

bool begins_with(const EncodedImage& file, const char* magic, std::size_t size, std::size_t at = 0)
{
    return file.size >= at + size && std::memcmp(file.bytes + at, magic, size) == 0;
}

Picture decode(const EncodedImage& file)
{
    if (file.size == 0) throw Error(file.name, "", "the file is empty");
    if (begins_with(file, "\x76\x2f\x31\x01", 4)) return read_exr(file);
    if (begins_with(file, "\x89PNG", 4)) return read_png(file);
    if (begins_with(file, "\xff\xd8\xff", 3)) return read_jpeg(file);
    if (begins_with(file, "RIFF", 4) && begins_with(file, "WEBP", 4, 8)) return read_webp(file);
    if (begins_with(file, "ftyp", 4, 4) && is_avif(file)) return read_avif(file);
    if (begins_with(file, "#?", 2)) return read_hdr(file);
    if (is_pfm(file)) return read_pfm(file);
    if (begins_with(file, "\xabKTX 20\xbb", 8)) return read_ktx2(file);
    return read_stb(file);
}

/// Returns read() with every exception converted to Error.
template <class Read>
auto reading(const std::string& name, Read read)
{
    try {
        return read();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(name, "", "the image needs more memory than is available");
    } catch (const std::exception& error) {
        throw Error(name, "", error.what());
    }
}

Image as_image(Picture&& picture, const std::string& name, std::uint64_t memory_limit)
{
    if (auto* const image = std::get_if<Image>(&picture)) return std::move(*image);
    return reading(name, [&] { return to_image(std::get<ByteImage>(picture), name, memory_limit); });
}

}  // namespace

void check_size(const EncodedImage& file, std::uint64_t width, std::uint64_t height, std::uint64_t bytes_per_pixel)
{
    const std::string& name = file.name;
    if (width == 0 || height == 0) throw Error(name, "", fmt::format("the image has {}x{} pixels", width, height));
    if (width > 0x7fffffff || height > 0x7fffffff)
        throw Error(name, "", fmt::format("an image of {}x{} pixels is too large", width, height));
    if (file.measured) {
        *file.measured = {width, height, bytes_per_pixel};
        throw Measured();
    }
    const double bytes = double(width) * double(height) * double(bytes_per_pixel);
    if (bytes > double(file.memory_limit))
        throw Error(name, "",
                    fmt::format("an image of {}x{} pixels needs {} of memory, {} are available", width, height,
                                in_gigabytes(bytes), in_gigabytes(double(file.memory_limit))));
    if (bytes > double(available_memory_bytes()))
        throw Error(name, "",
                    fmt::format("an image of {}x{} pixels needs {} of memory, {}", width, height, in_gigabytes(bytes),
                                available_memory_text()));
}

Image make_image(int width, int height, int channels)
{
    static const std::vector<std::string> names[] = {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
    Image image;
    image.width = width;
    image.height = height;
    image.layers.push_back({"", names[channels - 1],
                            std::vector<float>(std::size_t(width) * std::size_t(height) * std::size_t(channels))});
    return image;
}

void check_output(const fs::path& file, int width, int height, const std::string& format_name)
{
    const Format format = output_format(file, format_name);
    check_format_size(file, format, width, height);
    if (format == Format::avif) avif_library();
    // Only an attempt to write shows whether it is possible: permissions, read-only file systems and quotas all matter.
    OutputFile attempt(file);
}

void write_image(const fs::path& file, const Image& image, const WriteOptions& options)
{
    const Format format = output_format(file, options.format);
    check_consistent(file, image);
    check_format_size(file, format, image.width, image.height);
    try {
        OutputFile output(file);
        switch (format) {
            case Format::exr:
                write_exr(output, image, options);
                break;
            case Format::png:
                output.write(encode_png(image, options));
                break;
            case Format::jpeg:
                output.write(encode_jpeg(image, options));
                break;
            case Format::webp:
                output.write(encode_webp(image, options));
                break;
            case Format::avif:
                output.write(encode_avif(image, options));
                break;
            case Format::hdr:
                output.write(encode_hdr(image));
                break;
        }
        output.commit();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(file.string(), "", "can't write: not enough memory to encode the image");
    } catch (const std::exception& error) {
        throw Error(file.string(), "", fmt::format("can't write: {}", error.what()));
    }
}

std::vector<unsigned char> encode_png_image(const Image& image, const WriteOptions& options)
{
    check_consistent("", image);
    check_format_size("", Format::png, image.width, image.height);
    return encode_png(image, options);
}

Picture read_picture(const fs::path& file, std::uint64_t memory_limit)
{
    const std::string name = file.string();
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) throw Error(name, "", "there is no such file");
    if (fs::is_directory(status)) throw Error(name, "", "this is a folder, not an image");
    if (!fs::is_regular_file(status)) throw Error(name, "", "this is a device or a pipe, not an image");
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error(name, "", "can't be read: " + std::generic_category().message(errno));
    std::vector<char> bytes;
    try {
        const std::uintmax_t size = fs::file_size(file, error);
        if (error) throw Error(name, "", "can't be read: " + error.message());
        if (size > std::min(available_memory_bytes(), memory_limit))
            throw Error(name, "", "the file is larger than the available memory");
        bytes.resize(size);
    } catch (const std::bad_alloc&) {
        throw Error(name, "", "the file is larger than the available memory");
    }
    if (!in.read(bytes.data(), std::streamsize(bytes.size()))) throw Error(name, "", "can't be read to the end");
    return read_picture(name, bytes.data(), bytes.size(), memory_limit);
}

Picture read_picture(const std::string& name, const void* bytes, std::size_t size, std::uint64_t memory_limit)
{
    return reading(name, [&] { return decode({name, static_cast<const unsigned char*>(bytes), size, memory_limit}); });
}

std::optional<PictureSize> measure_picture(const std::string& name, const void* bytes, std::size_t size)
{
    PictureSize measured;
    try {
        decode({name, static_cast<const unsigned char*>(bytes), size, std::numeric_limits<std::uint64_t>::max(),
                &measured});
    } catch (const Measured&) {
        return measured;
    } catch (const std::exception&) {
        // A reader of the whole file reports the error.
    }
    return {};
}

std::optional<PictureSize> measure_picture(const fs::path& file)
{
    // Most formats have the size in their first bytes. Reading whole files twice would be slow on network file systems.
    constexpr std::uintmax_t head = 1 << 16;
    std::error_code error;
    if (!fs::is_regular_file(file, error)) return {};
    const std::uintmax_t all = fs::file_size(file, error);
    std::ifstream in(file, std::ios::binary);
    std::vector<char> bytes;
    for (const std::uintmax_t size : {std::min(all, head), all}) {
        if (error || (size > head && size > available_memory_bytes())) return {};
        const std::size_t before = bytes.size();
        bytes.resize(size);
        if (!in.read(bytes.data() + before, std::streamsize(size - before))) return {};
        if (const auto measured = measure_picture(file.string(), bytes.data(), bytes.size())) return measured;
        if (size == all) return {};
    }
    return {};
}

namespace {

std::optional<std::array<std::uint64_t, 2>> width_and_height(const std::optional<PictureSize>& size)
{
    if (!size) return {};
    return {{size->width, size->height}};
}

}  // namespace

std::optional<std::array<std::uint64_t, 2>> image_size(const fs::path& file)
{
    return width_and_height(measure_picture(file));
}
std::optional<std::array<std::uint64_t, 2>> image_size(const std::string& name, const void* bytes, std::size_t size)
{
    return width_and_height(measure_picture(name, bytes, size));
}

Image read_image(const fs::path& file, std::uint64_t memory_limit)
{
    const std::string name = file.string();
    return as_image(read_picture(file, memory_limit), name, memory_limit);
}

Image read_image(const std::string& name, const void* bytes, std::size_t size, std::uint64_t memory_limit)
{
    return as_image(read_picture(name, bytes, size, memory_limit), name, memory_limit);
}

}  // namespace fathom
