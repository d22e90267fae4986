#pragma once
#include <dlfcn.h>
#include <fmt/format.h>
#include <string>

#include "fathom/error.h"

namespace fathom::cli {

/// A library that the program opens when it needs it: beside the program or where it is installed.
///
/// missing  what is told where it is not there; throws Error then, or if it can't be used or is of another version
/// global   what it needs is to be found by what that opens
void* open_module(const char* file, const char* version_symbol, const std::string& missing, bool global = false);
/// Whether it is there.
bool has_module(const char* file);

template <class Function>
Function* function_of(void* module, const char* file, const char* symbol)
{
    const auto function = reinterpret_cast<Function*>(dlsym(module, symbol));
    if (!function) throw Error("", "", fmt::format("the module {} has no {}", file, symbol));
    return function;
}

}  // namespace fathom::cli
