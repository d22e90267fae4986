// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "bindings.h"
#include "fathom/denoise.h"
#include "layers.h"

namespace fathom::python {

namespace nb = nanobind;

namespace {

nb::object layer(const Layers& layers, const std::string& name)
{
    const Image& image = *layers.image;
    const Image::Layer* found = image.find(name);
    if (!found) throw nb::key_error(name.c_str());
    std::vector<std::size_t> shape = {std::size_t(image.height), std::size_t(image.width)};
    if (found->channels.size() > 1) shape.push_back(found->channels.size());
    return to_view(found->pixels.data(), std::move(shape), layers.image);
}

std::vector<std::string> names(const Layers& layers)
{
    std::vector<std::string> all;
    for (const Image::Layer& each : layers.image->layers) all.push_back(each.name);
    return all;
}

/// Display values R, G, B, A of each pixel.
nb::object rgba(const Layers& layers, const std::vector<std::string>& words)
{
    const Image& image = *layers.image;
    std::vector<unsigned char> pixels;
    {
        const nb::gil_scoped_release release;
        const Image shown = display_image(image);
        pixels = to_display(shown.layers.front(), image.width, image.height, layers.display.resolve(words).display);
    }
    return to_array<std::uint8_t>(pixels, {std::size_t(image.height), std::size_t(image.width), 4});
}

void save(const Layers& layers, const std::filesystem::path& file, const std::vector<std::string>& words)
{
    const nb::gil_scoped_release release;
    const WriteOptions options = layers.display.resolve(words);
    const bool is_exr = cli::is_exr(options.format, file);
    write_image(file, is_exr ? *layers.image : display_image(*layers.image), options);
}

}  // namespace

void bind_layers(nb::module_& module)
{
    nb::class_<Layers>(module, "Layers", "Layers of an image; fathom.Image wraps it.")
        .def_prop_ro("width", [](const Layers& l) { return l.image->width; })
        .def_prop_ro("height", [](const Layers& l) { return l.image->height; })
        .def_prop_ro("attributes", [](const Layers& l) { return l.image->attributes; })
        .def("names", &names)
        .def("layer", &layer)
        .def("channels", [](const Layers& l, const std::string& name) { return l.image->find(name)->channels; })
        .def("rgba", &rgba)
        .def("save", &save);
}

}  // namespace fathom::python
