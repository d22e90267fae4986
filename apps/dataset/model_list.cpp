// SPDX-License-Identifier: Apache-2.0
#include "dataset/model_list.h"

#include <fmt/format.h>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>

#include "fathom/error.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

std::vector<fs::path> read_paths(const fs::path& list)
{
    std::ifstream stream(list);
    if (!stream) throw Error(list.string(), "", std::string("can't be read: ") + std::strerror(errno));
    std::vector<fs::path> paths;
    for (std::string line; std::getline(stream, line);) {
        while (!line.empty() && std::isspace(static_cast<unsigned char>(line.back()))) line.pop_back();
        if (!line.empty() && line[0] != '#') paths.push_back(list.parent_path() / line);
    }
    if (paths.empty()) throw Error(list.string(), "", "the list contains no model");
    return paths;
}

}  // namespace

std::vector<ListedModel> read_model_list(const fs::path& list)
{
    const std::vector<fs::path> paths = read_paths(list);
    std::map<std::string, int> stems;
    for (const fs::path& path : paths) ++stems[path.stem().string()];
    std::vector<ListedModel> models;
    std::map<std::string, fs::path> names;
    for (const fs::path& path : paths) {
        std::string name = path.stem().string();
        if (stems[name] > 1) name = path.parent_path().filename().string() + "-" + name;
        const auto [known, is_new] = names.try_emplace(name, path);
        if (!is_new)
            throw Error(list.string(), "",
                        fmt::format("{} and {} would both be written to the folder {}", known->second.string(),
                                    path.string(), name));
        models.push_back({path, name});
    }
    return models;
}

std::vector<ListedModel> models_of_part(const std::vector<ListedModel>& models, std::optional<PartNumber> part)
{
    if (!part) return models;
    std::vector<ListedModel> chosen;
    for (std::size_t i = part->number - 1; i < models.size(); i += part->count) chosen.push_back(models[i]);
    return chosen;
}

ModelLog::ModelLog(const fs::path& folder, std::optional<PartNumber> part)
    : file_(folder / (part ? fmt::format("log-{}-of-{}.jsonl", part->number, part->count) : "log.jsonl"))
{
    read_earlier();
    stream_.open(file_, std::ios::app);
    if (!stream_) throw Error(file_.string(), "", std::string("can't write: ") + std::strerror(errno));
}

void ModelLog::read_earlier()
{
    std::ifstream stream(file_);
    for (std::string line; std::getline(stream, line);) {
        const Json entry = Json::parse(line, nullptr, false);
        // The last line is cut off if the disk was full.
        if (!entry.is_object() || !entry.contains("name") || !entry["name"].is_string()) continue;
        const std::string name = entry["name"], status = entry.value("status", "");
        if (status == "started")
            ++unfinished_[name];
        else if (status == "interrupted")
            --unfinished_[name];
        else
            unfinished_[name] = entry.value("ended_process", false) ? 2 : 0;
    }
}

int ModelLog::unfinished_starts(const std::string& name) const
{
    const auto known = unfinished_.find(name);
    return known == unfinished_.end() ? 0 : known->second;
}

void ModelLog::append(const ListedModel& model, const char* status, const Json& details)
{
    Json entry{{"name", model.name}, {"model", model.file.string()}, {"status", status}};
    entry.update(details);
    // Names of files need not be UTF-8.
    stream_ << entry.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
    if (!stream_) throw Error(file_.string(), "", std::string("can't write: ") + std::strerror(errno));
}

void ModelLog::started(const ListedModel& model)
{
    append(model, "started", Json::object());
}
void ModelLog::done(const ListedModel& model, const Json& details)
{
    append(model, "done", details);
}
void ModelLog::failed(const ListedModel& model, const std::string& error, bool ended_process)
{
    Json details{{"error", error}};
    if (ended_process) details["ended_process"] = true;
    append(model, "failed", details);
}
void ModelLog::interrupted(const ListedModel& model)
{
    append(model, "interrupted", Json::object());
}

}  // namespace fathom::cli
