// SPDX-License-Identifier: Apache-2.0
#include "render/watch.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "commands/commands.h"

namespace fathom::cli {

namespace fs = std::filesystem;

namespace {

/// Times of the last change; the smallest time for a missing file.
std::vector<fs::file_time_type> change_times(const std::vector<fs::path>& files)
{
    std::vector<fs::file_time_type> times;
    times.reserve(files.size());
    for (const fs::path& file : files) {
        std::error_code error;
        const fs::file_time_type time = fs::last_write_time(file, error);
        times.push_back(error ? fs::file_time_type::min() : time);
    }
    return times;
}

}  // namespace

void SceneWatch::begin_reading()
{
    read_at_ = fs::file_time_type::clock::now();
}

void SceneWatch::set_files(const SceneDescription& scene)
{
    files_ = scene.files;
    for (const ImageFile& image : scene.images)
        if (!image.path.empty()) files_.push_back(image.path);
}

void SceneWatch::wait_for_change() const
{
    const std::vector<fs::file_time_type> first = change_times(files_);
    std::vector<fs::file_time_type> last = first;
    bool has_changed = std::any_of(first.begin(), first.end(), [&](const auto& time) { return time > read_at_; });
    for (;;) {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        std::vector<fs::file_time_type> now = change_times(files_);
        if (has_changed && now == last) return;
        has_changed |= now != first;
        last = std::move(now);
    }
}

void check_watch(const RenderOptions& o)
{
    if (o.scene.file == "/dev/stdin")
        throw UsageError("--watch: needs the name of a scene file, not the standard input");
    if (o.only_sample || !o.checkpoint.file.empty())
        throw UsageError("--watch: renders whole images; leave out --only-sample and --checkpoint");
}

}  // namespace fathom::cli
