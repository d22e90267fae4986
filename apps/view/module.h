#pragma once
/// The boundary between the program and the module that has the window, libfathom_view.so. The program opens it only
/// for `fathom view`, so everything else runs where no window system is installed.
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "fathom/denoise.h"
#include "fathom/load.h"
#include "fathom/render.h"

namespace fathom::view {

struct ViewJob {
    Scene scene;
    RenderSettings settings;    ///< size: the window's at first
    std::string name;           ///< of the scene, for the title; saved pictures are named after it
    std::uint64_t samples = 0;  ///< a pixel, when rendering ends
    DisplayTransform display;
    std::optional<Denoiser> denoiser;                ///< of the picture from the start; none: when it is asked for
    Bounds bounds;                                   ///< of the scene: the colours of positions
    std::filesystem::path latency_log;               ///< empty: none
    int script_moves = 0;                            ///< so many moves are made, then the window closes; 0: none
    const std::atomic<bool>* interrupted = nullptr;  ///< closes the window
};

inline constexpr const char* module_file = "libfathom_view.so";

/// Version of Fathom that the module belongs to: no other is used.
inline constexpr const char* version_symbol = "fathom_view_version";
/// Why no window can be opened here; left empty if one can.
inline constexpr const char* trouble_symbol = "fathom_view_trouble";
using Trouble = void(std::string& trouble);
/// Opens the window and returns when it was closed; what went wrong, if anything, is put into `trouble`.
inline constexpr const char* run_symbol = "fathom_view_run";
using RunView = void(const ViewJob& job, std::string& trouble);

}  // namespace fathom::view
