// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <dlfcn.h>

#include <string>

#include "fathom/error.h"

/// Loading of optional dependencies as shared libraries at run time (dlopen).
namespace fathom {

/// The reason of the last failed dlopen or dlsym, as dlerror() reports it.
inline std::string dynamic_library_error()
{
    const char* reason = dlerror();
    return reason ? reason : "unknown reason";
}

/// Looks up the symbol `name` with dlsym and stores it in `function`. Throws Error, naming `file`, if the library lacks
/// it; `what` names the library that was expected.
template <class Function>
void load_function(void* library, const std::string& file, const char* what, const char* name, Function& function)
{
    function = reinterpret_cast<Function>(dlsym(library, name));
    if (!function) throw Error(file, name, std::string("no such function: the library is not ") + what);
}

}  // namespace fathom
