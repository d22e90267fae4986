#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "fathom/render.h"

namespace fathom::cli {

/// One of several parts of a render, counted from 1.
struct PartNumber {
    std::uint64_t number = 1, count = 1;
};
/// `3/16`, or `2+1/16` where the first is counted from 0. Throws UsageError.
PartNumber parse_part(const std::string& text);

/// The samples of a part of so many: ranges that differ by one sample at most, in order.
SampleRange samples_of_part(PartNumber part, std::uint64_t samples);

/// Where film files say how many samples a pixel the whole picture is to have, and of how many parts; 0: they don't.
inline constexpr const char* planned_samples_attribute = "fathom.planned_samples";
inline constexpr const char* planned_parts_attribute = "fathom.planned_parts";
/// Layers that the picture of a film is to have which its sums don't tell: "A,variance,samples".
inline constexpr const char* wanted_layers_attribute = "fathom.layers";
/// Of a part: its picture's standard error over its mean, and the samples a pixel that were made in a second.
inline constexpr const char* noise_attribute = "fathom.noise";
inline constexpr const char* samples_per_s_attribute = "fathom.samples_per_s";
std::uint64_t planned_number(const std::map<std::string, std::string>& attributes, const char* attribute);

/// How many samples they are.
std::uint64_t count_of(const std::vector<SampleRange>& ranges);
/// What of 0 to `planned` is not there, or to the last sample that is.
std::vector<SampleRange> missing_samples(const std::vector<SampleRange>& there, std::uint64_t planned);
/// What of `wanted` is not there.
std::vector<SampleRange> missing_samples(const std::vector<SampleRange>& there, SampleRange wanted);
/// "samples 64:128 (part 2 of 16)"; the parts where their number is known.
std::string missing_text(const std::vector<SampleRange>& missing, std::uint64_t planned_samples,
                         std::uint64_t planned_parts);

}  // namespace fathom::cli
