// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/commands.h"
#include "fathom/error.h"
#include "options/arguments.h"
#include "options/command.h"
#include "process/streams.h"
#include "render/comparison.h"
#include "render/overwrite_guard.h"
#include "report/difference_image.h"
#include "report/difference_report.h"

namespace fathom::cli {

namespace {

constexpr CommandText diff_text{
    "diff", "Compare an image with a reference",
    "Prints the number of pixels that differ, the largest difference, PSNR, relMSE and FLIP. If both are EXR files\n"
    "with sums (--mergeable) or a layer variance, a test says whether noise explains the differences.\n"
    "docs/diff.md explains the numbers.\n\n"
    "Examples:\n"
    "  fathom diff new.png old.png -o diff.png\n"
    "  fathom diff new.exr old.exr --tolerance 0.001 --json\n"
    "  fathom diff new.exr old.exr --allow-noise      renders with different seeds or numbers of samples\n\n"
    "Exit codes: 0 no pixel differs by more than the tolerance; 1 pixels differ; 2 error or wrong usage."};

struct DiffOptions {
    std::filesystem::path image, reference;
    CompareOptions compare;
    std::vector<std::filesystem::path> outputs;
    bool allow_noise = false, json = false, quiet = false;
};

void check_outputs(const DiffOptions& o)
{
    for (const auto& file : o.outputs) check_output(file);
    check_outputs_are_not(o.outputs, o.image, "an image to be compared");
    check_outputs_are_not(o.outputs, o.reference, "an image to be compared");
}

void print(const Comparison& comparison, bool as_json)
{
    if (as_json)
        return write_stdout(difference_json(comparison).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) +
                            '\n');
    for (const std::string& line : difference_text(comparison)) write_stdout(line + '\n');
}

int compare_files(const DiffOptions& o)
{
    check_outputs(o);
    const Comparison comparison = compare(read_comparable(o.image), read_comparable(o.reference), o.compare);
    if (o.allow_noise && !comparison.noise)
        throw Error(o.image.string(), "", "--allow-noise: noise can't be tested: " + comparison.no_noise_test);
    for (const auto& file : o.outputs) write_difference(file, comparison);
    if (!o.quiet || o.json) print(comparison, o.json);
    const bool is_same = comparison.difference.is_same() || (o.allow_noise && comparison.is_explained_by_noise());
    return is_same ? exit_same : exit_different;
}

/// Compares, with an exit code for errors that does not look like a difference.
int run_diff(const DiffOptions& o)
{
    try {
        return compare_files(o);
    } catch (const UsageError&) {
        throw;
    } catch (const std::bad_alloc&) {
        write_stderr("fathom: there is not enough memory\n");
    } catch (const std::exception& error) {
        write_stderr(fmt::format("fathom: {}\n", error.what()));
    }
    return exit_trouble;
}

void add_options(Command& command, DiffOptions& o)
{
    command.add_positional("IMAGE", o.image, "image file of any format that Fathom reads");
    command.add_positional("REFERENCE", o.reference, "image file that it is compared with");
    command.begin_group("Comparison");
    command.add_value({"--tolerance", "X",
                       "largest difference of a channel that counts as none: in radiance for EXR, of 1 for PNG and "
                       "others, where one of 255 codes is 0.004",
                       "0"},
                      [&](const std::string& text) { o.compare.tolerance = parse_number(text, 0, 1e30); });
    command.add_value({"--layer", "NAME", "layer of EXR to compare, such as depth or normal", "the image itself"},
                      [&](const std::string& text) { o.compare.layer = text; });
    command.add_flag({"--allow-noise", "",
                      "exit code 0 also if noise explains the differences; an error if noise can't be tested", ""},
                     o.allow_noise);
    command.begin_group("Output");
    command.add_files({"-o,--output", "FILE",
                       "image of the differences to write: the FLIP map with its scale and the numbers; EXR: the "
                       "values of the map",
                       ""},
                      o.outputs);
    add_json_option(command, o.json);
    command.add_flag({"-q,--quiet", "", "print only errors; the exit code says the result", ""}, o.quiet);
}

}  // namespace

void add_diff(CLI::App& program, Run& run)
{
    add_command<DiffOptions>(program, run, diff_text, add_options, run_diff);
}

}  // namespace fathom::cli
