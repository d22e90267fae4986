// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace fathom::cli {

/// An option or argument of a command, as --help lists it.
struct OptionTable {
    std::vector<std::string> names;  ///< "-o", "--output"; of an argument: its name
    std::string value;               ///< "FILE", or "fast|high" for a choice; empty for a flag
    std::string help, default_text;
    std::string group;  ///< heading in --help

    /// The words of `value` that can be typed as they are; they are in lower case.
    std::vector<std::string> choices() const;
    bool takes_file() const;
    /// The help up to the first semicolon, colon or parenthesis.
    std::string short_help() const;
};

/// A command with its texts and options.
struct CommandTable {
    std::string name, description, footer;
    std::vector<OptionTable> arguments, options;
};

/// All commands of the program, in the order of --help. Completion and the manual page are made of these tables.
std::vector<CommandTable> command_tables(const CLI::App& program);

/// The script that completes commands and options in a shell: bash, zsh or fish. Throws UsageError for another shell.
std::string completion_script(const std::vector<CommandTable>& commands, const std::string& shell);

/// The manual page in the macros of man(7).
std::string manual_page(const std::vector<CommandTable>& commands, const std::string& version);

}  // namespace fathom::cli
