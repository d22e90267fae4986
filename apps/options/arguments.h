#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "commands/commands.h"
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
/// Bytes of `8G`, `512M`, `1.5GiB`: K, M, G and T are powers of 1000, Ki, Mi, Gi and Ti of 1024.
std::uint64_t parse_bytes(const std::string& text);
/// `x,y,z`
Vec3d parse_vector(const std::string& text);
std::vector<double> parse_numbers(const std::string& text, std::size_t count);
/// `800x600`
Size parse_size(const std::string& text);
/// Seconds of `90`, `90s`, `1.5m`, `1h`.
double parse_duration(const std::string& text);
/// Seconds from 0 on, of `1.5` or `1.5s`.
double parse_time(const std::string& text);
/// Frames of `A`, `A:B` or `A:B:STEP`, B included.
std::vector<std::uint64_t> parse_frames(const std::string& text);
/// `x0,y0,x1,y1`
Crop parse_crop(const std::string& text);
/// `A:B`, A < B
SampleRange parse_sample_range(const std::string& text);
/// Linear colour of `#rrggbb` (sRGB), `r,g,b` or one number for grey (both linear), `black`, `white`.
Color parse_color(const std::string& text);
/// Position of `text` in `words`.
int parse_word(const std::string& text, const std::vector<std::string>& words);
std::vector<std::string> split(const std::string& text, char separator);

/// One command and its options. CLI11, which takes seconds to compile, is only behind this and program.cpp.
class Command {
public:
    Command(CLI::App& program, const std::string& name, const std::string& what_it_does);
    /// A command of a group, of which one must be given.
    Command(Command& group, const std::string& name, const std::string& what_it_does);

    using Take = std::function<void(const std::string&)>;
    /// An option with one value; messages of what `take` throws get the option's name in front.
    void add_value(const std::string& name, const std::string& value_name, const std::string& help, Take take);
    void add_flag(const std::string& name, bool& flag, const std::string& help);
    /// A flag that may be told more by NAME=WORD, or by a word behind it that program.cpp knows; `take` gets "true"
    /// without.
    void add_flag_or_word(const std::string& name, const std::string& help, Take take);
    /// The same for one that may be given several times: `take` gets one value after the other.
    void add_values(const std::string& name, const std::string& value_name, const std::string& help, Take take);
    /// An option that may be given several times.
    void add_files(const std::string& name, std::vector<std::filesystem::path>& files, const std::string& help);
    /// What stands without an option's name, and must be there: one file, or one and more.
    void add_positional(const std::string& name, std::filesystem::path& file, const std::string& help);
    void add_positionals(const std::string& name, std::vector<std::filesystem::path>& files, const std::string& help);
    /// Of the options that have been added, how many there are; and those of them from number `first` to before `last`
    /// that were given, as words of a command line. Lists of files, and what has no name, aside.
    std::size_t option_count() const;
    std::vector<std::string> given(std::size_t first, std::size_t last) const;

    /// What --help ends with.
    void set_footer(const std::string& text);
    /// What to do if this is the command that is given.
    void set_run(Run& run, Run what);

private:
    CLI::App& app_;
    std::vector<const CLI::Option*> file_lists_;  ///< what add_files made
};

}  // namespace fathom::cli
