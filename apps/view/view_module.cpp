// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>

#include <SFML/System/Err.hpp>
#include <cstdlib>
#include <sstream>

#include "module.h"
#include "viewer.h"

namespace {

/// SFML aborts the program without X11, so X11 is tested first. Its libraries are installed with SFML, but its headers
/// may be missing, hence dlsym.
std::string trouble_with_x11()
{
    const char* name = std::getenv("DISPLAY");
    if (!name || !*name)
        return "there is no display to open a window on (DISPLAY is not set); `fathom render` needs none";
    void* const x11 = dlopen("libX11.so.6", RTLD_LAZY | RTLD_LOCAL);
    if (!x11) return {};
    const auto open = reinterpret_cast<void* (*)(const char*)>(dlsym(x11, "XOpenDisplay"));
    const auto query = reinterpret_cast<int (*)(void*, const char*, int*, int*, int*)>(dlsym(x11, "XQueryExtension"));
    if (!open || !query) return {};
    // The display stays open: an X server may restart after its last client, refuse SFML, and make it abort.
    void* const display = open(nullptr);
    if (!display) return std::string("the display '") + name + "' can't be opened; `fathom render` needs none";
    int opcode, event, error;
    const bool has_glx = query(display, "GLX", &opcode, &event, &error) != 0;
    if (!has_glx) return std::string("the display '") + name + "' has no OpenGL (GLX)";
    return {};
}

}  // namespace

extern "C" {

FATHOM_API extern const char* const fathom_view_version;
const char* const fathom_view_version = FATHOM_VERSION;

FATHOM_API void fathom_view_trouble(std::string& trouble)
{
    trouble = trouble_with_x11();
}

/// Exceptions must not leave the module.
FATHOM_API void fathom_view_run(const fathom::view::ViewJob& job, std::string& trouble)
{
    // SFML's own messages are dropped: errors that matter are reported below.
    std::ostringstream messages;
    sf::err().rdbuf(messages.rdbuf());
    try {
        fathom::view::Viewer(job).run();
    } catch (const std::bad_alloc&) {
        trouble = "there is not enough memory";
    } catch (const std::exception& error) {
        trouble = error.what();
    }
    sf::err().rdbuf(nullptr);
}

}  // extern "C"
