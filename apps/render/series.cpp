// SPDX-License-Identifier: Apache-2.0
#include "render/series.h"

#include <fmt/format.h>
#include <unistd.h>
#include <climits>

#include "fathom/error.h"
#include "render/checkpoint.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;

fs::path frame_file(const fs::path& pattern, std::uint64_t frame)
{
    std::string name = pattern.filename().string();
    const std::size_t last = name.rfind('#');
    if (last == std::string::npos) return pattern;
    const std::size_t before = name.find_last_not_of('#', last), first = before == std::string::npos ? 0 : before + 1;
    name.replace(first, last + 1 - first, fmt::format("{:0{}}", frame, last + 1 - first));
    return pattern.parent_path() / name;
}

/// Throws Error if the name of the checkpoint's previous generation is too long. No file is created to test this, since
/// a link of another user may have that name.
void check_previous_name(const fs::path& checkpoint)
{
    const fs::path previous = previous_file(checkpoint), folder = previous.parent_path();
    const long found = pathconf(folder.empty() ? "." : folder.c_str(), _PC_NAME_MAX);
    const std::size_t size = previous.filename().string().size(), max_size = found > 0 ? std::size_t(found) : NAME_MAX;
    if (size > max_size)
        throw Error(
            checkpoint.string(), "",
            fmt::format("can't write: the previous checkpoint is kept as NAME.previous.exr, a name of {} bytes, and "
                        "this folder takes {}",
                        size, max_size));
}

}  // namespace

void check_series(RenderOptions& o, const char* option)
{
    if (o.series.frames.size() == 1 || o.dataset.format != DatasetFormat::none) return;
    if (o.samples.time_s)
        throw UsageError(fmt::format("{}: choose the samples of each image with --spp; leave out --time", option));
    if (o.only_sample)
        throw UsageError(fmt::format("--only-sample: replays one image's sample; give {} one image", option));
    if (o.images.outputs.empty()) o.images.outputs.push_back(o.scene.file.stem().string() + ".####.png");
    for (const fs::path& file : o.images.outputs)
        if (file.filename().string().find('#') == std::string::npos)
            throw UsageError(fmt::format("-o {}: {} images need different names: put #### where the number goes",
                                         file.string(), o.series.frames.size()));
}

ImageOptions frame_files(ImageOptions options, std::uint64_t frame)
{
    for (fs::path& file : options.outputs) file = frame_file(file, frame);
    return options;
}

std::vector<fs::path> existing_outputs(const RenderOptions& o)
{
    std::vector<fs::path> files;
    if (!o.writes_images) return files;
    const auto add = [&](const fs::path& file) {
        std::error_code error;
        if (fs::exists(file, error)) files.push_back(file);
    };
    for (const fs::path& pattern : o.images.outputs) {
        if (o.series.frames.empty()) add(pattern);
        for (const std::uint64_t frame : o.series.frames) add(frame_file(pattern, frame));
    }
    return files;
}

void check_outputs(const RenderOptions& o, int width, int height)
{
    if (!o.checkpoint.file.empty()) {
        check_output(o.checkpoint.file, width, height);
        check_previous_name(o.checkpoint.file);
    }
    if (!o.writes_images) return;
    for (const fs::path& file : o.images.outputs) {
        if (o.series.frames.empty()) {
            check_output(file, width, height, o.images.format);
            continue;
        }
        // The last frame may have more digits, and thus a longer name.
        check_output(frame_file(file, o.series.frames.front()), width, height, o.images.format);
        check_output(frame_file(file, o.series.frames.back()), width, height, o.images.format);
    }
}

}  // namespace fathom::cli
