// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <dlfcn.h>
#include <fmt/format.h>
#include <string>

#include "fathom/error.h"

namespace fathom::cli {

/// Opens a shared library beside the program or in its installation. Throws Error if it is missing, can't be loaded or
/// belongs to another version.
///
/// missing  message of the error for a missing library
/// global   makes the symbols of its dependencies visible to libraries that those open later
void* open_module(const char* file, const char* version_symbol, const std::string& missing, bool global = false);
/// Whether the library is installed.
bool has_module(const char* file);

/// A function of an open library. Throws Error if there is none of this name.
template <class Function>
Function* find_function(void* module, const char* file, const char* symbol)
{
    const auto function = reinterpret_cast<Function*>(dlsym(module, symbol));
    if (!function) throw Error("", "", fmt::format("the module {} has no {}", file, symbol));
    return function;
}

}  // namespace fathom::cli
