#pragma once
#include <dlfcn.h>

#include <string>

#include "fathom/error.h"

/// Libraries that are opened at run time, since few need them.
namespace fathom {

/// Why the last one could not be opened.
inline std::string shared_library_trouble()
{
    const char* reason = dlerror();
    return reason ? reason : "unknown reason";
}

/// Throws Error if the library has no function of that name; `what` it is not then.
template <class Function>
void take_function(void* library, const std::string& file, const char* what, const char* name, Function& function)
{
    function = reinterpret_cast<Function>(dlsym(library, name));
    if (!function) throw Error(file, name, std::string("there is no such function: this is not ") + what);
}

}  // namespace fathom
