#include <dlfcn.h>

#include <SFML/System/Err.hpp>
#include <cstdlib>
#include <sstream>

#include "module.h"
#include "viewer.h"

namespace {

/// SFML uses X11 on Linux, and ends the program where it finds none: that is found out first. Its libraries are there,
/// as SFML's own needs, but their headers need not be.
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
    // Left open on purpose: a server whose last client goes may start afresh, and refuse SFML, which aborts then.
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

/// Exceptions don't cross the boundary.
FATHOM_API void fathom_view_run(const fathom::view::ViewJob& job, std::string& trouble)
{
    // What SFML says of its troubles is for us; if they matter, we see them.
    std::ostringstream said;
    sf::err().rdbuf(said.rdbuf());
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
