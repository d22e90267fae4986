// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Interface between the program and its window module, libfathom_view.so. The program opens the module only for
/// `fathom view`, so that all else runs without a window system.
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "fathom/denoise.h"
#include "fathom/load.h"
#include "fathom/render.h"

namespace fathom::view {

/// A scene to show, and how to show it.
struct ViewJob {
    Scene scene;
    RenderSettings settings;    ///< includes the initial size of the window
    std::string name;           ///< name of the scene, for the title and for saved images
    std::uint64_t samples = 0;  ///< samples per pixel at which rendering pauses
    DisplayTransform display;
    std::optional<Denoiser> denoiser;                ///< none: the image is not denoised at first
    Bounds bounds;                                   ///< bounding box of the scene, for the colors of positions
    std::filesystem::path latency_log;               ///< empty: none
    int script_moves = 0;                            ///< number of scripted moves before the window closes; 0: none
    const std::atomic<bool>* interrupted = nullptr;  ///< closes the window when it becomes true
};

inline constexpr const char* module_file = "libfathom_view.so";

/// Symbol with the version of Fathom that the module belongs to; a module of another version is refused.
inline constexpr const char* version_symbol = "fathom_view_version";
/// Symbol of the function that tells why no window can be opened; it leaves `trouble` empty if one can.
inline constexpr const char* trouble_symbol = "fathom_view_trouble";
using Trouble = void(std::string& trouble);
/// Symbol of the function that opens the window and returns when it is closed. Errors are stored in `trouble`.
inline constexpr const char* run_symbol = "fathom_view_run";
using RunView = void(const ViewJob& job, std::string& trouble);

}  // namespace fathom::view
