// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "bindings.h"
#include "layers.h"
#include "views.h"
#include "waiting.h"

namespace fathom::python {

namespace nb = nanobind;

namespace {

/// A rendered view. Arrays share its memory.
struct ViewArrays {
    std::shared_ptr<const cli::View> view;
    DisplayChoice display;

    std::vector<std::size_t> shape(std::size_t channels) const
    {
        std::vector<std::size_t> sizes = {std::size_t(view->image.height), std::size_t(view->image.width)};
        if (channels > 1) sizes.push_back(channels);
        return sizes;
    }
    /// None for a layer that wasn't requested.
    template <class Number, class T>
    nb::object array(const std::vector<T>& values) const
    {
        if (values.empty()) return nb::none();
        return to_view(reinterpret_cast<const Number*>(values.data()), shape(sizeof(T) / sizeof(Number)), view);
    }
};

/// A transform as an array (4, 4).
nb::object matrix(const Transform& t)
{
    std::vector<double> numbers;
    for (const auto& row : t.m) numbers.insert(numbers.end(), row.begin(), row.end());
    numbers.insert(numbers.end(), {0, 0, 0, 1});
    return to_array<double>(numbers, {4, 4});
}

nb::object intrinsics(const ViewArrays& v)
{
    const PinholeCamera& c = v.view->camera;
    return to_array<double>(std::vector<double>{c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1}, {3, 3});
}

nb::object mask_array(const ViewArrays& v, const std::vector<std::uint32_t>& pixels)
{
    std::vector<std::uint8_t> mask(std::size_t(v.view->image.width) * std::size_t(v.view->image.height));
    for (const std::uint32_t pixel : pixels) mask[pixel] = 1;
    return to_array<bool>(mask, v.shape(1));
}

/// Pairs of the visible and the whole mask by instance.
nb::dict masks(const ViewArrays& v)
{
    nb::dict all;
    for (const ObjectMask& mask : v.view->masks)
        all[nb::int_(mask.instance)] = nb::make_tuple(mask_array(v, mask.visible), mask_array(v, mask.whole));
    return all;
}

/// Name and transform of each object.
nb::list objects(const ViewArrays& v)
{
    nb::list all;
    for (const SceneObject& object : v.view->objects)
        all.append(nb::make_tuple(object.name, matrix(object.pose * object.stretch)));
    return all;
}

/// Marks views, and the scene if there is one, as busy while it exists.
class BusyViews {
public:
    explicit BusyViews(Views& views) : views_(views)
    {
        if (views.is_busy) throw std::runtime_error("a view is being rendered; wait until that is done");
        views.is_busy = true;
    }
    BusyViews(const BusyViews&) = delete;
    BusyViews& operator=(const BusyViews&) = delete;
    ~BusyViews() { views_.is_busy = false; }

private:
    Views& views_;
};

/// Returns the views, and the exception of a signal that came meanwhile, or None.
nb::tuple prepare_views(Scene& scene, const std::vector<std::string>& words, bool take)
{
    const BusyScene busy(scene);
    auto views = std::make_shared<Views>();
    Waiting waiting({});
    waiting.run([&] { views->prepare(scene, words, take); });
    return nb::make_tuple(views, waiting.exception());
}

/// Returns the view, or None with the exception of a signal.
nb::tuple render_view(Views& views, std::size_t i, bool masks, bool flow)
{
    const BusyViews busy(views);
    std::shared_ptr<const cli::View> view;
    Waiting waiting({});
    waiting.run([&] { view = views.render(i, {.layers = true, .masks = masks, .flow = flow}, waiting.cancel()); });
    const nb::object result = view ? nb::cast(ViewArrays{view, views.display}) : nb::none();
    return nb::make_tuple(result, waiting.exception());
}

}  // namespace

void bind_views(nb::module_& module)
{
    nb::class_<ViewArrays>(module, "ViewArrays", "A rendered view; fathom.View wraps it.")
        .def("layers", [](const ViewArrays& v) { return Layers{{v.view, &v.view->image}, v.display}; })
        .def("intrinsics", &intrinsics)
        .def("world_from_camera", [](const ViewArrays& v) { return matrix(v.view->camera.world_from_camera); })
        .def("depth", [](const ViewArrays& v) { return v.array<float>(v.view->truth.depth); })
        .def("distance", [](const ViewArrays& v) { return v.array<float>(v.view->truth.distance); })
        .def("normal", [](const ViewArrays& v) { return v.array<float>(v.view->truth.normal); })
        .def("camera_normal", [](const ViewArrays& v) { return v.array<float>(v.view->truth.camera_normal); })
        .def("position", [](const ViewArrays& v) { return v.array<float>(v.view->truth.position); })
        .def("instance", [](const ViewArrays& v) { return v.array<std::uint32_t>(v.view->truth.instance); })
        .def("material", [](const ViewArrays& v) { return v.array<std::uint32_t>(v.view->truth.material); })
        .def("flow_forward", [](const ViewArrays& v) { return v.array<float>(v.view->flow_forward); })
        .def("flow_backward", [](const ViewArrays& v) { return v.array<float>(v.view->flow_backward); })
        .def("masks", &masks)
        .def("objects", &objects);
    nb::class_<Views>(module, "Views", "Views of a scene; fathom.render_views() wraps it.")
        .def_prop_ro("count", &Views::count)
        .def_ro("notes", &Views::notes)
        .def_prop_ro("materials",
                     [](const Views& v) {
                         std::vector<std::string> names;
                         for (const Material& material : v.description().materials) names.push_back(material.name);
                         return names;
                     })
        .def("take_warnings",
             [](Views& v) {
                 nb::dict counts;
                 const Warnings found = std::exchange(v.warnings, {});
                 for (const auto& [text, count] : found.counts()) counts[text.c_str()] = count;
                 return counts;
             })
        .def("render", &render_view, nb::arg("index"), nb::arg("masks"), nb::arg("flow"));
    module.def("prepare_views", &prepare_views, nb::arg("scene"), nb::arg("words"), nb::arg("take"));
}

}  // namespace fathom::python
