#include "render/series.h"

#include <fmt/format.h>
#include <unistd.h>
#include <climits>

#include "fathom/error.h"
#include "render/checkpoint.h"

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

/// The state before the last has a longer name than the checkpoint. Nothing is made under that name, where a link of
/// somebody else may wait.
void check_previous(const fs::path& checkpoint)
{
    const fs::path previous = previous_of(checkpoint), folder = previous.parent_path();
    const long found = pathconf(folder.empty() ? "." : folder.c_str(), _PC_NAME_MAX);
    const std::size_t size = previous.filename().string().size(), max_size = found > 0 ? std::size_t(found) : NAME_MAX;
    if (size > max_size)
        throw Error(
            checkpoint.string(), "",
            fmt::format("can't write: the state before it is kept as NAME.previous.exr, a name of {} bytes, and "
                        "this folder takes {}",
                        size, max_size));
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
    if (!o.checkpoint.empty()) {
        check_output(o.checkpoint, width, height);
        check_previous(o.checkpoint);
    }
    if (!o.writes_pictures) return;
    for (const fs::path& file : o.picture.outputs) {
        if (o.frames.empty()) {
            check_output(file, width, height);
            continue;
        }
        // The last frame may have more digits, and so a longer name.
        check_output(output_of(file, o.frames.front()), width, height);
        check_output(output_of(file, o.frames.back()), width, height);
    }
}

}  // namespace fathom::cli
