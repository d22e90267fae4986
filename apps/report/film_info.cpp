// SPDX-License-Identifier: Apache-2.0
#include "report/film_info.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "fathom/film_file.h"
#include "options/sample_plan.h"
#include "process/streams.h"
#include "report/error_report.h"

namespace fathom::cli {

namespace {

using nlohmann::ordered_json;

ordered_json ranges_json(const std::vector<SampleRange>& ranges)
{
    ordered_json json = ordered_json::array();
    for (const SampleRange& range : ranges) json.push_back({range.first, range.second});
    return json;
}

/// Names of layers, each once: an EXR channel is named LAYER.CHANNEL.
ordered_json layers_json(const std::vector<std::string>& channels)
{
    ordered_json layers = ordered_json::array();
    for (const std::string& channel : channels) {
        const std::size_t dot = channel.rfind('.');
        const std::string layer = dot == std::string::npos ? "image" : channel.substr(0, dot);
        if (std::find(layers.begin(), layers.end(), layer) == layers.end()) layers.push_back(layer);
    }
    return layers;
}

}  // namespace

FilmNoise film_noise(const Film& film)
{
    const Image image = film.image(false, true);
    const std::vector<float>&radiance = image.layers[0].pixels, &variance = image.find("variance")->pixels;
    const Crop inside = film.key().settings.rendered_pixels();
    double sum = 0, squares = 0;
    for (int y = inside.y0; y < inside.y1; ++y) {
        const std::size_t row = std::size_t(y) * std::size_t(film.width());
        for (std::size_t i = 3 * (row + std::size_t(inside.x0)); i < 3 * (row + std::size_t(inside.x1)); ++i)
            sum += double(radiance[i]), squares += double(variance[i]);
    }
    const double count = 3.0 * (inside.x1 - inside.x0) * (inside.y1 - inside.y0);
    return {std::sqrt(squares / count), sum / count};
}

bool is_film_file(const std::filesystem::path& file)
{
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return false;
    char start[4] = {};
    return std::ifstream(file, std::ios::binary).read(start, 4) && std::memcmp(start, "\x76\x2f\x31\x01", 4) == 0;
}

ordered_json describe_film(const std::filesystem::path& path)
{
    const FilmFile file(path);
    const Film film = file.read();
    const RenderSettings& settings = film.key().settings;
    const std::uint64_t planned = planned_number(file.attributes(), planned_samples_attribute);
    ordered_json info;
    info["file"] = path.string();
    info["size"] = {settings.width, settings.height};
    info["file_bytes"] = file.size_bytes();
    info["samples_per_pixel"] = film.samples_per_pixel();
    info["samples"] = ranges_json(film.samples());
    if (planned > 0) {
        info["planned_samples"] = planned;
        info["missing"] = ranges_json(missing_samples(film.samples(), planned));
    }
    info["dropped_samples"] = film.invalid_samples();
    info["seed"] = settings.seed;
    info["layers"] = layers_json(file.channels());
    info["scene_fingerprint"] = film.key().scene;
    info["settings"] = film.key().text();
    if (film.samples_per_pixel() >= 2) {
        const FilmNoise noise = film_noise(film);
        info["noise"] = {{"standard_error", noise.standard_error}, {"mean", noise.mean}};
    }
    if (const std::optional<ImageError> error = estimate_error(film)) {
        const ErrorReport report{*error, ErrorMetric::relative, film.samples_per_pixel()};
        info["error"] = error_json(report);
        info["error"].erase("event");
        info["error"]["text"] = error_text(report);
    }
    info["attributes"] = file.attributes();
    return info;
}

void print_film_text(const ordered_json& info)
{
    const auto line = [](const std::string& name, const std::string& value) {
        write_stdout(fmt::format("{:<16} {}\n", name, value));
    };
    const auto ranges = [&](const char* name) {
        return sample_ranges_text(info[name].get<std::vector<SampleRange>>());
    };
    line("film", info["file"]);
    line("size",
         fmt::format("{}x{}, {:.1f} MB", int(info["size"][0]), int(info["size"][1]), double(info["file_bytes"]) / 1e6));
    line("samples", fmt::format("{} per pixel: {}", std::uint64_t(info["samples_per_pixel"]), ranges("samples")));
    if (info.contains("missing"))
        line("planned", fmt::format("{}{}", std::uint64_t(info["planned_samples"]),
                                    info["missing"].empty() ? ", complete" : "; missing: " + ranges("missing")));
    line("dropped samples", fmt::format("{}", std::uint64_t(info["dropped_samples"])));
    if (info.contains("noise"))
        line("noise", fmt::format("standard error {:.3g}, mean {:.3g}", double(info["noise"]["standard_error"]),
                                  double(info["noise"]["mean"])));
    if (info.contains("error")) line("error", info["error"]["text"]);
    line("layers", fmt::format("{}", fmt::join(info["layers"].get<std::vector<std::string>>(), ", ")));
    line("seed", fmt::format("{}", std::uint64_t(info["seed"])));
    line("scene", info["scene_fingerprint"]);
    for (const auto& [name, value] : info["attributes"].items()) line(name, value);
}

}  // namespace fathom::cli
