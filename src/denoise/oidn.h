// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>

namespace fathom {

/// Functions of Open Image Denoise 2, under their C names. Its objects are opaque; enumerators have the values of
/// oidn.h.
struct Oidn {
    using Device = struct DeviceObject*;
    using Filter = struct FilterObject*;
    static constexpr int device_cpu = 1, format_float3 = 3, error_none = 0, error_cancelled = 6, quality_balanced = 5;

    Device (*oidnNewDevice)(int type);
    void (*oidnReleaseDevice)(Device);
    void (*oidnSetDeviceInt)(Device, const char* name, int value);
    void (*oidnSetDeviceBool)(Device, const char* name, bool value);
    int (*oidnGetDeviceInt)(Device, const char* name);
    void (*oidnCommitDevice)(Device);
    int (*oidnGetDeviceError)(Device, const char** message);
    Filter (*oidnNewFilter)(Device, const char* type);
    void (*oidnReleaseFilter)(Filter);
    void (*oidnSetSharedFilterImage)(Filter, const char* name, void* pixels, int format, std::size_t width,
                                     std::size_t height, std::size_t offset, std::size_t pixel_stride,
                                     std::size_t row_stride);
    void (*oidnSetFilterBool)(Filter, const char* name, bool value);
    void (*oidnSetFilterInt)(Filter, const char* name, int value);
    /// Called with the progress from 0 to 1; returning false cancels.
    using Progress = bool (*)(void* data, double done);
    void (*oidnSetFilterProgressMonitorFunction)(Filter, Progress, void* data);
    void (*oidnCommitFilter)(Filter);
    void (*oidnExecuteFilter)(Filter);

    std::filesystem::path file;  ///< the library's file
};

/// Finds and opens the library, which stays open. Throws Error if there is none.
Oidn open_oidn();

}  // namespace fathom
