#include <fmt/format.h>
#include <charconv>

#include "fathom/error.h"
#include "fathom/render.h"

namespace fathom {

namespace {

constexpr const char* samples_attribute = "fathom.sums.samples";
constexpr const char* dropped_attribute = "fathom.sums.dropped";
constexpr const char* key_attribute = "fathom.sums.key";
constexpr const char* words_attribute = "fathom.sums.words_per_pixel";

std::string channel_name(int word)
{
    return fmt::format("sums.{:03}", word);
}

const std::string& attribute(const Image& image, const std::string& file, const char* name)
{
    const auto found = image.attributes.find(name);
    if (found == image.attributes.end())
        throw Error(file, "", fmt::format("holds no sums to merge (no '{}'): render it with --mergeable", name));
    return found->second;
}

/// The number that `text` begins with, which is cut off it.
std::uint64_t take_number(std::string_view& text, const std::string& file, const char* name)
{
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc()) throw Error(file, name, fmt::format("expected a number, found '{}'", text));
    text.remove_prefix(std::size_t(end - text.data()));
    return number;
}

std::uint64_t number_attribute(const Image& image, const std::string& file, const char* name)
{
    std::string_view text = attribute(image, file, name);
    const std::uint64_t number = take_number(text, file, name);
    if (!text.empty()) throw Error(file, name, fmt::format("expected a number, found '{}' after it", text));
    return number;
}

}  // namespace

void store_sums(const Film::Sums& sums, Image& image)
{
    const std::size_t pixels = std::size_t(sums.width) * std::size_t(sums.height);
    const std::size_t words = std::size_t(sums.words_per_pixel);
    if (sums.width != image.width || sums.height != image.height || sums.words.size() != pixels * words)
        throw Error("", "", "the sums of a film are not of the picture's size");
    for (std::size_t word = 0; word < words; ++word) {
        Image::UintChannel channel{channel_name(int(word)), std::vector<std::uint32_t>(pixels)};
        for (std::size_t i = 0; i < pixels; ++i) channel.values[i] = sums.words[i * words + word];
        image.uint_channels.push_back(std::move(channel));
    }
    std::string samples;
    for (const SampleRange& range : sums.samples)
        samples += fmt::format("{}{}:{}", samples.empty() ? "" : ",", range.first, range.second);
    image.attributes[samples_attribute] = samples;
    image.attributes[dropped_attribute] = fmt::format("{}", sums.dropped);
    image.attributes[key_attribute] = sums.key;
    image.attributes[words_attribute] = fmt::format("{}", words);
}

Film::Sums load_sums(const Image& image, const std::string& file)
{
    Film::Sums sums;
    sums.width = image.width;
    sums.height = image.height;
    sums.key = attribute(image, file, key_attribute);
    sums.dropped = number_attribute(image, file, dropped_attribute);
    const std::uint64_t words = number_attribute(image, file, words_attribute);
    if (words > image.uint_channels.size())
        throw Error(file, words_attribute,
                    fmt::format("{} words a pixel, but {} channels of integers", words, image.uint_channels.size()));
    sums.words_per_pixel = int(words);

    std::string_view ranges = attribute(image, file, samples_attribute);
    while (!ranges.empty()) {
        SampleRange range;
        range.first = take_number(ranges, file, samples_attribute);
        if (ranges.empty() || ranges.front() != ':')
            throw Error(file, samples_attribute, "expected ranges as 0:16,32:48");
        ranges.remove_prefix(1);
        range.second = take_number(ranges, file, samples_attribute);
        const bool in_order = sums.samples.empty() || sums.samples.back().second < range.first;
        if (range.first >= range.second || !in_order)
            throw Error(file, samples_attribute,
                        fmt::format("range {}:{} is empty or out of order", range.first, range.second));
        sums.samples.push_back(range);
        if (!ranges.empty()) {
            if (ranges.front() != ',') throw Error(file, samples_attribute, "expected ranges as 0:16,32:48");
            ranges.remove_prefix(1);
        }
    }

    const std::size_t pixels = std::size_t(image.width) * std::size_t(image.height);
    sums.words.resize(pixels * words);
    for (std::size_t word = 0; word < words; ++word) {
        const Image::UintChannel* channel = nullptr;
        for (const Image::UintChannel& candidate : image.uint_channels)
            if (candidate.name == channel_name(int(word))) channel = &candidate;
        if (!channel) throw Error(file, "", fmt::format("channel '{}' is missing", channel_name(int(word))));
        for (std::size_t i = 0; i < pixels; ++i) sums.words[i * words + word] = channel->values[i];
    }
    return sums;
}

}  // namespace fathom
