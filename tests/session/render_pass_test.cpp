#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "fathom/error.h"
#include "fathom/render.h"

namespace fathom {
namespace {

/// A ball on a ball, lit from everywhere.
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
    const Film::Sums x = a.sums(), y = b.sums();
    EXPECT_EQ(x.samples, y.samples);
    EXPECT_EQ(x.words, y.words);
    EXPECT_EQ(x.key, y.key);
    EXPECT_EQ(x.dropped, y.dropped);
}

TEST(RenderPass, MakesTheBitsOfRender)
{
    const Scene scene = compiled();
    for (const bool cropped : {false, true}) {
        RenderSettings settings = small();
        if (cropped) settings.crop = Crop{7, 5, 101, 64};
        Film whole(settings), passes(settings);
        render(scene, settings, {0, 7}, whole);
        const std::atomic<bool> cancel = false;
        for (const SampleRange& range : {SampleRange{0, 1}, {1, 2}, {4, 7}, {2, 4}})
            EXPECT_TRUE(render_pass(scene, settings, range, passes, cancel));
        expect_same(whole, passes);
    }
}

TEST(RenderPass, LeavesTheFilmAsItWasIfCancelled)
{
    const Scene scene = compiled();
    const RenderSettings settings = small();
    Film film(settings), as_it_was(settings);
    std::atomic<bool> cancel = true;
    EXPECT_FALSE(render_pass(scene, settings, {0, 1}, film, cancel));
    expect_same(film, as_it_was);
    cancel = false;
    render_pass(scene, settings, {0, 2}, film, cancel);
    render_pass(scene, settings, {0, 2}, as_it_was, cancel);
    cancel = true;
    EXPECT_FALSE(render_pass(scene, settings, {2, 5}, film, cancel));
    expect_same(film, as_it_was);
}

/// In the middle of a pass, with tiles done already: of the first pass, and of a later one.
TEST(RenderPass, CanBeCancelledAtAnyTime)
{
    using namespace std::chrono_literals;
    const Scene scene = compiled();
    RenderSettings settings = small();
    settings.width = 640, settings.height = 480;
    const std::atomic<bool> never = false;
    for (const std::uint64_t before : {0, 2}) {
        Film film(settings), as_it_was(settings);
        if (before > 0) {
            render_pass(scene, settings, {0, before}, film, never);
            render_pass(scene, settings, {0, before}, as_it_was, never);
        }
        for (const auto time : {2ms, 10ms, 40ms}) {
            std::atomic<bool> cancel = false;
            std::thread canceller([&] {
                std::this_thread::sleep_for(time);
                cancel = true;
            });
            // Far more than any machine does in that time.
            const auto start = std::chrono::steady_clock::now();
            EXPECT_FALSE(render_pass(scene, settings, {before, before + 1024}, film, cancel));
            EXPECT_LT(std::chrono::steady_clock::now() - start, 2s);
            canceller.join();
            expect_same(film, as_it_was);
        }
        EXPECT_TRUE(render_pass(scene, settings, {before, before + 1}, film, never));
        Film whole(settings);
        render(scene, settings, {0, before + 1}, whole);
        expect_same(film, whole);
    }
}

TEST(RenderPass, RefusesWhatIsWrong)
{
    Scene scene = compiled();
    const RenderSettings settings = small();
    const std::atomic<bool> cancel = false;
    Film film(settings), as_it_was(settings);
    for (const SampleRange& wrong : {SampleRange{0, 0}, {3, 2}, {0, 1025}})
        EXPECT_THROW(render_pass(scene, settings, wrong, film, cancel), Error);
    expect_same(film, as_it_was);
    render_pass(scene, settings, {0, 2}, film, cancel);
    render_pass(scene, settings, {0, 2}, as_it_was, cancel);
    EXPECT_THROW(render_pass(scene, settings, {1, 3}, film, cancel), Error);
    Camera camera = scene.camera();
    camera.position.x += 1;
    scene.set_camera(camera);
    EXPECT_THROW(render_pass(scene, settings, {2, 3}, film, cancel), Error);
    expect_same(film, as_it_was);
}

TEST(Film, ClearedIsAsNew)
{
    Scene scene = compiled();
    const RenderSettings settings = small();
    Film film(settings);
    render(scene, settings, {0, 2}, film);
    film.clear();
    expect_same(film, Film(settings));
    Camera camera = scene.camera();
    camera.position.x += 1;
    scene.set_camera(camera);
    Film other(settings);
    render(scene, settings, {0, 2}, other);
    render(scene, settings, {0, 2}, film);
    expect_same(film, other);
}

}  // namespace
}  // namespace fathom
