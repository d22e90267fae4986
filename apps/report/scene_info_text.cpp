// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>

#include "fathom/memory.h"
#include "process/streams.h"
#include "report/scene_info.h"

namespace fathom::cli {

namespace {

using nlohmann::ordered_json;

/// Rows of a table in text; --json has all.
constexpr std::size_t max_rows = 30;

void print_line(const std::string& name, const std::string& value)
{
    write_stdout(fmt::format("{:<16} {}\n", name, value));
}

/// A file size, in kB where memory_text() would round it to 0 MB.
std::string size_text(const ordered_json& bytes)
{
    return bytes < 1e6 ? fmt::format("{:.1f} kB", double(bytes) / 1e3) : memory_text(double(bytes));
}

std::string name_of(const ordered_json& value)
{
    const std::string name = value["name"];
    return name.empty() ? "unnamed" : name;
}

/// Names and kinds, with the numbers by which options choose them if there are several.
std::string choices_text(const ordered_json& values, const char* key)
{
    std::vector<std::string> texts;
    for (const auto& value : values) {
        const std::string number = values.size() > 1 ? fmt::format("{}: ", texts.size()) : "";
        texts.push_back(fmt::format("{}{} ({})", number, name_of(value), std::string(value[key])));
    }
    if (texts.size() > max_rows)
        texts.back() = fmt::format("and {} more", texts.size() - max_rows),
        texts.erase(texts.begin() + max_rows, texts.end() - 1);
    return texts.empty() ? "none" : fmt::format("{}", fmt::join(texts, ", "));
}

/// Prints the rows of a table, with `name` in front of the first.
void print_table(const std::string& name, const std::vector<std::string>& rows)
{
    for (std::size_t i = 0; i < rows.size() && i < max_rows; ++i) print_line(i == 0 ? name : "", rows[i]);
    if (rows.size() > max_rows) print_line("", fmt::format("and {} more, see --json", rows.size() - max_rows));
}

void print_files(const ordered_json& info)
{
    print_line("file", info["file"]);
    print_line("format", info["format"]);
    std::vector<std::string> files;
    for (const auto& file : info["files"])
        files.push_back(fmt::format("{:>8}  {}", size_text(file["bytes"]), std::string(file["file"])));
    print_table("files read", files);
}

void print_bounds(const ordered_json& info)
{
    if (!info.contains("bounds")) return print_line("bounds", "empty");
    const auto triple = [&](const char* which, const char* between) {
        const auto& v = info["bounds"][which];
        return fmt::format("{1:.6g}{0}{2:.6g}{0}{3:.6g}", between, double(v[0]), double(v[1]), double(v[2]));
    };
    print_line("bounds",
               fmt::format("({}) to ({}): {} m", triple("min", ", "), triple("max", ", "), triple("size", " x ")));
}

void print_materials(const ordered_json& materials)
{
    std::map<std::string, std::size_t> kinds;
    for (const auto& material : materials) ++kinds[material["kind"]];
    std::vector<std::string> sums;
    sums.reserve(kinds.size());
    for (const auto& [kind, times] : kinds) sums.push_back(fmt::format("{} {}", times, kind));
    if (materials.empty()) return;
    std::vector<std::string> rows;
    for (const auto& m : materials) {
        if (m["shapes"] == 0) continue;
        const std::vector<std::string> uses = m["uses"];
        rows.push_back(fmt::format("{:<24} {:<10} {:>6}  {}", name_of(m), std::string(m["kind"]),
                                   std::size_t(m["shapes"]), fmt::join(uses, ", ")));
    }
    const std::size_t unused = materials.size() - rows.size();
    print_line("materials", fmt::format("{}: {}{}", materials.size(), fmt::join(sums, ", "),
                                        unused > 0 ? fmt::format("; {} unused", unused) : ""));
    print_table("  used", rows);
}

void print_images(const ordered_json& images)
{
    std::vector<std::string> rows;
    for (const auto& image : images) {
        const std::string size = image.contains("size") ? fmt::format("{}x{}", std::uint64_t(image["size"][0]),
                                                                      std::uint64_t(image["size"][1]))
                                                        : "";
        const std::string bytes = image.contains("bytes") ? size_text(image["bytes"]) : "";
        const std::string problem = image.contains("problem") ? ": " + std::string(image["problem"]) : "";
        rows.push_back(fmt::format("{:>11} {:>8}  {}{}{}", size, bytes, name_of(image),
                                   image["inside"] ? " (inside the file)" : "", problem));
    }
    print_table("images", rows);
}

void print_choices(const ordered_json& info)
{
    for (const char* choice : {"scenes", "variants"}) {
        const std::vector<std::string> names = info[choice];
        // A file with a single scene needs no list of scenes.
        if (names.size() > (choice == std::string("scenes") ? 1u : 0u))
            print_line(choice, fmt::format("{}", fmt::join(names, ", ")));
    }
    const auto& animations = info["animations"];
    for (std::size_t i = 0; i < animations.size(); ++i)
        print_line(i == 0 ? "animations" : "",
                   fmt::format("{}: {} ({:.3g} s; --at SECONDS, --frames A:B)", i, std::string(animations[i]["name"]),
                               double(animations[i]["duration_s"])));
}

void print_settings(const ordered_json& settings)
{
    std::vector<std::string> texts;
    for (const auto& [key, value] : settings.items()) texts.push_back(fmt::format("{} {}", key, value.dump()));
    if (!texts.empty()) print_line("settings", fmt::format("{}", fmt::join(texts, ", ")));
}

void print_warnings(const ordered_json& warnings)
{
    for (const auto& w : warnings)
        print_line("warning", fmt::format("{}{}", std::string(w["message"]),
                                          w["count"] > 1 ? fmt::format(" ({} times)", std::uint64_t(w["count"])) : ""));
    if (warnings.empty()) print_line("ignored", "nothing");
}

}  // namespace

void print_scene_text(const ordered_json& info)
{
    print_files(info);
    // Cameras, lights, materials and images are listed by name below.
    for (const auto& [name, value] : info["counts"].items())
        if (value != 0 && name != "cameras" && name != "lights" && name != "materials" && name != "images")
            print_line(name, fmt::format("{}", std::uint64_t(value)));
    print_bounds(info);
    print_line("cameras", choices_text(info["cameras"], "kind"));
    print_line("lights", choices_text(info["lights"], "kind"));
    print_line("environment", info["environment"]);
    print_materials(info["materials"]);
    print_images(info["images"]);
    print_choices(info);
    print_settings(info["settings"]);
    for (const auto& added : info["added"]) print_line("added to render", added);
    if (info.contains("compiled")) {
        const auto& c = info["compiled"];
        print_line("memory", fmt::format("{} compiled, built in {:.3f} s", memory_text(double(c["memory_bytes"])),
                                         double(c["build_s"])));
    } else {
        print_line("not renderable", info["not renderable"]);
    }
    print_warnings(info["warnings"]);
}

}  // namespace fathom::cli
