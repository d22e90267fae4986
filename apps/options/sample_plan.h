// SPDX-License-Identifier: Apache-2.0
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
/// `3/16`, or `2+1/16` where the number is counted from 0. Throws UsageError.
PartNumber parse_part(const std::string& text);

/// Samples of one part. Parts are consecutive ranges whose sizes differ by at most one sample.
SampleRange samples_of_part(PartNumber part, std::uint64_t samples);

/// Attributes of film files: samples per pixel of the whole image, and number of parts; absent if unknown.
inline constexpr const char* planned_samples_attribute = "fathom.planned_samples";
inline constexpr const char* planned_parts_attribute = "fathom.planned_parts";
/// Attribute that lists layers of the image which the sums don't imply: "A,variance,samples".
inline constexpr const char* wanted_layers_attribute = "fathom.layers";
/// Attributes of a part: standard error of its image over its mean, and samples per pixel rendered in a second.
inline constexpr const char* noise_attribute = "fathom.noise";
inline constexpr const char* samples_per_s_attribute = "fathom.samples_per_s";
/// The number in an attribute; 0 if it is absent or invalid.
std::uint64_t planned_number(const std::map<std::string, std::string>& attributes, const char* attribute);

/// Number of samples in disjoint ranges.
std::uint64_t count_samples(const std::vector<SampleRange>& ranges);
/// "0:16,32:48"
std::string sample_ranges_text(const std::vector<SampleRange>& ranges);
/// Samples from 0 to `planned`, or to the last one present, that are not present.
std::vector<SampleRange> missing_samples(const std::vector<SampleRange>& present, std::uint64_t planned);
/// Samples of `wanted` that are not present.
std::vector<SampleRange> missing_samples(const std::vector<SampleRange>& present, SampleRange wanted);
/// "samples 64:128 (part 2 of 16)"; the part is omitted if the number of parts is unknown.
std::string missing_text(const std::vector<SampleRange>& missing, std::uint64_t planned_samples,
                         std::uint64_t planned_parts);

}  // namespace fathom::cli
