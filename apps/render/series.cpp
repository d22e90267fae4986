#include "series.h"

#include <fmt/format.h>

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;

/// The file of a frame: its number stands where #### does, with as many digits at least.
fs::path output_of(const fs::path& pattern, std::uint64_t frame)
{
    std::string name = pattern.filename().string();
    const std::size_t last = name.rfind('#');
    if (last == std::string::npos) return pattern;
    const std::size_t before = name.find_last_not_of('#', last), first = before == std::string::npos ? 0 : before + 1;
    name.replace(first, last + 1 - first, fmt::format("{:0{}}", frame, last + 1 - first));
    return pattern.parent_path() / name;
}

}  // namespace

void check_series(RenderOptions& o, const char* option)
{
    if (o.frames.size() == 1) return;
    if (o.time_s) throw UsageError(fmt::format("{}: --spp says how many samples each has; leave out --time", option));
    if (o.only_sample) throw UsageError(fmt::format("--only-sample: of which picture? give {} one", option));
    if (o.picture.outputs.empty()) o.picture.outputs.push_back(o.scene.file.stem().string() + ".####.png");
    for (const fs::path& file : o.picture.outputs)
        if (file.filename().string().find('#') == std::string::npos)
            throw UsageError(
                fmt::format("-o {}: {} pictures need names of their own: put #### where the number is to stand",
                            file.string(), o.frames.size()));
}

PictureOptions files_of(PictureOptions options, std::uint64_t frame)
{
    for (fs::path& file : options.outputs) file = output_of(file, frame);
    return options;
}

std::vector<fs::path> files_that_are_there(const RenderOptions& o)
{
    std::vector<fs::path> files;
    if (!o.writes_pictures) return files;
    const auto add = [&](const fs::path& file) {
        std::error_code error;
        if (fs::exists(file, error)) files.push_back(file);
    };
    for (const fs::path& pattern : o.picture.outputs) {
        if (o.frames.empty()) add(pattern);
        for (const std::uint64_t frame : o.frames) add(output_of(pattern, frame));
    }
    return files;
}

void check_outputs(const RenderOptions& o, int width, int height)
{
    if (!o.checkpoint.empty()) check_output(o.checkpoint, width, height);
    if (!o.writes_pictures) return;
    for (const fs::path& file : o.picture.outputs)
        check_output(o.frames.empty() ? file : output_of(file, o.frames[0]), width, height);
}

}  // namespace fathom::cli
