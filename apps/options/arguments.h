// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "commands/commands.h"
#include "fathom/render.h"

/// Conversion of option texts to values. Every parse function throws UsageError for an invalid text.
namespace fathom::cli {

struct Size {
    int width = 0, height = 0;
};

/// A finite number.
double parse_number(const std::string& text);
double parse_number(const std::string& text, double min, double max);
std::uint64_t parse_integer(const std::string& text, std::uint64_t min, std::uint64_t max);
/// Bytes of `8G`, `512M`, `1.5GiB`: K, M, G and T are powers of 1000, Ki, Mi, Gi and Ti of 1024.
std::uint64_t parse_bytes(const std::string& text);
/// `x,y,z`
Vec3d parse_vector(const std::string& text);
std::vector<double> parse_numbers(const std::string& text, std::size_t count);
/// A file name's extension in lower case without the dot, which may be given: `glb`.
std::string parse_extension(const std::string& text);
/// `800x600`
Size parse_size(const std::string& text);
/// Seconds of `90`, `90s`, `1.5m`, `1h`; above 0.
double parse_duration(const std::string& text);
/// Seconds of `1.5` or `1.5s`; 0 or more.
double parse_time(const std::string& text);
/// Frame numbers of `A`, `A:B` or `A:B:STEP`, B included.
std::vector<std::uint64_t> parse_frames(const std::string& text);
/// `x0,y0,x1,y1`
Crop parse_crop(const std::string& text);
/// `A:B`, A < B
SampleRange parse_sample_range(const std::string& text);
/// Linear color of `#rrggbb` (sRGB), `r,g,b` or one number for gray (both linear), `black`, `white`.
Color parse_color(const std::string& text);
/// Index of `text` in `choices`.
int parse_choice(const std::string& text, const std::vector<std::string>& choices);
std::vector<std::string> split(const std::string& text, char separator);

}  // namespace fathom::cli
