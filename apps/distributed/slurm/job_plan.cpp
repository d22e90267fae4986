// SPDX-License-Identifier: Apache-2.0
#include "distributed/slurm/job_plan.h"

#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "base/text_file.h"
#include "fathom/error.h"
#include "fathom/film_file.h"
#include "options/sample_plan.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr const char* plan_file = "plan.json";
constexpr int plan_version = 1;

std::vector<std::string> to_strings(const std::vector<fs::path>& paths)
{
    return {paths.begin(), paths.end()};
}

std::string quoted(const std::vector<std::string>& words)
{
    return words.empty() ? "none" : fmt::format("'{}'", fmt::join(words, " "));
}

double number_attribute(const std::map<std::string, std::string>& attributes, const char* name)
{
    const auto found = attributes.find(name);
    return found == attributes.end() ? 0 : std::strtod(found->second.c_str(), nullptr);
}

/// Whether a text is a job number or empty: it becomes a word of a command.
bool is_job_number(const std::string& text)
{
    return text.find_first_not_of("0123456789") == std::string::npos;
}

std::uint64_t read_count(const ordered_json& json, const char* name)
{
    const ordered_json& number = json.at(name);
    if (!number.is_number_unsigned()) throw Error("", name, fmt::format("is {}, not a whole number", number.dump()));
    return number;
}

JobPlan parse_plan(const ordered_json& json)
{
    if (json.at("version") != plan_version)
        throw Error("", "version",
                    fmt::format("is {}, this program reads {}", json.at("version").dump(), plan_version));
    JobPlan plan;
    plan.program = json.at("program");
    plan.scene = std::string(json.at("scene"));
    json.at("render_options").get_to(plan.render_options);
    json.at("image_options").get_to(plan.merge_options);
    for (const ordered_json& output : json.at("outputs")) plan.outputs.emplace_back(std::string(output));
    plan.parts = read_count(json, "parts");
    plan.samples = read_count(json, "samples");
    json.at("scheduler_options").get_to(plan.scheduler_options);
    for (const ordered_json& s : json.at("submissions")) plan.submissions.push_back({s.at("array"), s.at("merge")});
    for (const Submission& s : plan.submissions)
        if (!is_job_number(s.array) || !is_job_number(s.merge))
            throw Error("", "submissions", "has an invalid job number");
    if (plan.outputs.empty() || plan.parts < 1 || plan.samples < plan.parts || plan.samples > max_samples)
        throw Error("", "", "its numbers of parts and samples do not fit");
    return plan;
}

}  // namespace

fs::path JobPlan::folder_of(const fs::path& image)
{
    return fs::absolute(image).lexically_normal().string() + ".parts";
}

fs::path JobPlan::film_of(std::uint64_t part) const
{
    return folder() / fmt::format("part-{:04}.exr", part);
}

SampleRange JobPlan::samples_of(std::uint64_t part) const
{
    return samples_of_part({part, parts}, samples);
}

JobPlan JobPlan::read(const fs::path& folder)
{
    const fs::path file = folder / plan_file;
    std::ifstream stream(file);
    if (!stream) throw Error(file.string(), "", "no such job: submit it first");
    try {
        return parse_plan(ordered_json::parse(stream));
    } catch (const ordered_json::exception& error) {
        throw Error(file.string(), "", fmt::format("is no valid job plan: {}", error.what()));
    } catch (const Error& error) {
        throw Error(file.string(), error.place(), error.message());
    }
}

void JobPlan::write() const
{
    ordered_json json;
    json["version"] = plan_version;
    json["program"] = program;
    json["scene"] = scene.string();
    json["render_options"] = render_options;
    json["image_options"] = merge_options;
    json["outputs"] = to_strings(outputs);
    json["parts"] = parts;
    json["samples"] = samples;
    json["scheduler_options"] = scheduler_options;
    json["submissions"] = ordered_json::array();
    for (const Submission& s : submissions) json["submissions"].push_back({{"array", s.array}, {"merge", s.merge}});
    write_text_file(folder() / plan_file, json.dump(1) + "\n");
}

std::string JobPlan::difference(const JobPlan& other) const
{
    if (scene != other.scene) return fmt::format("scene {}, not {}", scene.string(), other.scene.string());
    if (samples != other.samples) return fmt::format("{} samples per pixel, not {}", samples, other.samples);
    if (parts != other.parts) return fmt::format("{} parts, not {}", parts, other.parts);
    if (render_options != other.render_options)
        return fmt::format("options {}, not {}", quoted(render_options), quoted(other.render_options));
    return "";
}

PartFilm read_part(const JobPlan& plan, std::uint64_t part)
{
    PartFilm found;
    const fs::path file = plan.film_of(part);
    std::error_code error;
    if (!fs::exists(file, error)) return found;
    try {
        const FilmFile film(file);
        const SampleRange wanted = plan.samples_of(part);
        for (const SampleRange& r : film.samples()) {
            const std::uint64_t first = std::max(r.first, wanted.first), last = std::min(r.second, wanted.second);
            if (first < last) found.samples += last - first;
        }
        found.noise = number_attribute(film.attributes(), noise_attribute);
        found.samples_per_s = number_attribute(film.attributes(), samples_per_s_attribute);
    } catch (const Error& problem) {
        found.error = problem.message();
    }
    return found;
}

std::string number_ranges_text(const std::vector<std::uint64_t>& ascending)
{
    std::vector<std::string> runs;
    for (std::size_t i = 0; i < ascending.size();) {
        std::size_t last = i;
        while (last + 1 < ascending.size() && ascending[last + 1] == ascending[last] + 1) ++last;
        runs.push_back(last == i ? fmt::format("{}", ascending[i])
                                 : fmt::format("{}-{}", ascending[i], ascending[last]));
        i = last + 1;
    }
    return fmt::format("{}", fmt::join(runs, ","));
}

}  // namespace fathom::cli
