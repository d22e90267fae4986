// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "commands/commands.h"
#include "options/command_tables.h"

namespace fathom::cli {

namespace {

/// Text in single quotes, for all three shells.
std::string quoted(const std::string& text)
{
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

std::string names_of(const std::vector<CommandTable>& commands)
{
    std::vector<std::string> names;
    for (const CommandTable& command : commands) names.push_back(command.name);
    return fmt::format("{}", fmt::join(names, " "));
}

/// Returns the shell code by which bash proposes values of an option.
std::string bash_values(const OptionTable& option)
{
    if (const auto words = option.choices(); !words.empty())
        return fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$word\"))", fmt::join(words, " "));
    return option.takes_file() ? "COMPREPLY=($(compgen -f -- \"$word\"))" : "COMPREPLY=()";
}

std::string bash_command(const CommandTable& command)
{
    std::string values, names;
    for (const OptionTable& option : command.options) {
        names += fmt::format("{}{}", names.empty() ? "" : " ", fmt::join(option.names, " "));
        if (option.value.empty()) continue;
        values += fmt::format("        {}) {}; return ;;\n", fmt::join(option.names, "|"), bash_values(option));
    }
    return fmt::format("    {}) options='{}'\n        case $previous in\n{}        esac ;;\n", command.name, names,
                       values);
}

std::string bash_script(const std::vector<CommandTable>& commands)
{
    std::string cases;
    for (const CommandTable& command : commands) cases += bash_command(command);
    return "# bash completion of fathom: source this, or put it into /usr/share/bash-completion/completions/fathom\n"
           "_fathom() {\n"
           "    local IFS=$' \\t\\n' word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} options=''\n"
           "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
           "        COMPREPLY=($(compgen -W '" +
           names_of(commands) +
           " --help --version' -- \"$word\")); return\n"
           "    fi\n"
           "    case ${COMP_WORDS[1]} in\n" +
           cases +
           "    esac\n"
           "    if [[ $word = -* ]]; then COMPREPLY=($(compgen -W \"$options\" -- \"$word\")); return; fi\n"
           "    IFS=$'\\n' COMPREPLY=($(compgen -f -- \"$word\"))\n"
           "}\n"
           "complete -o filenames -F _fathom fathom\n";
}

/// Escapes the characters that separate the parts of an argument of zsh's _arguments.
std::string zsh_text(const std::string& text)
{
    std::string result;
    for (const char c : text) {
        if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
        result += c;
    }
    return result;
}

std::string zsh_option(const OptionTable& option)
{
    std::string value;
    if (!option.value.empty()) {
        const auto words = option.choices();
        const std::string action = !words.empty()        ? fmt::format("({})", fmt::join(words, " "))
                                   : option.takes_file() ? "_files"
                                                         : " ";
        value = fmt::format(":{}:{}", zsh_text(option.value), action);
    }
    std::string lines;
    for (const std::string& name : option.names)
        lines += " \\\n            " +
                 quoted(fmt::format("*{}{}[{}]{}", name, value.empty() || !name.starts_with("--") ? "" : "=",
                                    zsh_text(option.short_help()), value));
    return lines;
}

std::string zsh_script(const std::vector<CommandTable>& commands)
{
    std::string list, cases;
    for (const CommandTable& command : commands) {
        list += "        " + quoted(command.name + ":" + zsh_text(command.description)) + "\n";
        cases += fmt::format("        {}) _arguments", command.name);
        for (const OptionTable& option : command.options) cases += zsh_option(option);
        cases += command.arguments.empty() ? " ;;\n" : " \\\n            '*:file:_files' ;;\n";
    }
    return "#compdef fathom\n"
           "# zsh completion of fathom: source this, or put it into a folder of $fpath as _fathom\n"
           "_fathom() {\n"
           "    local -a commands=(\n" +
           list +
           "    )\n"
           "    if (( CURRENT == 2 )); then _describe command commands; return; fi\n"
           "    local name=$words[2]\n"
           "    shift words\n"
           "    (( CURRENT-- ))\n"
           "    case $name in\n" +
           cases +
           "    esac\n"
           "}\n"
           "if [ \"$funcstack[1]\" = _fathom ]; then _fathom \"$@\"; else compdef _fathom fathom; fi\n";
}

std::string fish_option(const std::string& command, const OptionTable& option)
{
    std::string line = fmt::format("complete -c fathom -n '__fish_seen_subcommand_from {}'", command);
    for (const std::string& name : option.names)
        line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (const auto words = option.choices(); !words.empty())
        line += fmt::format(" -x -a '{}'", fmt::join(words, " "));
    else if (!option.value.empty())
        line += option.takes_file() ? " -r -F" : " -x";
    std::string help;
    for (const char c : option.short_help()) help += c == '\'' ? std::string("\\'") : std::string(1, c);
    return line + " -d '" + help + "'\n";
}

std::string fish_script(const std::vector<CommandTable>& commands)
{
    std::string script = "# fish completion of fathom: put this into ~/.config/fish/completions/fathom.fish\n";
    for (const CommandTable& command : commands) {
        script += fmt::format("complete -c fathom -f -n __fish_use_subcommand -a {} -d '{}'\n", command.name,
                              command.description);
        for (const OptionTable& option : command.options) script += fish_option(command.name, option);
    }
    return script;
}

}  // namespace

std::string completion_script(const std::vector<CommandTable>& commands, const std::string& shell)
{
    if (shell == "bash") return bash_script(commands);
    if (shell == "zsh") return zsh_script(commands);
    if (shell == "fish") return fish_script(commands);
    throw UsageError(fmt::format("expected bash, zsh or fish, found '{}'", shell));
}

}  // namespace fathom::cli
