// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>

#include "commands/commands.h"
#include "options/command.h"
#include "options/command_tables.h"
#include "process/streams.h"

namespace fathom::cli {

void add_completion(CLI::App& program, Run& run)
{
    const auto shell = std::make_shared<std::filesystem::path>();
    Command command(program,
                    {"completion", "Print a script that completes commands and options in a shell",
                     "Examples:\n"
                     "  source <(fathom completion bash)         in this shell; for good: add it to ~/.bashrc\n"
                     "  source <(fathom completion zsh)          for good: add it to ~/.zshrc after compinit\n"
                     "  fathom completion fish >~/.config/fish/completions/fathom.fish\n\n"
                     "Exit codes: 0 success; 1 error; 2 wrong usage."});
    command.add_positional("SHELL", *shell, "bash, zsh or fish");
    command.set_run(run, [&program, shell] {
        write_stdout(completion_script(command_tables(program), shell->string()));
        return exit_ok;
    });
}

void add_man(CLI::App& program, Run& run)
{
    Command command(program, {"man", "Print the manual page",
                              "Example:\n  fathom man | man -l -\n\nExit codes: 0 success; 1 error; 2 wrong usage."});
    command.set_run(run, [&program] {
        write_stdout(manual_page(command_tables(program), FATHOM_VERSION));
        return exit_ok;
    });
}

}  // namespace fathom::cli
