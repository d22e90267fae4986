// SPDX-License-Identifier: Apache-2.0
// A fake of Open Image Denoise for tests: its C functions, with a filter whose result is easy to compute.
#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <utility>

namespace {

struct Device {
    std::string error;
    int code = 2;  ///< code of the last error
    std::map<std::string, int> numbers;
    bool committed = false;
};
struct Picture {
    float* pixels = nullptr;
    std::size_t width = 0, height = 0;
};
struct Filter {
    Device* device;
    std::map<std::string, Picture> pictures;
    std::map<std::string, bool> flags;
    bool (*progress)(void*, double) = nullptr;
    void* progress_data = nullptr;
    bool committed = false;
};

int told_version(const char* part)
{
    const char* told = std::getenv("FATHOM_FAKE_OIDN_MAJOR");
    if (std::strcmp(part, "versionMajor") == 0) return told ? std::atoi(told) : 2;
    return std::strcmp(part, "versionMinor") == 0 ? 98 : 76;
}

}  // namespace

extern "C" {
Device* oidnNewDevice(int type)
{
    return type == 1 ? new Device : nullptr;
}
void oidnReleaseDevice(Device* device)
{
    delete device;
}
void oidnSetDeviceInt(Device* device, const char* name, int value)
{
    device->numbers[name] = value;
}
void oidnSetDeviceBool(Device*, const char*, bool) {}
int oidnGetDeviceInt(Device*, const char* name)
{
    return told_version(name);
}
void oidnCommitDevice(Device* device)
{
    device->committed = true;
}
int oidnGetDeviceError(Device* device, const char** message)
{
    static std::string told;
    if (device->error.empty()) return 0;
    told = device->error;
    device->error.clear();
    *message = told.c_str();
    return std::exchange(device->code, 2);
}
Filter* oidnNewFilter(Device* device, const char* type)
{
    if (!device->committed || std::strcmp(type, "RT") != 0) device->error = "no such filter";
    return new Filter{device, {}, {}};
}
void oidnReleaseFilter(Filter* filter)
{
    delete filter;
}
void oidnSetSharedFilterImage(Filter* filter, const char* name, void* pixels, int format, std::size_t width,
                              std::size_t height, std::size_t offset, std::size_t pixel_stride, std::size_t row_stride)
{
    if (format != 3 || offset != 0 || pixel_stride != 0 || row_stride != 0) filter->device->error = "odd layout";
    filter->pictures[name] = {static_cast<float*>(pixels), width, height};
}
void oidnSetFilterBool(Filter* filter, const char* name, bool value)
{
    filter->flags[name] = value;
}
void oidnSetFilterInt(Filter*, const char*, int) {}
void oidnSetFilterProgressMonitorFunction(Filter* filter, bool (*progress)(void*, double), void* data)
{
    filter->progress = progress;
    filter->progress_data = data;
}
void oidnCommitFilter(Filter* filter)
{
    filter->committed = true;
}
/// Auxiliary images: adds 0.5. Color: the mean of a pixel and its row neighbors, plus 100 if not HDR, plus 10 * albedo
/// and 1000 * normal; these two count half unless the auxiliary images are declared clean.
void oidnExecuteFilter(Filter* filter)
{
    const Picture output = filter->pictures["output"];
    if (!filter->committed || output.width == 13) {
        filter->device->error = "13 is unlucky";
        return;
    }
    if (filter->progress && !filter->progress(filter->progress_data, 0.5)) {
        filter->device->error = "cancelled";
        filter->device->code = 6;
        return;
    }
    for (const char* name : {"albedo", "normal"})
        if (filter->pictures.size() == 2 && filter->pictures.count(name) == 1)
            for (std::size_t i = 0; i < output.width * output.height * 3; ++i)
                output.pixels[i] = filter->pictures[name].pixels[i] + 0.5f;
    if (filter->pictures.count("color") == 0) return;
    const float* color = filter->pictures["color"].pixels;
    for (std::size_t y = 0; y < output.height; ++y)
        for (std::size_t x = 0; x < output.width; ++x)
            for (std::size_t c = 0; c < 3; ++c) {
                const auto at = [&](std::size_t column) { return 3 * (y * output.width + column) + c; };
                float& out = output.pixels[at(x)];
                out = (color[at(x)] + color[at(x > 0 ? x - 1 : 0)] + color[at(std::min(x + 1, output.width - 1))]) / 3;
                if (!filter->flags["hdr"]) out += 100;
                const float share = filter->flags["cleanAux"] ? 1 : 0.5f;
                if (filter->pictures.count("albedo")) out += share * 10 * filter->pictures["albedo"].pixels[at(x)];
                if (filter->pictures.count("normal")) out += share * 1000 * filter->pictures["normal"].pixels[at(x)];
            }
}
}
