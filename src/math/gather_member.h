// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Gathers of record members by pointer to member: each lane has an index into one array of records.
#include <cstddef>
#include <cstdint>
#include <memory>
#include <type_traits>
#include <vector>

#include "base/large_memory.h"
#include "math/vec3.h"

namespace fathom {
inline namespace FATHOM_LANES {

namespace detail {

/// Offset of a member within its record, in 32-bit words.
template <class Record, class Member>
[[gnu::always_inline]] inline std::size_t word_of(Member Record::* member)
{
    // The union provides storage for a record without constructing one.
    union Room {
        char nothing;
        Record record;
        Room() {}
        ~Room() {}
    } room;
    const auto* const at = reinterpret_cast<const char*>(std::addressof(room.record.*member));
    return std::size_t(at - reinterpret_cast<const char*>(std::addressof(room.record))) / 4;
}

template <class Record>
/// Size of a record in 32-bit words.
inline constexpr std::uint32_t record_words = [] {
    static_assert(std::is_standard_layout_v<Record> && sizeof(Record) % 4 == 0 && alignof(Record) <= 8);
    return std::uint32_t(sizeof(Record) / 4);
}();

}  // namespace detail

/// Loads three consecutive floats from base[at] on as a vector, for the lanes of m; 0 in other lanes.
inline Vec3 gather_vector(const float* base, UInt at, Mask m)
{
    Float row[3];
    gather_row(base, at, m, row);
    return {row[0], row[1], row[2]};
}

/// The first n words of the record of each lane. Lanes outside the mask hold those of record 0, or 0 if the mask is
/// empty.
template <class Record, int n>
struct RecordRow {
    [[gnu::always_inline]] RecordRow(const std::vector<Record>& records, UInt index, Mask m)
    {
        gather_row_or_first(reinterpret_cast<const float*>(records.data()), index * UInt(detail::record_words<Record>),
                            m, word);
    }
    [[gnu::always_inline]] Float get(float Record::* member) const { return word[detail::word_of(member)]; }
    [[gnu::always_inline]] UInt get(std::uint32_t Record::* member) const
    {
        return float_bits(word[detail::word_of(member)]);
    }
    template <class Member>
    [[gnu::always_inline]] UInt get(Member Record::* member, std::uint32_t Member::* part) const
    {
        return float_bits(word[detail::word_of(member) + detail::word_of(part)]);
    }

    Float word[n];
};

/// Gathers a member of records[index] for the lanes of m; 0 in other lanes.
template <class Record>
[[gnu::always_inline]] inline Float gather(const std::vector<Record>& records, float Record::* member, UInt index,
                                           Mask m)
{
    const auto* base = reinterpret_cast<const float*>(records.data());
    return gather(base + detail::word_of(member), index * UInt(detail::record_words<Record>), m);
}
template <class Record>
[[gnu::always_inline]] inline UInt gather(const std::vector<Record>& records, std::uint32_t Record::* member,
                                          UInt index, Mask m)
{
    const auto* base = reinterpret_cast<const std::uint32_t*>(records.data());
    return gather(base + detail::word_of(member), index * UInt(detail::record_words<Record>), m);
}
template <class Record>
[[gnu::always_inline]] inline Vec3 gather(const std::vector<Record>& records, Vec3f Record::* member, UInt index,
                                          Mask m)
{
    const auto* base = reinterpret_cast<const float*>(records.data());
    return gather_vector(base + detail::word_of(member), index * UInt(detail::record_words<Record>), m);
}
/// Gathers a part of a member that is a record itself, for the lanes of m; 0 in other lanes.
template <class Record, class Member, class Part>
    requires std::is_same_v<Part, float> || std::is_same_v<Part, std::uint32_t>
[[gnu::always_inline]] inline auto gather(const std::vector<Record>& records, Member Record::* member,
                                          Part Member::* part, UInt index, Mask m)
{
    const auto* base = reinterpret_cast<const Part*>(records.data());
    return gather(base + detail::word_of(member) + detail::word_of(part), index * UInt(detail::record_words<Record>),
                  m);
}
/// Gathers vectors[index] for the lanes of m; 0 in other lanes.
[[gnu::always_inline]] inline Vec3 gather(const LargeVector<Vec3f>& vectors, UInt index, Mask m)
{
    return gather_vector(reinterpret_cast<const float*>(vectors.data()), index * UInt(3), m);
}

}  // namespace FATHOM_LANES
}  // namespace fathom
