// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <vector>

#include "fathom/description.h"
#include "options/render_options.h"

namespace fathom::cli {

/// Waits until a file of a scene changes.
class SceneWatch {
public:
    explicit SceneWatch(const std::filesystem::path& scene) : files_{scene} {}

    /// Marks the beginning of reading: a file that is written later counts as changed.
    void begin_reading();
    /// Watches all files that a scene was read from, textures included.
    void set_files(const SceneDescription& scene);
    std::size_t file_count() const { return files_.size(); }
    /// Returns after a file was changed, replaced or removed, and no file has changed for a tenth of a second.
    void wait_for_change() const;

private:
    std::vector<std::filesystem::path> files_;
    std::filesystem::file_time_type read_at_{};
};

/// Throws UsageError for options that make no sense with --watch.
void check_watch(const RenderOptions& options);

}  // namespace fathom::cli
