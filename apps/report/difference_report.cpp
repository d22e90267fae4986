// SPDX-License-Identifier: Apache-2.0
#include "report/difference_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace fathom::cli {

namespace {

using nlohmann::ordered_json;

/// Blocks that the text lists; JSON has all.
constexpr std::size_t max_blocks = 10;

std::string line(const char* name, const std::string& value)
{
    return fmt::format("{:<18} {}", name, value);
}

std::string pixels_text(const Comparison& c)
{
    const ImageDifference& d = c.difference;
    const double all = double(d.width) * d.height;
    const std::string tolerance = c.options.tolerance > 0 ? fmt::format(" by more than {:g}", c.options.tolerance) : "";
    return fmt::format("{} of {}{} ({:.3g} %)", d.different_pixels, std::uint64_t(all), tolerance,
                       100 * double(d.different_pixels) / all);
}

std::string largest_text(const ImageDifference::Largest& largest)
{
    if (largest.difference == 0) return "0";
    return fmt::format("{:.6g} in {} of pixel {},{}: {:.6g}, reference {:.6g}", largest.difference, largest.channel,
                       largest.x, largest.y, largest.value, largest.reference);
}

std::string flip_text(const Flip& flip)
{
    std::string text = fmt::format("mean {:.6f}, largest {:.6f}", flip.mean, flip.max);
    if (flip.exposures > 0)
        text += fmt::format(" (HDR-FLIP, {} exposures from {:+.2f} to {:+.2f} stops)", flip.exposures, flip.first_ev,
                            flip.last_ev);
    return text;
}

void add_color_lines(const ColorDifference& color, bool is_linear, std::vector<std::string>& lines)
{
    const std::string psnr = color.psnr_db ? fmt::format("{:.2f} dB", *color.psnr_db) : "infinite";
    lines.push_back(line("PSNR", is_linear ? fmt::format("{}, peak {:.4g}", psnr, color.peak) : psnr));
    lines.push_back(line("relMSE", fmt::format("{:.4g}", color.relmse)));
    lines.push_back(line("FLIP", flip_text(color.flip)));
}

std::string change_text(const NoiseTest::Change& change)
{
    return fmt::format("{},{} to {},{}: {} has the mean {:.4g}, reference {:.4g}, standard error {:.2g}, p {:.1g}",
                       change.x0, change.y0, change.x1, change.y1, change.channel, change.mean, change.reference_mean,
                       change.standard_error, change.p);
}

void add_noise_lines(const NoiseTest& noise, std::vector<std::string>& lines)
{
    const std::string blocks = fmt::format("blocks of {}x{} pixels", noise.block_side, noise.block_side);
    if (noise.is_noise()) {
        lines.push_back(line("noise", fmt::format("the differences are explained by noise: Welch's t-test of {} {}, "
                                                  "smallest p {:.2g} after Bonferroni's correction",
                                                  noise.blocks, blocks, noise.smallest_p)));
        return;
    }
    if (noise.whole_changed)
        lines.push_back(line("noise", "noise does not explain the difference of the means of the whole images"));
    if (noise.changes.empty()) return;
    lines.push_back(line(noise.whole_changed ? "" : "noise",
                         fmt::format("noise does not explain the differences of {} of {} {}:", noise.changes.size(),
                                     noise.blocks, blocks)));
    for (std::size_t i = 0; i < std::min(max_blocks, noise.changes.size()); ++i)
        lines.push_back(line("", change_text(noise.changes[i])));
    if (noise.changes.size() > max_blocks)
        lines.push_back(line("", fmt::format("and {} more, see --json", noise.changes.size() - max_blocks)));
}

std::string verdict(const Comparison& c)
{
    const ImageDifference& d = c.difference;
    if (d.largest.difference == 0) return "equal";
    if (d.is_same()) return fmt::format("the same within {:g}", c.options.tolerance);
    return c.is_explained_by_noise() ? "different, but only by noise" : "different";
}

/// A number, or null if it is not finite.
ordered_json number(double value)
{
    return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr);
}

ordered_json color_json(const ColorDifference& color)
{
    const Flip& flip = color.flip;
    ordered_json json = {{"mse", number(color.mse)},
                         {"psnr_db", color.psnr_db ? ordered_json(*color.psnr_db) : ordered_json(nullptr)},
                         {"peak", number(color.peak)},
                         {"relmse", number(color.relmse)},
                         {"flip", {{"mean", flip.mean}, {"max", flip.max}}}};
    if (flip.exposures > 0)
        json["flip"].update(
            ordered_json{{"exposures", flip.exposures}, {"first_ev", flip.first_ev}, {"last_ev", flip.last_ev}});
    return json;
}

ordered_json noise_json(const NoiseTest& noise)
{
    ordered_json changes = ordered_json::array();
    for (const NoiseTest::Change& change : noise.changes)
        changes.push_back({{"pixels", {change.x0, change.y0, change.x1, change.y1}},
                           {"channel", change.channel},
                           {"mean", change.mean},
                           {"reference_mean", change.reference_mean},
                           {"standard_error", change.standard_error},
                           {"p", change.p}});
    return {{"explains_differences", noise.is_noise()}, {"significance", noise.significance},
            {"block_side", noise.block_side},           {"blocks", noise.blocks},
            {"smallest_p", noise.smallest_p},           {"whole_image_changed", noise.whole_changed},
            {"changed_blocks", std::move(changes)}};
}

}  // namespace

std::vector<std::string> difference_text(const Comparison& c)
{
    const ImageDifference& d = c.difference;
    std::vector<std::string> lines = {line("image", c.image_name), line("reference", c.reference_name),
                                      line("different pixels", pixels_text(c)),
                                      line("largest difference", largest_text(d.largest))};
    if (d.invalid_pixels > 0)
        lines.push_back(line("NaN or infinite", fmt::format("{} pixels: left out of the means", d.invalid_pixels)));
    if (d.color) add_color_lines(*d.color, d.is_linear, lines);
    if (c.noise && !d.is_same()) add_noise_lines(*c.noise, lines);
    if (!c.noise && !d.is_same()) lines.push_back(line("noise", "not tested: " + c.no_noise_test));
    for (const std::string& note : d.notes) lines.push_back(line("note", note));
    lines.push_back(line("result", verdict(c)));
    return lines;
}

ordered_json difference_json(const Comparison& c)
{
    const ImageDifference& d = c.difference;
    ordered_json json = {{"image", c.image_name},
                         {"reference", c.reference_name},
                         {"width", d.width},
                         {"height", d.height},
                         {"layer", c.options.layer},
                         {"linear", d.is_linear},
                         {"tolerance", c.options.tolerance},
                         {"same", d.is_same()},
                         {"different_pixels", d.different_pixels},
                         {"invalid_pixels", d.invalid_pixels},
                         {"largest",
                          {{"difference", number(d.largest.difference)},
                           {"x", d.largest.x},
                           {"y", d.largest.y},
                           {"channel", d.largest.channel},
                           {"value", number(double(d.largest.value))},
                           {"reference", number(double(d.largest.reference))}}}};
    if (d.color) json.update(color_json(*d.color));
    if (c.noise) json["noise"] = noise_json(*c.noise);
    json["notes"] = d.notes;
    return json;
}

}  // namespace fathom::cli
