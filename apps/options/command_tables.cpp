// SPDX-License-Identifier: Apache-2.0
#include "options/command_tables.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "options/arguments.h"

namespace fathom::cli {

namespace {

bool is_lower_case_word(const std::string& word)
{
    return !word.empty() && std::none_of(word.begin(), word.end(),
                                         [](unsigned char c) { return std::isupper(c) || c == '.' || c == ','; });
}

OptionTable option_table(const CLI::Option& option)
{
    OptionTable table{
        {}, option.get_type_name(), option.get_description(), option.get_default_str(), option.get_group()};
    table.names = CLI::detail::split(option.get_name(option.get_positional(), true), ',');
    return table;
}

CommandTable command_table(const CLI::App& command)
{
    CommandTable table{command.get_name(), command.get_description(), command.get_footer(), {}, {}};
    for (const CLI::Option* option : command.get_options())
        (option->get_positional() ? table.arguments : table.options).push_back(option_table(*option));
    return table;
}

}  // namespace

std::vector<std::string> OptionTable::choices() const
{
    std::vector<std::string> words;
    if (value.find('|') == std::string::npos) return words;
    for (const std::string& word : split(value, '|'))
        if (is_lower_case_word(word)) words.push_back(word);
    return words;
}

bool OptionTable::takes_file() const
{
    const std::vector<std::string> words = split(value, '|');
    return std::any_of(words.begin(), words.end(),
                       [](const std::string& word) { return word == "FILE" || word == "FOLDER" || word == "CONFIG"; });
}

std::string OptionTable::short_help() const
{
    const std::size_t end = help.find_first_of(";:(");
    std::string text = help.substr(0, end);
    while (text.ends_with(' ')) text.pop_back();
    return text;
}

std::vector<CommandTable> command_tables(const CLI::App& program)
{
    std::vector<CommandTable> tables;
    for (const CLI::App* command : program.get_subcommands({})) tables.push_back(command_table(*command));
    return tables;
}

}  // namespace fathom::cli
