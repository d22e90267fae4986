// SPDX-License-Identifier: Apache-2.0
#include "film/file/packing.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <bit>
#include <charconv>
#include <cstring>
#include <type_traits>

#include "fathom/error.h"

namespace fathom {

static_assert(std::endian::native == std::endian::little, "numbers are packed in memory order");

namespace {

using Wide = unsigned __int128;
using SignedWide = __int128;

constexpr int sum_words = ExactSum::words, square_words_each = ExactSquareSum::words, id_words = 1;

std::vector<PackedNumber> numbers_of(const FilmLayout& layout)
{
    std::vector<PackedNumber> numbers;
    const auto add = [&](int count, int words) {
        for (int i = 0; i < count; ++i) {
            const int word = numbers.empty() ? 0 : numbers.back().word + numbers.back().words;
            numbers.push_back({word, words});
        }
    };
    add(3, sum_words);
    add(3, square_words_each);
    add(layout.sums, sum_words);
    if (layout.ids >= 0) add(3, id_words);
    if (layout.splats >= 0) add(3, square_words_each);
    return numbers;
}

constexpr bool is_signed(int words)
{
    return words == sum_words;
}

/// Loads a number of 1, 3 or 4 words; sums (3 words) are sign-extended.
template <int words>
Wide load(const std::uint32_t* number)
{
    std::uint64_t low = 0, high = 0;
    std::memcpy(&low, number, words > 1 ? 8 : 4);
    if (words == 3) high = std::uint64_t(std::int64_t(std::int32_t(number[2])));
    if (words == 4) std::memcpy(&high, number + 2, 8);
    return Wide(high) << 64 | low;
}

template <int words>
void store(std::uint32_t* number, Wide value)
{
    const auto low = std::uint64_t(value);
    std::memcpy(number, &low, words > 1 ? 8 : 4);
    if (words == 3) number[2] = std::uint32_t(value >> 64);
    const auto high = std::uint64_t(value >> 64);
    if (words == 4) std::memcpy(number + 2, &high, 8);
}

/// Calls f with the number of words as a compile-time constant.
template <class F>
void with_words(int words, F&& f)
{
    if (words == sum_words)
        f(std::integral_constant<int, sum_words>());
    else if (words == square_words_each)
        f(std::integral_constant<int, square_words_each>());
    else
        f(std::integral_constant<int, id_words>());
}

/// byte_count: bytes up to the highest set bit, plus room for a sign bit. lowest_byte: index of the lowest nonzero
/// byte.
int byte_count(Wide bits)
{
    const auto high = std::uint64_t(bits >> 64);
    return (high != 0 ? 64 + std::bit_width(high) : std::bit_width(std::uint64_t(bits))) / 8 + 1;
}
int lowest_byte(Wide bits)
{
    const auto low = std::uint64_t(bits);
    return (low != 0 ? std::countr_zero(low) : 64 + std::countr_zero(std::uint64_t(bits >> 64))) / 8;
}

/// Combines the bits that of(first pixel, count) returns for blocks of pixels by bitwise or, whose result does not
/// depend on the order.
template <class Bits, class Of>
Bits joined(const Film::Data& film, const Bits& none, const Of& of)
{
    const std::size_t pixels = std::size_t(film.width) * std::size_t(film.height);
    const auto join = [](Bits a, const Bits& b) {
        for (std::size_t i = 0; i < a.size(); ++i) a[i] |= b[i];
        return a;
    };
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, pixels, 1 << 12), none,
        [&](const auto& range, const Bits& bits) { return join(of(range.begin(), range.size()), bits); }, join);
}

/// The bits that are set in any pixel, for each word of a pixel.
std::vector<std::uint32_t> set_bits(const Film::Data& film)
{
    const auto words = std::size_t(film.layout.words);
    const std::vector<std::uint32_t> none(words);
    return joined(film, none, [&](std::size_t first, std::size_t count) {
        std::vector<std::uint32_t> bits(words);
        const std::uint32_t* pixel = film.pixel(first);
        for (std::size_t i = 0; i < count; ++i, pixel += words)
            for (std::size_t w = 0; w < words; ++w) bits[w] |= pixel[w];
        return bits;
    });
}

/// The bits that differ from the sign bit in any pixel, for each sum.
std::vector<Wide> magnitude_bits(const Film::Data& film, const std::vector<const PackedNumber*>& sums)
{
    const std::vector<Wide> none(sums.size(), 0);
    return joined(film, none, [&](std::size_t first, std::size_t count) {
        std::vector<Wide> bits = none;
        for (std::size_t i = first; i < first + count; ++i)
            for (std::size_t n = 0; n < sums.size(); ++n) {
                const Wide value = load<sum_words>(film.pixel(i) + sums[n]->word);
                bits[n] |= value ^ Wide(SignedWide(value) >> 127);
            }
        return bits;
    });
}

/// Copies fixed-size chunks: bytes past a number's end are overwritten by the next number.
template <std::size_t size>
void pack_number(const unsigned char* from, std::size_t from_stride, std::size_t count, unsigned char* to,
                 std::size_t to_stride)
{
    for (std::size_t i = 0; i < count; ++i, from += from_stride, to += to_stride) std::memcpy(to, from, size);
}

template <int words>
void unpack_number(const PackedNumber& n, const unsigned char* from, std::size_t from_stride, std::size_t count,
                   std::uint32_t* number, std::size_t number_stride)
{
    const int unused = 128 - 8 * n.bytes;
    for (std::size_t i = 0; i < count; ++i, number += number_stride, from += from_stride) {
        Wide value = 0;
        std::memcpy(&value, from, sizeof value);
        value <<= unused;
        value = is_signed(words) ? Wide(SignedWide(value) >> unused) : value >> unused;
        store<words>(number, value << (8 * n.first));
    }
}

/// unpack_number() for the most common case, numbers of at most 8 bytes that start at byte 0; it takes a third of the
/// time.
template <int words>
void unpack_short_number(const PackedNumber& n, const unsigned char* from, std::size_t from_stride, std::size_t count,
                         std::uint32_t* number, std::size_t number_stride)
{
    const int unused = 64 - 8 * n.bytes;
    for (std::size_t i = 0; i < count; ++i, number += number_stride, from += from_stride) {
        std::int64_t value = 0;
        std::memcpy(&value, from, sizeof value);
        value = std::int64_t(std::uint64_t(value) << unused);
        const Wide whole = is_signed(words) ? Wide(SignedWide(value >> unused)) : Wide(std::uint64_t(value) >> unused);
        store<words>(number, whole);
    }
}

}  // namespace

Packing::Packing(const Film::Data& film)
    : numbers_(numbers_of(film.layout)), pixel_words_(std::size_t(film.layout.words))
{
    const std::vector<std::uint32_t> words = set_bits(film);
    std::vector<const PackedNumber*> negative;
    for (PackedNumber& number : numbers_) {
        Wide set = 0;
        for (int i = 0; i < number.words; ++i)
            set |= Wide(words[std::size_t(number.word) + std::size_t(i)]) << (32 * i);
        if (set == 0) continue;
        number.first = lowest_byte(set);
        // The highest bit of a sum is its sign; numbers without a sign may fill their bytes.
        number.bytes = byte_count(is_signed(number.words) ? set : set >> 1) - number.first;
        if (is_signed(number.words) && (set >> (32 * number.words - 1) & 1) != 0) negative.push_back(&number);
    }
    // If a pixel has a negative sum, set bits do not bound the length of the number, but magnitudes do.
    const std::vector<Wide> magnitudes = magnitude_bits(film, negative);
    for (std::size_t n = 0; n < negative.size(); ++n) {
        PackedNumber& number = numbers_[std::size_t(negative[n] - numbers_.data())];
        number.bytes = byte_count(magnitudes[n]) - number.first;
    }
    count_words();
}

Packing::Packing(const FilmLayout& layout, const std::string& text)
    : numbers_(numbers_of(layout)), pixel_words_(std::size_t(layout.words))
{
    const char *at = text.data(), *const end = at + text.size();
    const auto take = [&](int most) {
        int value = -1;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc() || value < 0 || value > most)
            throw Error("", "", "its sums are packed in a way that this version does not support");
        at = next;
        return value;
    };
    const auto expect = [&](char separator) {
        if (at == end || *at != separator)
            throw Error("", "", "its sums are packed in a way that this version does not support");
        ++at;
    };
    for (PackedNumber& number : numbers_) {
        if (&number != &numbers_.front()) expect(',');
        number.first = take(4 * number.words);
        expect('+');
        number.bytes = take(4 * number.words - number.first);
    }
    if (at != end) throw Error("", "", "its sums are packed in a way that this version does not support");
    count_words();
}

std::string Packing::text() const
{
    std::string text;
    for (const PackedNumber& number : numbers_)
        text += fmt::format("{}{}+{}", text.empty() ? "" : ",", number.first, number.bytes);
    return text;
}

void Packing::count_words()
{
    int bytes = 0;
    for (const PackedNumber& number : numbers_) bytes += number.bytes;
    words_ = (bytes + 3) / 4;
}

void Packing::pack(const std::uint32_t* pixels, std::size_t count, unsigned char* packed) const
{
    unsigned char* to = packed;
    for (const PackedNumber& number : numbers_) {
        if (number.bytes == 0) continue;
        const auto* const from = reinterpret_cast<const unsigned char*>(pixels + number.word) + number.first;
        if (number.bytes <= 8)
            pack_number<8>(from, pixel_words_ * 4, count, to, stride());
        else
            pack_number<16>(from, pixel_words_ * 4, count, to, stride());
        to += number.bytes;
    }
    // The padding bytes of the last word are set to 0.
    for (std::size_t i = 0; i < count; ++i, to += stride()) std::memset(to, 0, sizeof(std::uint32_t));
}

void Packing::unpack(const unsigned char* packed, std::size_t count, std::uint32_t* pixels) const
{
    const unsigned char* from = packed;
    for (const PackedNumber& number : numbers_) {
        std::uint32_t* const to = pixels + number.word;
        with_words(number.words, [&](auto words) {
            if (number.bytes == 0)
                for (std::size_t i = 0; i < count; ++i) store<words>(to + i * pixel_words_, 0);
            else if (number.bytes <= 8 && number.first == 0)
                unpack_short_number<words>(number, from, stride(), count, to, pixel_words_);
            else
                unpack_number<words>(number, from, stride(), count, to, pixel_words_);
        });
        from += number.bytes;
    }
}

}  // namespace fathom
