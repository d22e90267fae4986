// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "commands/commands.h"

namespace fathom::cli {

/// The description of an option, printed by --help and in docs/cli.md.
struct OptionText {
    std::string name;          ///< "-o,--output"
    std::string value;         ///< "FILE"; empty for a flag
    std::string help;          ///< what the option does
    std::string default_text;  ///< what holds without the option; empty: nothing to say
};

/// One command and its options. CLI11 takes seconds to compile, so only command.cpp and program.cpp include it.
class Command {
public:
    Command(CLI::App& program, const std::string& name, const std::string& description);

    /// Options added from here on are listed under this heading.
    void begin_group(const std::string& heading) { group_ = heading; }

    using ValueHandler = std::function<void(const std::string&)>;
    /// An option with one value. UsageErrors of the handler get the option's name in front.
    void add_value(const OptionText& text, ValueHandler handler);
    /// A repeatable option: the handler is called once for each value.
    void add_values(const OptionText& text, ValueHandler handler);
    void add_flag(const OptionText& text, bool& flag);
    /// A flag with an optional word, NAME=WORD. The handler gets "true" where no word is given.
    void add_flag_or_word(const OptionText& text, ValueHandler handler);
    /// A repeatable option that names a file.
    void add_files(const OptionText& text, std::vector<std::filesystem::path>& files);
    /// Required arguments without a name: exactly one file, or at least one.
    void add_positional(const std::string& name, std::filesystem::path& file, const std::string& help);
    void add_positionals(const std::string& name, std::vector<std::filesystem::path>& files, const std::string& help);

    /// Number of options added so far.
    std::size_t option_count() const;
    /// The given options from number `first` to before `last`, spelled as words of a command line. Positional arguments
    /// and options of add_files are left out.
    std::vector<std::string> given_options(std::size_t first, std::size_t last) const;

    /// Text at the end of --help.
    void set_footer(const std::string& text);
    /// Assigns `action` to `run` if the command line names this command.
    void set_run(Run& run, Run action);

private:
    CLI::Option& described(CLI::Option* option, const OptionText& text) const;

    CLI::App& app_;
    std::string group_ = "Options";
    std::vector<const CLI::Option*> file_lists_;  ///< created by add_files
};

}  // namespace fathom::cli
