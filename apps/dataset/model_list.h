// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "options/sample_plan.h"

namespace fathom::cli {

/// A model of a list, and the name of its folder.
struct ListedModel {
    std::filesystem::path file;
    std::string name;
};
/// Reads a list of models: one path a line, relative to the folder of the list; empty lines and lines that begin with
/// '#' don't count. A model is named by its file, and by its folder, too, where several files have one name. Throws
/// Error if the list can't be read or is empty, or two models would get the same name.
std::vector<ListedModel> read_model_list(const std::filesystem::path& list);

/// The models of one part: every `count`-th of them.
std::vector<ListedModel> models_of_part(const std::vector<ListedModel>& models, std::optional<PartNumber> part);

/// The log of a folder of data sets, one JSON object a line: which models were started, done, and failed.
class ModelLog {
public:
    /// Opens the log for appending. Parts have logs of their own, since they may run on several machines.
    ModelLog(const std::filesystem::path& folder, std::optional<PartNumber> part);

    /// How often earlier processes ended while this model was being read or rendered.
    int unfinished_starts(const std::string& name) const;
    void started(const ListedModel& model);
    void done(const ListedModel& model, const nlohmann::ordered_json& details);
    /// ended_process  the model ends the process, so later runs leave it out
    void failed(const ListedModel& model, const std::string& error, bool ended_process = false);
    /// A model that an interrupt left unfinished, which says nothing against it.
    void interrupted(const ListedModel& model);
    const std::filesystem::path& file() const { return file_; }

private:
    void read_earlier();
    void append(const ListedModel& model, const char* status, const nlohmann::ordered_json& details);

    std::filesystem::path file_;
    std::map<std::string, int> unfinished_;
    std::ofstream stream_;
};

}  // namespace fathom::cli
