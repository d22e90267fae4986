#pragma once
#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "fathom/render.h"

/// How the texts of options become values. Everything here throws UsageError for what is no sensible value.
namespace fathom::cli {

struct Size {
    int width = 0, height = 0;
};

/// A finite number.
double parse_number(const std::string& text);
double parse_number(const std::string& text, double least, double most);
std::uint64_t parse_integer(const std::string& text, std::uint64_t least, std::uint64_t most);
/// `x,y,z`
Vec3d parse_vector(const std::string& text);
std::vector<double> parse_numbers(const std::string& text, std::size_t count);
/// `800x600`
Size parse_size(const std::string& text);
/// Seconds of `90`, `90s`, `1.5m`, `1h`.
double parse_duration(const std::string& text);
/// `x0,y0,x1,y1`
Crop parse_crop(const std::string& text);
/// `A:B`, A < B
SampleRange parse_sample_range(const std::string& text);
/// Linear colour of `#rrggbb` (sRGB), `r,g,b` or one number for grey (both linear), `black`, `white`.
Color parse_colour(const std::string& text);
/// Position of `text` in `words`.
int parse_word(const std::string& text, const std::vector<std::string>& words);
std::vector<std::string> split(const std::string& text, char separator);

/// Adds an option with one value; messages of what `take` throws get the option's name in front.
CLI::Option* add_value(CLI::App& app, const std::string& name, const std::string& value_name, const std::string& help,
                       std::function<void(const std::string&)> take);

}  // namespace fathom::cli
