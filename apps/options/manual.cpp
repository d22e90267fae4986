// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "options/command_tables.h"

namespace fathom::cli {

namespace {

/// Escapes text for troff: backslashes, dashes, and a dot or quote at the beginning of a line.
std::string roff(const std::string& text)
{
    std::string result;
    bool at_begin = true;
    for (const char c : text) {
        if (at_begin && (c == '.' || c == '\'')) result += "\\&";
        if (c == '\\')
            result += "\\e";
        else if (c == '-')
            result += "\\-";
        else
            result += c;
        at_begin = c == '\n';
    }
    return result;
}

std::string option_entry(const OptionTable& option)
{
    std::string text = ".TP\n.B " + roff(fmt::format("{}", fmt::join(option.names, ", ")));
    if (!option.value.empty()) text += " \\fI" + roff(option.value) + "\\fR";
    text += "\n" + roff(option.help) + ".";
    if (!option.default_text.empty()) text += "\nDefault: " + roff(option.default_text) + ".";
    return text + "\n";
}

std::string command_section(const CommandTable& command)
{
    std::string text = fmt::format(".SH \"fathom {}\"\n{}.\n", command.name, roff(command.description));
    for (const OptionTable& argument : command.arguments) text += option_entry(argument);
    std::string group;
    for (const OptionTable& option : command.options) {
        if (option.group != group) text += fmt::format(".SS {}\n", roff(group = option.group));
        text += option_entry(option);
    }
    return text + ".PP\n.nf\n" + roff(command.footer) + "\n.fi\n";
}

}  // namespace

std::string manual_page(const std::vector<CommandTable>& commands, const std::string& version)
{
    std::string text = fmt::format(
        ".TH FATHOM 1 \"\" \"fathom {}\" \"User Commands\"\n"
        ".SH NAME\nfathom \\- render 3D models to physically correct images\n"
        ".SH SYNOPSIS\n.B fathom\n\\fICOMMAND\\fR [\\fIOPTION\\fR]... \\fIFILE\\fR...\n"
        ".SH DESCRIPTION\nFathom is a path tracer for CPUs. An option overrides what the scene file says.\n",
        version);
    for (const CommandTable& command : commands)
        text += fmt::format(".TP\n.B fathom {}\n{}.\n", command.name, roff(command.description));
    for (const CommandTable& command : commands) text += command_section(command);
    return text +
           ".SH EXIT STATUS\n.TP\n0\nsuccess\n.TP\n1\nan error in a file, in the scene or on the machine\n"
           ".TP\n2\nwrong usage\n.TP\n130\ninterrupted; the image so far is written\n"
           ".SH ENVIRONMENT\n.TP\n.B FATHOM_KERNEL\navx512, avx2 or base: the kernel to use, in place of the best one "
           "for the processor.\n"
           ".TP\n.B FATHOM_OIDN\nThe library of Open Image Denoise 2, or a folder that contains it.\n"
           ".TP\n.B OCIO\nThe OpenColorIO configuration of \\-\\-ocio env.\n";
}

}  // namespace fathom::cli
