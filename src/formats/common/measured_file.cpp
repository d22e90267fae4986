// SPDX-License-Identifier: Apache-2.0
#include "formats/common/measured_file.h"

#include <fmt/format.h>

#include <cmath>

#include "formats/common/spectra.h"
#include "formats/io/tensor_file.h"
#include "scene/measured.h"

namespace fathom {

namespace {

/// Reads an array whose last two dimensions are rows and columns, and whose other dimensions must equal `outer`.
MeasuredTable read_table(const TensorFile& file, const char* name, const std::vector<std::uint64_t>& outer)
{
    const TensorFile::Field& field = file.floats(name, outer.size() + 2);
    const std::string place = fmt::format("'{}'", name);
    for (std::size_t i = 0; i < outer.size(); ++i)
        if (field.shape[i] != outer[i])
            file.fail(place, fmt::format("has {} tables along dimension {}, expected {}", field.shape[i], i, outer[i]));
    const std::uint64_t height = field.shape[outer.size()], width = field.shape[outer.size() + 1];
    if (width > 1u << 30 || height > 1u << 30) file.fail(place, "has a table that is too large");
    return {int(width), int(height), TensorFile::values(field)};
}

/// The color that each wavelength contributes under D65, for spectra that are linear between wavelengths.
std::vector<Color> weights_of(const TensorFile& file, const std::vector<float>& wavelengths)
{
    for (std::size_t i = 0; i < wavelengths.size(); ++i)
        if (!std::isfinite(wavelengths[i]) || (i > 0 && !(wavelengths[i - 1] < wavelengths[i])))
            file.fail("'wavelengths'", "must increase");
    std::vector<Color> weights;
    for (std::size_t i = 0; i < wavelengths.size(); ++i) {
        std::vector<SpectrumPoint> hat;
        if (i > 0) hat.push_back({double(wavelengths[i - 1]), 0});
        hat.push_back({double(wavelengths[i]), 1});
        if (i + 1 < wavelengths.size()) hat.push_back({double(wavelengths[i + 1]), 0});
        weights.push_back(color_in_daylight(hat));
    }
    return weights;
}

MeasuredTable read_spectra(const TensorFile& file, std::uint64_t phis, std::uint64_t thetas)
{
    const TensorFile::Field& field = file.floats("wavelengths", 1);
    // Each wavelength costs an integral, and real files have far fewer.
    constexpr std::uint64_t most = 4096;
    if (field.shape[0] > most) file.fail("'wavelengths'", fmt::format("there are more than {}", most));
    const std::vector<Color> weights = weights_of(file, TensorFile::values(field));
    const MeasuredTable spectra = read_table(file, "spectra", {phis, thetas, weights.size()});
    const std::size_t size = std::size_t(spectra.width) * std::size_t(spectra.height), slices = phis * thetas;
    MeasuredTable color{spectra.width, spectra.height, std::vector<float>(3 * slices * size)};
    std::vector<double> sums(3 * size);
    for (std::size_t slice = 0; slice < slices; ++slice) {
        sums.assign(sums.size(), 0);
        for (std::size_t w = 0; w < weights.size(); ++w) {
            const float* values = &spectra.values[(slice * weights.size() + w) * size];
            const double by[] = {double(weights[w].r), double(weights[w].g), double(weights[w].b)};
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t i = 0; i < size; ++i) sums[c * size + i] += by[c] * double(values[i]);
        }
        for (std::size_t i = 0; i < sums.size(); ++i) color.values[3 * slice * size + i] = float(sums[i]);
    }
    return color;
}

}  // namespace

MeasuredBrdf read_measured(const std::filesystem::path& file, std::string_view bytes)
{
    const TensorFile tensors(file.string(), bytes);
    MeasuredBrdf brdf;
    brdf.name = file.filename().string();
    brdf.theta = TensorFile::values(tensors.floats("theta_i", 1));
    brdf.phi = TensorFile::values(tensors.floats("phi_i", 1));
    const std::vector<std::uint64_t> slices = {brdf.phi.size(), brdf.theta.size()};
    brdf.ndf = read_table(tensors, "ndf", {});
    brdf.sigma = read_table(tensors, "sigma", {});
    brdf.vndf = read_table(tensors, "vndf", slices);
    brdf.luminance = read_table(tensors, "luminance", slices);
    if (tensors.find("rgb") || !tensors.find("spectra"))
        brdf.color = read_table(tensors, "rgb", {slices[0], slices[1], 3});
    else
        brdf.color = read_spectra(tensors, slices[0], slices[1]);
    if (const TensorFile::Field* jacobian = tensors.find("jacobian"))
        brdf.color_is_per_facet = jacobian->bytes.find_first_not_of('\0') != std::string_view::npos;
    if (const std::string problem = problem_of(brdf); !problem.empty()) tensors.fail("", problem);
    return brdf;
}

int MeasuredFiles::index_of(const std::filesystem::path& file)
{
    const std::filesystem::path located = context_.locate(file);
    if (const auto found = indices_.find(located); found != indices_.end()) return found->second;
    scene_.measured.push_back(read_measured(located, context_.read(located)));
    return indices_[located] = int(scene_.measured.size()) - 1;
}

}  // namespace fathom
