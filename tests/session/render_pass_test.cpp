// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <limits>

#include "fathom/error.h"
#include "fathom/render.h"
#include "support/film_contents.h"
#include "support/waiting.h"

namespace fathom {
namespace {

/// A sphere on a sphere under uniform illumination.
SceneDescription balls()
{
    SceneDescription d;
    Node node;
    node.shapes.push_back({Sphere{{0, 0, 0}, 1, {}}, -1, "ball"});
    node.shapes.push_back({Sphere{{0, -101, 0}, 100, {}}, -1, "ground"});
    node.camera = 0;
    d.nodes.push_back(node);
    d.roots = {0};
    Camera camera;
    camera.position = {0, 1, 5};
    camera.look_at = {0, 0, 0};
    d.cameras.push_back(camera);
    d.environment.kind = EnvironmentKind::gradient;
    return d;
}

Scene compiled()
{
    Warnings warnings;
    return Scene::compile(balls(), "", warnings);
}

RenderSettings small()
{
    RenderSettings s;
    s.width = 120;
    s.height = 90;
    s.aovs = {Aov::depth, Aov::instance_id};
    return s;
}

void expect_same(const Film& a, const Film& b)
{
    EXPECT_EQ(a.samples(), b.samples());
    EXPECT_EQ(test::words_of(a), test::words_of(b));
    EXPECT_EQ(a.key().text(), b.key().text());
    EXPECT_EQ(a.invalid_samples(), b.invalid_samples());
}

TEST(RenderPass, MakesTheBitsOfRender)
{
    const Scene scene = compiled();
    for (const bool cropped : {false, true}) {
        RenderSettings settings = small();
        if (cropped) settings.crop = Crop{7, 5, 101, 64};
        const RenderJob job(scene, settings);
        Film whole(job), passes(job);
        render(job, {0, 7}, whole);
        const std::atomic<bool> cancel = false;
        for (const SampleRange& range : {SampleRange{0, 1}, {1, 2}, {4, 7}, {2, 4}})
            EXPECT_TRUE(render_pass(job, range, passes, cancel));
        expect_same(whole, passes);
    }
}

TEST(RenderPass, LeavesTheFilmAsItWasIfCancelled)
{
    const Scene scene = compiled();
    const RenderSettings settings = small();
    const RenderJob job(scene, settings);
    Film film(job), as_it_was(job);
    std::atomic<bool> cancel = true;
    EXPECT_FALSE(render_pass(job, {0, 1}, film, cancel));
    expect_same(film, as_it_was);
    cancel = false;
    render_pass(job, {0, 2}, film, cancel);
    render_pass(job, {0, 2}, as_it_was, cancel);
    cancel = true;
    EXPECT_FALSE(render_pass(job, {2, 5}, film, cancel));
    expect_same(film, as_it_was);
}

/// Cancels the first pass, and a pass of an existing film, whose duration is unknown.
TEST(Render, DropsAPassThatIsCancelled)
{
    const Scene scene = compiled();
    for (const bool cropped : {false, true})
        for (const std::uint64_t before : {0, 2}) {
            RenderSettings settings = small();
            settings.width = 640, settings.height = 480, settings.threads = 1;
            if (cropped) settings.crop = Crop{7, 5, 601, 464};
            const RenderJob job(scene, settings);
            Film made(job), whole(job);
            if (before > 0) render(job, {0, before}, made);
            render(job, {0, before + 3}, whole);
            for (const double processor_s : {0.005, 0.03}) {
                // A pass of several times that duration: it rarely finishes before it is cancelled.
                bool is_dropped = false;
                for (int attempt = 0; attempt < 20 && !is_dropped; ++attempt) {
                    Film film = test::copy_of(made);
                    is_dropped = !test::cancel_after(processor_s, [&](const std::atomic<bool>& cancel) {
                                      return render(job, {before, before + 3}, film, &cancel);
                                  }).is_done;
                    expect_same(film, is_dropped ? made : whole);
                    if (!is_dropped) continue;
                    EXPECT_TRUE(render(job, {before, before + 3}, film));
                    expect_same(film, whole);
                }
                EXPECT_TRUE(is_dropped);
            }
            // A pass that is not cancelled is added, in a separate film or directly.
            Film film = test::copy_of(made);
            const std::atomic<bool> never = false;
            EXPECT_TRUE(render(job, {before, before + 3}, film, &never));
            expect_same(film, whole);
        }
}

/// Cancels the first or a later pass after some of its tiles are finished.
TEST(RenderPass, CanBeCancelledAtAnyTime)
{
    const Scene scene = compiled();
    RenderSettings settings = small();
    settings.width = 640, settings.height = 480;
    const std::atomic<bool> never = false;
    for (const std::uint64_t before : {0, 2}) {
        const RenderJob job(scene, settings);
        Film film(job), as_it_was(job);
        if (before > 0) {
            render_pass(job, {0, before}, film, never);
            render_pass(job, {0, before}, as_it_was, never);
        }
        for (const double processor_s : {0.002, 0.01, 0.04}) {
            // The pass has more samples than any machine renders in that time.
            const test::CancelledWork work = test::cancel_after(processor_s, [&](const std::atomic<bool>& cancel) {
                return render_pass(job, {before, before + 1024}, film, cancel);
            });
            EXPECT_FALSE(work.is_done);
            EXPECT_LT(work.since_cancel_s, 2);
            expect_same(film, as_it_was);
        }
        EXPECT_TRUE(render_pass(job, {before, before + 1}, film, never));
        Film whole(job);
        render(job, {0, before + 1}, whole);
        expect_same(film, whole);
    }
}

TEST(RenderPass, RefusesWhatIsWrong)
{
    const Scene scene = compiled();
    const RenderSettings settings = small();
    const std::atomic<bool> cancel = false;
    const RenderJob job(scene, settings);
    Film film(job), as_it_was(job);
    for (const SampleRange& wrong : {SampleRange{0, 0}, {3, 2}, {0, 1025}})
        EXPECT_THROW(render_pass(job, wrong, film, cancel), Error);
    expect_same(film, as_it_was);
    render_pass(job, {0, 2}, film, cancel);
    render_pass(job, {0, 2}, as_it_was, cancel);
    EXPECT_THROW(render_pass(job, {1, 3}, film, cancel), Error);
    Camera camera = scene.camera();
    camera.position.x += 1;
    const RenderJob moved(scene, camera, settings);
    EXPECT_THROW(render_pass(moved, {2, 3}, film, cancel), Error);
    expect_same(film, as_it_was);
}

TEST(Film, ResetIsAsNew)
{
    const Scene scene = compiled();
    const RenderSettings settings = small();
    const RenderJob job(scene, settings);
    Film film(job);
    render(job, {0, 2}, film);
    film.reset(job);
    expect_same(film, Film(job));
    Camera camera = scene.camera();
    camera.position.x += 1;
    RenderSettings smaller = settings;
    smaller.width /= 2;
    smaller.aovs.clear();
    const RenderJob moved(scene, camera, smaller);
    Film other(moved);
    render(moved, {0, 2}, other);
    film.reset(moved);
    render(moved, {0, 2}, film);
    expect_same(film, other);
}

/// Creating a job rejects invalid settings and cameras.
TEST(RenderJob, RefusesWhatIsNoPicture)
{
    const Scene scene = compiled();
    const auto refused = [&](auto change) {
        RenderSettings settings = small();
        Camera camera = scene.camera();
        change(settings, camera);
        EXPECT_THROW(RenderJob(scene, camera, settings), Error);
    };
    refused([](RenderSettings& s, Camera&) { s.width = 0; });
    refused([](RenderSettings& s, Camera&) { s.height = 65536; });
    refused([](RenderSettings& s, Camera&) { s.crop = Crop{0, 0, 121, 90}; });
    refused([](RenderSettings& s, Camera&) { s.crop = Crop{5, 5, 5, 9}; });
    refused([](RenderSettings& s, Camera&) { s.crop = Crop{-1, 0, 5, 9}; });
    refused([](RenderSettings&, Camera& c) { c.position.x = 1e30; });
    refused([](RenderSettings&, Camera& c) { c.aperture = 1e30; });
    refused([](RenderSettings&, Camera& c) { c.look_at = c.position; });
    refused([](RenderSettings&, Camera& c) { c.position.y = std::numeric_limits<double>::quiet_NaN(); });
}

TEST(RenderJob, OnlyFilmsOfItAreRendered)
{
    const Scene scene = compiled();
    const RenderJob job(scene, small());
    RenderSettings other = small();
    other.width = 200;
    Film larger{RenderJob(scene, other)};
    EXPECT_THROW(render(job, {0, 1}, larger), Error);
    other = small();
    other.aovs.clear();
    Film without_layers{RenderJob(scene, other)};
    EXPECT_THROW(render(job, {0, 1}, without_layers), Error);
    other = small();
    other.threads = 1;  // the number of threads has no effect on the bits
    Film same{RenderJob(scene, other)};
    EXPECT_TRUE(render(job, {0, 1}, same));
}

TEST(FilmKey, IsItsText)
{
    const Scene scene = compiled();
    RenderSettings settings = small();
    settings.crop = Crop{3, 4, 50, 60};
    settings.background = Color{0.1f, -2.5f, 1e-3f};
    settings.seed = 4000000000u;
    settings.filter = Filter::gaussian;
    settings.filter_radius = 1.7;
    settings.light_sampling = false;
    const RenderJob job(scene, settings);
    const FilmKey again = FilmKey::parse(job.key().text());
    EXPECT_EQ(again.difference(job.key()), "");
    EXPECT_EQ(again.text(), job.key().text());
    settings.seed = 1;
    EXPECT_EQ(RenderJob(scene, settings).key().difference(job.key()), "seed is 1, not 4000000000");
}

TEST(FilmKey, RefusesWhatIsNone)
{
    const std::string good = RenderJob(compiled(), small()).key().text();
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        const std::size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    };
    EXPECT_NO_THROW(FilmKey::parse(good));
    for (const std::string& bad :
         {std::string(), std::string("size"), with("size=120x90", "size=0x90"), with("size=120x90", "size=120x"),
          with("size=120x90", "size=99999x90"), with("alpha=0", "alpha=2"), with("aovs=24", "aovs=27"),
          with("aovs=24", "aovs=00000000"), with("crop=none", "crop=0,0,1"), with("crop=none", "crop=5,0,5,9"),
          with("crop=none", "crop=0,0,200,9"), with("crop=none", "crop=0,0,70000000000,9"),
          with("filter=2", "filter=4"), with("filter=2", "filter=2x"), with("filter=2", "filter=2x0x1p+9"),
          with("background=none", "background=nan,0,0"), good + ";more=1", good.substr(0, good.size() - 1)})
        EXPECT_THROW(FilmKey::parse(bad), Error) << bad;
}

}  // namespace
}  // namespace fathom
