// SPDX-License-Identifier: Apache-2.0
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "bindings.h"
#include "fathom/denoise.h"
#include "layers.h"
#include "run.h"
#include "waiting.h"

namespace fathom::python {

namespace nb = nanobind;

namespace {

/// The film between two passes, for callbacks; usable only while the callback runs.
struct Pass {
    const Film* film;
    const Run* run;

    const Film& current() const
    {
        if (!film) throw std::runtime_error("progress can only be read inside the callback that received it");
        return *film;
    }
    nb::object rgba() const
    {
        const Film& now = current();
        const Image image = now.beauty(now.key().settings.alpha);
        const auto pixels =
            to_display(image.layers.front(), image.width, image.height, run->display.resolve({}).display);
        return to_array<std::uint8_t>(pixels, {std::size_t(image.height), std::size_t(image.width), 4});
    }
};

Waiting::OnPass call_back(const Run& run, const nb::object& callback)
{
    if (callback.is_none()) return {};
    return [&run, callback](const Film& film) {
        const auto pass = std::make_shared<Pass>(Pass{&film, &run});
        struct End {
            Pass& pass;
            ~End() { pass.film = nullptr; }
        } const end{*pass};
        callback(pass);
    };
}

/// Marks a run, its film and its scene as busy while it exists. The interpreter lock must be held at both ends.
class BusyRun {
public:
    explicit BusyRun(Run& run) : run_(run)
    {
        if (run.is_busy || (run.prepared() && run.prepared()->is_busy))
            throw std::runtime_error("the image is being rendered; wait until that is done");
        mark(true);
    }
    BusyRun(const BusyRun&) = delete;
    BusyRun& operator=(const BusyRun&) = delete;
    ~BusyRun() { mark(false); }

private:
    void mark(bool busy)
    {
        run_.is_busy = busy;
        if (run_.film) run_.film->is_busy = busy;
        if (run_.prepared()) run_.prepared()->is_busy = busy;
    }

    Run& run_;
};

/// Returns the run, and the exception of a signal or callback that ended it early, or None.
nb::tuple render(Scene& scene, const std::vector<std::string>& words, bool take, const FilmBox* resume,
                 const nb::object& callback)
{
    const BusyScene busy(scene);
    auto run = std::make_shared<Run>();
    const BusyRun busy_run(*run);
    if (resume) resume->check_idle();
    Waiting waiting(call_back(*run, callback));
    waiting.run([&] {
        run->start(scene, words, take, resume ? &resume->film : nullptr, waiting.cancel(),
                   [&](const Film& film) { waiting.announce(film); });
    });
    return nb::make_tuple(run, waiting.exception());
}

nb::object more(Run& run, std::optional<std::uint64_t> samples, std::optional<double> time_s,
                const nb::object& callback)
{
    const BusyRun busy(run);
    Waiting waiting(call_back(run, callback));
    waiting.run(
        [&] { run.more(samples, time_s, waiting.cancel(), [&](const Film& film) { waiting.announce(film); }); });
    return waiting.exception();
}

nb::dict take_warnings(Run& run)
{
    nb::dict counts;
    const Warnings found = std::exchange(run.warnings, {});
    for (const auto& [text, count] : found.counts()) counts[text.c_str()] = count;
    return counts;
}

}  // namespace

void bind_run(nb::module_& module)
{
    nb::class_<Pass>(module, "Pass", "State between two passes of a render, for progress callbacks.")
        .def_prop_ro("samples", [](const Pass& p) { return p.current().samples_per_pixel(); })
        .def_prop_ro("planned", [](const Pass& p) { return p.run->planned_samples; })
        .def("rgba", &Pass::rgba);
    nb::class_<Run>(module, "Run", "A render that can be continued; fathom.Image wraps it.")
        .def("layers", [](const Run& r) { return Layers{r.image(), r.display}; })
        .def_prop_ro("film",
                     [](const Run& r) {
                         if (!r.film) throw std::runtime_error("the image has forgotten its film");
                         return r.film;
                     })
        .def_ro("notes", &Run::notes)
        .def("take_warnings", &take_warnings)
        .def("forget_scene",
             [](Run& r) {
                 const BusyRun busy(r);
                 r.forget_scene();
             })
        .def("more", &more, nb::arg("samples").none(), nb::arg("time_s").none(), nb::arg("callback").none());
    module.def("render", &render, nb::arg("scene"), nb::arg("words"), nb::arg("take"), nb::arg("resume").none(),
               nb::arg("callback").none());
}

}  // namespace fathom::python
