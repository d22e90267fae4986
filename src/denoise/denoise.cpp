#include "fathom/denoise.h"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>
#include <vector>

#include "denoise/oidn.h"
#include "fathom/error.h"

namespace fathom {

namespace {

using Device = std::unique_ptr<std::remove_pointer_t<Oidn::Device>, decltype(Oidn::oidnReleaseDevice)>;
using Filter = std::unique_ptr<std::remove_pointer_t<Oidn::Filter>, decltype(Oidn::oidnReleaseFilter)>;

/// Three floats a pixel.
using Plane = std::vector<float>;

/// The first three channels of a layer.
Plane plane_of(const Image::Layer& layer)
{
    const std::size_t stride = layer.channels.size();
    if (stride < 3) throw Error("", layer.name, "can't be denoised: the picture has no three channels");
    Plane plane(layer.pixels.size() / stride * 3);
    for (std::size_t i = 0; i < plane.size() / 3; ++i) std::copy_n(&layer.pixels[i * stride], 3, &plane[3 * i]);
    return plane;
}

}  // namespace

struct Denoiser::Data {
    Oidn oidn;
    Device device;
    std::string version;

    /// Throws Error if something went wrong since it was called last.
    void check() const
    {
        const char* message = nullptr;
        if (oidn.oidnGetDeviceError(device.get(), &message) != Oidn::error_none)
            throw Error(oidn.file.string(), "denoising", message ? message : "failed");
    }

    struct Input {
        const char* name;
        Plane& plane;
    };
    Plane filter(const Image& image, const std::vector<Input>& inputs, bool is_radiance) const
    {
        const Filter rt(oidn.oidnNewFilter(device.get(), "RT"), oidn.oidnReleaseFilter);
        check();
        const auto set = [&](const char* name, Plane& plane) {
            oidn.oidnSetSharedFilterImage(rt.get(), name, plane.data(), Oidn::format_float3, std::size_t(image.width),
                                          std::size_t(image.height), 0, 0, 0);
        };
        Plane output(std::size_t(image.width) * std::size_t(image.height) * 3);
        for (const Input& input : inputs) set(input.name, input.plane);
        set("output", output);
        if (is_radiance) {
            oidn.oidnSetFilterBool(rt.get(), "hdr", true);
            oidn.oidnSetFilterBool(rt.get(), "cleanAux", inputs.size() > 1);
        } else {
            // Of aids, high quality takes 2.7 times as long and brings nothing: the same error to 1 % in three scenes.
            oidn.oidnSetFilterInt(rt.get(), "quality", Oidn::quality_balanced);
        }
        oidn.oidnCommitFilter(rt.get());
        oidn.oidnExecuteFilter(rt.get());
        check();
        return output;
    }
};

Denoiser::Denoiser(int threads)
{
    const Oidn oidn = open_oidn();
    // Never a GPU: what it computes depends on which one it is.
    const auto data =
        std::make_shared<Data>(Data{oidn, {oidn.oidnNewDevice(Oidn::device_cpu), oidn.oidnReleaseDevice}, {}});
    if (!data->device) data->check();
    auto* const device = data->device.get();
    if (threads > 0) oidn.oidnSetDeviceInt(device, "numThreads", threads);
    oidn.oidnSetDeviceBool(device, "setAffinity", false);
    oidn.oidnCommitDevice(device);
    data->check();
    const int major = oidn.oidnGetDeviceInt(device, "versionMajor");
    data->version = fmt::format("{}.{}.{}", major, oidn.oidnGetDeviceInt(device, "versionMinor"),
                                oidn.oidnGetDeviceInt(device, "versionPatch"));
    if (major != 2)
        throw Error(oidn.file.string(), "denoising",
                    fmt::format("this is Open Image Denoise {}, and 2 is needed", data->version));
    data_ = data;
}

const std::string& Denoiser::version() const
{
    return data_->version;
}
const std::filesystem::path& Denoiser::file() const
{
    return data_->oidn.file;
}

Image::Layer Denoiser::denoise(const Image& image) const
{
    if (image.layers.empty()) throw Error("", "", "can't denoise an empty picture");
    Plane color = plane_of(image.layers[0]), albedo, normal;
    std::vector<Data::Input> inputs = {{"color", color}};
    // Those of few samples have noise themselves, at edges, and out of focus: they are denoised first.
    const auto add_clean = [&](const char* name, Plane& plane) {
        const Image::Layer* layer = image.find(name);
        if (!layer) return;
        plane = plane_of(*layer);
        plane = data_->filter(image, {{name, plane}}, false);
        inputs.push_back({name, plane});
    };
    add_clean("albedo", albedo);
    // Normals help beside an albedo only.
    if (!albedo.empty()) add_clean("normal", normal);
    return {"denoised", {"R", "G", "B"}, data_->filter(image, inputs, true)};
}

}  // namespace fathom
