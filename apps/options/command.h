// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
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

/// The texts of a command in --help and in docs/cli.md.
struct CommandText {
    const char *name, *description;
    const char* footer;  ///< examples and exit codes
};

/// One command and its options. CLI11 takes seconds to compile, so only command.cpp and program.cpp include it.
class Command {
public:
    Command(CLI::App& program, const CommandText& text);

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
    /// A repeatable option that names an output file; `-` is the standard output.
    void add_files(const OptionText& text, std::vector<std::filesystem::path>& files);
    /// Required arguments without a name: exactly one file, of which `-` is the standard input,
    /// or at least one.
    void add_positional(const std::string& name, std::filesystem::path& file, const std::string& help);
    void add_positionals(const std::string& name, std::vector<std::filesystem::path>& files, const std::string& help);

    /// Descriptions of the options added so far, positional arguments excluded.
    const std::vector<OptionText>& texts() const { return texts_; }
    /// Number of options added so far.
    std::size_t option_count() const;
    /// The given options from number `first` to before `last`, spelled as words of a command line. Positional arguments
    /// and options of add_files are left out.
    std::vector<std::string> given_options(std::size_t first, std::size_t last) const;

    /// Assigns `action` to `run` if the command line names this command.
    void set_run(Run& run, Run action);

private:
    CLI::Option& described(CLI::Option* option, const OptionText& text);

    CLI::App& app_;
    std::string group_ = "Options";
    std::vector<const CLI::Option*> file_lists_;  ///< created by add_files
    std::vector<OptionText> texts_;
};

/// Adds a command that fills options of its own and runs with them.
template <class Options, class RunCommand>
void add_command(CLI::App& program, Run& run, const CommandText& text, void (*add_options)(Command&, Options&),
                 RunCommand run_command)
{
    const auto options = std::make_shared<Options>();
    Command command(program, text);
    add_options(command, *options);
    command.set_run(run, [options, run_command] { return run_command(*options); });
}

/// Options that several commands have, in the group for reporting.
void add_json_option(Command& command, bool& json);
void add_quiet_option(Command& command, bool& quiet);

}  // namespace fathom::cli
