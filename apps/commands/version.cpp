// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <CLI/Version.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "commands/commands.h"
#include "distributed/mpi/module.h"
#include "fathom/image.h"
#include "fathom/render.h"
#include "options/command.h"
#include "process/modules.h"
#include "process/streams.h"
#include "view/module.h"

namespace fathom::cli {

namespace {

int run_version()
{
    write_stdout(fmt::format("fathom {}\n", FATHOM_VERSION));
    write_stdout(fmt::format("SIMD: {}, {} lane{}\n", simd_name(), simd_width(), simd_width() == 1 ? "" : "s"));
    const KernelChoice kernel = kernel_choice();
    write_stdout(fmt::format("kernel: {} ({})\n", kernel.name, kernel.reason));
    write_stdout(fmt::format("libraries: {}, CLI11 {}, fmt {}.{}.{}, nlohmann-json {}.{}.{}\n",
                             fmt::join(image_libraries(), ", "), CLI11_VERSION, FMT_VERSION / 10000,
                             FMT_VERSION / 100 % 100, FMT_VERSION % 100, NLOHMANN_JSON_VERSION_MAJOR,
                             NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH));
    std::vector<std::string> modules;
    if (has_module(view::module_file)) modules.emplace_back("view (the window)");
    if (has_module("libfathom_assimp.so")) modules.emplace_back("assimp (FBX, Collada and others)");
    if (has_module(mpi::module_file)) modules.emplace_back("mpi (mpirun)");
    write_stdout(fmt::format("modules: {}\n", modules.empty() ? "none" : fmt::format("{}", fmt::join(modules, ", "))));
    return exit_ok;
}

}  // namespace

void add_version(CLI::App& program, Run& run)
{
    Command command(program, {"version", "Print the version, the kernel in use and why, libraries and modules",
                              "Example:\n  fathom version\n\nExit codes: 0 success; 2 wrong usage."});
    command.set_run(run, run_version);
}

}  // namespace fathom::cli
