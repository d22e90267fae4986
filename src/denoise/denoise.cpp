// SPDX-License-Identifier: Apache-2.0
#include "fathom/denoise.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <type_traits>
#include <vector>

#include "denoise/oidn.h"
#include "fathom/error.h"

namespace fathom {

namespace {

using Device = std::unique_ptr<std::remove_pointer_t<Oidn::Device>, decltype(Oidn::oidnReleaseDevice)>;
using Filter = std::unique_ptr<std::remove_pointer_t<Oidn::Filter>, decltype(Oidn::oidnReleaseFilter)>;

/// An image plane of three floats per pixel.
using Plane = std::vector<float>;

/// First three channels of a layer.
Plane plane_of(const Image::Layer& layer)
{
    const std::size_t stride = layer.channels.size();
    if (stride < 3) throw Error("", layer.name, "can't be denoised: the image has fewer than three channels");
    Plane plane(layer.pixels.size() / stride * 3);
    for (std::size_t i = 0; i < plane.size() / 3; ++i) std::copy_n(&layer.pixels[i * stride], 3, &plane[3 * i]);
    return plane;
}

struct Input {
    const char* name;  ///< OIDN's name of the input
    Plane plane;
};

/// Filter inputs of an image: its colors and the auxiliary layers albedo and normal. OIDN accepts normals only with an
/// albedo.
std::vector<Input> inputs_of(const Image& image)
{
    if (image.layers.empty()) throw Error("", "", "can't denoise an empty image");
    std::vector<Input> inputs = {{"color", plane_of(image.layers[0])}};
    for (const char* name : {"albedo", "normal"}) {
        const Image::Layer* layer = image.find(name);
        if (!layer) break;
        inputs.push_back({name, plane_of(*layer)});
    }
    return inputs;
}

Image::Layer denoised_layer(Plane plane)
{
    return {"denoised", {"R", "G", "B"}, std::move(plane)};
}

}  // namespace

struct Denoiser::Data {
    Oidn oidn;
    Device device;
    std::string version;

    /// Throws Error if a call failed since the last check. Returns false if the filter was cancelled.
    bool check() const
    {
        const char* message = nullptr;
        const int error = oidn.oidnGetDeviceError(device.get(), &message);
        if (error == Oidn::error_cancelled) return false;
        if (error != Oidn::error_none) throw Error(oidn.file.string(), "denoising", message ? message : "failed");
        return true;
    }

    /// Parameters of the filter for the first input.
    struct Mode {
        bool is_radiance = false, aids_are_clean = false, is_quick = false;
        const std::atomic<bool>* cancel = nullptr;
    };
    /// Runs the filter; returns an empty plane if it was cancelled.
    Plane filter(const Image& image, std::span<Input> inputs, const Mode& mode) const
    {
        const Filter rt(oidn.oidnNewFilter(device.get(), "RT"), oidn.oidnReleaseFilter);
        check();
        const auto set = [&](const char* name, Plane& plane) {
            oidn.oidnSetSharedFilterImage(rt.get(), name, plane.data(), Oidn::format_float3, std::size_t(image.width),
                                          std::size_t(image.height), 0, 0, 0);
        };
        Plane output(std::size_t(image.width) * std::size_t(image.height) * 3);
        for (Input& input : inputs) set(input.name, input.plane);
        set("output", output);
        oidn.oidnSetFilterBool(rt.get(), "hdr", mode.is_radiance);
        oidn.oidnSetFilterBool(rt.get(), "cleanAux", mode.aids_are_clean);
        if (mode.is_quick) oidn.oidnSetFilterInt(rt.get(), "quality", Oidn::quality_balanced);
        if (mode.cancel) {
            const auto go_on = [](void* cancel, double) {
                return !static_cast<const std::atomic<bool>*>(cancel)->load(std::memory_order_relaxed);
            };
            oidn.oidnSetFilterProgressMonitorFunction(rt.get(), go_on, const_cast<std::atomic<bool>*>(mode.cancel));
        }
        oidn.oidnCommitFilter(rt.get());
        oidn.oidnExecuteFilter(rt.get());
        if (!check()) return {};
        return output;
    }
};

Denoiser::Denoiser(int threads)
{
    const Oidn oidn = open_oidn();
    // GPUs are not used: results would depend on the model.
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
                    fmt::format("this is Open Image Denoise {}; version 2 is required", data->version));
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
    std::vector<Input> inputs = inputs_of(image);
    // Auxiliary layers of few samples are noisy at edges and with depth of field, so they are denoised first. High
    // quality takes 2.7 times as long for them without benefit: the error was equal within 1 % in three scenes.
    for (std::size_t i = 1; i < inputs.size(); ++i)
        inputs[i].plane = data_->filter(image, {&inputs[i], 1}, {.is_radiance = false, .is_quick = true});
    return denoised_layer(data_->filter(image, inputs, {.is_radiance = true, .aids_are_clean = inputs.size() > 1}));
}

std::optional<Image::Layer> Denoiser::denoise_quickly(const Image& image, const std::atomic<bool>& cancel) const
{
    std::vector<Input> inputs = inputs_of(image);
    Plane denoised = data_->filter(image, inputs, {.is_radiance = true, .is_quick = true, .cancel = &cancel});
    if (denoised.empty()) return {};
    return denoised_layer(std::move(denoised));
}

void Denoiser::add_to(Image& image) const
{
    image.layers.push_back(denoise(image));
    image.attributes["fathom.denoiser"] = "Open Image Denoise " + version();
}

Image display_image(const Image& image)
{
    Image shown;
    shown.width = image.width, shown.height = image.height;
    shown.layers = {image.layers[0]};
    const Image::Layer* denoised = image.find("denoised");
    if (!denoised) return shown;
    Image::Layer& layer = shown.layers[0];
    const std::size_t stride = layer.channels.size();
    for (std::size_t i = 0; i < layer.pixels.size() / stride; ++i)
        std::copy_n(&denoised->pixels[3 * i], 3, &layer.pixels[stride * i]);
    return shown;
}

}  // namespace fathom
