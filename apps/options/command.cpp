// SPDX-License-Identifier: Apache-2.0
#include "options/command.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <algorithm>

namespace fathom::cli {

namespace {

/// Wraps descriptions, and appends the default to them.
class HelpFormatter : public CLI::Formatter {
public:
    HelpFormatter() { column_width(name_columns); }

    std::string make_option_desc(const CLI::Option* option) const override
    {
        std::string text = option->get_description();
        if (!option->get_default_str().empty()) text += fmt::format(" (default: {})", option->get_default_str());
        return wrapped(text);
    }
    /// Omits the default, which CLI11 would print behind the name.
    std::string make_option_opts(const CLI::Option* option) const override
    {
        if (option->get_positional()) return "";
        return option->get_type_name().empty() ? "" : " " + option->get_type_name();
    }

private:
    static constexpr std::size_t name_columns = 30, text_columns = 70;

    static std::string wrapped(const std::string& text)
    {
        std::string result;
        std::size_t line_begin = 0;
        while (text.size() - line_begin > text_columns) {
            std::size_t space = text.rfind(' ', line_begin + text_columns);
            if (space == std::string::npos || space <= line_begin) space = text.find(' ', line_begin);
            if (space == std::string::npos) break;
            result += text.substr(line_begin, space - line_begin) + '\n';
            line_begin = space + 1;
        }
        return result + text.substr(line_begin);
    }
};

Command::ValueHandler with_option_name(const std::string& name, Command::ValueHandler handler)
{
    return [name, handler = std::move(handler)](const std::string& text) {
        try {
            handler(text);
        } catch (const UsageError& error) {
            throw UsageError(fmt::format("{}: {}", name, error.what()));
        }
    };
}

}  // namespace

Command::Command(CLI::App& program, const CommandText& text)
    : app_(*program.add_subcommand(text.name, text.description))
{
    app_.footer(text.footer);
    app_.formatter(std::make_shared<HelpFormatter>());
    app_.set_help_flag("-h,--help", "print this help and exit");
}

CLI::Option& Command::described(CLI::Option* option, const OptionText& text)
{
    texts_.push_back(text);
    return *option->type_name(text.value)->default_str(text.default_text)->group(group_);
}

void Command::add_value(const OptionText& text, ValueHandler handler)
{
    described(
        app_.add_option_function<std::string>(text.name, with_option_name(text.name, std::move(handler)), text.help),
        text);
}

void Command::add_values(const OptionText& text, ValueHandler handler)
{
    const auto handle_all =
        [one = with_option_name(text.name, std::move(handler))](const std::vector<std::string>& values) {
            for (const std::string& value : values) one(value);
        };
    described(app_.add_option_function<std::vector<std::string>>(text.name, handle_all, text.help), text)
        .expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void Command::add_flag(const OptionText& text, bool& flag)
{
    described(app_.add_flag(text.name, flag, text.help), text);
}

void Command::add_flag_or_word(const OptionText& text, ValueHandler handler)
{
    described(app_.add_flag(text.name, text.help)->each(with_option_name(text.name, std::move(handler))), text);
}

void Command::add_files(const OptionText& text, std::vector<std::filesystem::path>& files)
{
    const auto assign = [&files](const std::vector<std::string>& names) {
        files.clear();
        for (const std::string& file : names) files.emplace_back(file == "-" ? "/dev/stdout" : file);
    };
    CLI::Option& option =
        described(app_.add_option_function<std::vector<std::string>>(text.name, assign, text.help), text);
    option.expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    file_lists_.push_back(&option);
}

void Command::add_positional(const std::string& name, std::filesystem::path& file, const std::string& help)
{
    const auto assign = [&file](const std::string& text) { file = text == "-" ? "/dev/stdin" : text; };
    app_.add_option_function<std::string>(name, assign, help)->required()->type_name("");
}

void Command::add_positionals(const std::string& name, std::vector<std::filesystem::path>& files,
                              const std::string& help)
{
    const auto assign = [&files](const std::vector<std::string>& names) { files.assign(names.begin(), names.end()); };
    app_.add_option_function<std::vector<std::string>>(name, assign, help)->required()->type_name("");
}

std::size_t Command::option_count() const
{
    return app_.get_options().size();
}

std::vector<std::string> Command::given_options(std::size_t first, std::size_t last) const
{
    std::vector<std::string> words;
    const std::vector<CLI::Option*> options = app_.get_options();
    for (std::size_t i = first; i < last; ++i) {
        const CLI::Option& option = *options[i];
        const bool is_file_list = std::find(file_lists_.begin(), file_lists_.end(), &option) != file_lists_.end();
        if (option.get_positional() || is_file_list) continue;
        const bool is_flag = option.get_expected_min() == 0;
        for (const std::string& value : option.results()) {
            words.push_back(option.get_name());
            if (!is_flag)
                words.push_back(value);
            else if (value != "true")
                words.back() += "=" + value;
        }
    }
    return words;
}

void Command::set_run(Run& run, Run action)
{
    app_.final_callback([&run, action = std::move(action)] { run = action; });
}

void add_json_option(Command& command, bool& json)
{
    command.begin_group("Reporting and debugging");
    command.add_flag({"--json", "", "print JSON", ""}, json);
}

void add_quiet_option(Command& command, bool& quiet)
{
    command.begin_group("Reporting and debugging");
    command.add_flag({"-q,--quiet", "", "print only errors", ""}, quiet);
}

}  // namespace fathom::cli
