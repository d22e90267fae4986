// SPDX-License-Identifier: Apache-2.0
#include "options/config_file.h"

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>

#include "commands/commands.h"
#include "fathom/error.h"

namespace fathom::cli {

namespace {

constexpr const char* config_option = "--config";

std::string trimmed(const std::string& text)
{
    const std::size_t begin = text.find_first_not_of(" \t\r"), end = text.find_last_not_of(" \t\r");
    return begin == std::string::npos ? "" : text.substr(begin, end + 1 - begin);
}

/// The text without quotation marks around it.
std::string unquoted(const std::string& text)
{
    const bool is_quoted = text.size() >= 2 && (text[0] == '"' || text[0] == '\'') && text.back() == text[0];
    return is_quoted ? text.substr(1, text.size() - 2) : text;
}

/// The line up to a `#` that begins a word; colors such as #808080 must be quoted.
std::string without_comment(const std::string& line)
{
    char quote = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (quote ? line[i] == quote : line[i] == '"' || line[i] == '\'')
            quote = quote ? 0 : line[i];
        else if (!quote && line[i] == '#' && (i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t'))
            return line.substr(0, i);
    }
    return line;
}

/// Whether the command line gives this option: by a name, joined with a value by `=`, or behind a short name.
bool is_given(const OptionTable& option, const std::vector<std::string>& words)
{
    return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
        return std::any_of(option.names.begin(), option.names.end(), [&](const std::string& name) {
            return word == name || word.starts_with(name.starts_with("--") ? name + "=" : name);
        });
    });
}

class ConfigFile {
public:
    ConfigFile(const std::string& file, const CommandTable& command) : file_(file), command_(command) {}

    /// Options of the file as words, without those that `words` has.
    std::vector<std::string> options(const std::vector<std::string>& words) const
    {
        std::vector<std::string> result;
        std::ifstream lines(file_);
        if (!lines) throw Error(file_, "", "can't be read: " + std::generic_category().message(errno));
        std::string line;
        for (int number = 1; std::getline(lines, line); ++number) {
            line = trimmed(without_comment(line));
            if (!line.empty()) add(line, number, words, result);
        }
        return result;
    }

private:
    void add(const std::string& line, int number, const std::vector<std::string>& words,
             std::vector<std::string>& result) const
    {
        const std::size_t equals = line.find('=');
        if (equals == std::string::npos) fail(number, fmt::format("expected NAME = VALUE, found '{}'", line));
        const std::string name = "--" + trimmed(line.substr(0, equals));
        const std::string value = unquoted(trimmed(line.substr(equals + 1)));
        const auto option = std::find_if(command_.options.begin(), command_.options.end(), [&](const OptionTable& o) {
            return std::find(o.names.begin(), o.names.end(), name) != o.names.end();
        });
        if (option == command_.options.end() || name == config_option)
            fail(number, fmt::format("'{}' is no option of fathom {}", name.substr(2), command_.name));
        if (!is_given(*option, words)) result.push_back(name + "=" + value);
    }

    [[noreturn]] void fail(int number, const std::string& text) const
    {
        throw UsageError(fmt::format("{}:{}: {}", file_, number, text));
    }

    const std::string& file_;
    const CommandTable& command_;
};

}  // namespace

std::vector<std::string> with_config_file(std::vector<std::string> words, const std::vector<CommandTable>& commands)
{
    const auto given = std::find_if(words.begin(), words.end(), [](const std::string& word) {
        return word == config_option || word.starts_with(std::string(config_option) + "=");
    });
    const auto command = std::find_if(commands.begin(), commands.end(), [&](const CommandTable& table) {
        return !words.empty() && table.name == words.front();
    });
    if (given == words.end() || command == commands.end()) return words;
    const bool is_joined = *given != config_option;
    if (!is_joined && given + 1 == words.end()) throw UsageError("--config: expected the name of a file");
    const std::string file = is_joined ? given->substr(std::string(config_option).size() + 1) : *(given + 1);
    const auto behind = words.erase(given, given + (is_joined ? 1 : 2));
    const std::vector<std::string> options = ConfigFile(file, *command).options(words);
    words.insert(behind, options.begin(), options.end());
    return words;
}

}  // namespace fathom::cli
