// SPDX-License-Identifier: Apache-2.0
/// An animation by scene edits: a carousel turns, and a lamp changes its color. Only what changed is compiled again.
///
///     animation [FRAMES [PREFIX]]      writes PREFIX00.png, PREFIX01.png, ... (default 8 frame-)
#include <fathom/editable_scene.h>
#include <fathom/error.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace {

constexpr double two_pi = 6.283185307179586;
constexpr int lamp_material = 1, carousel_node = 1;  // indices into the vectors below

fathom::SceneDescription carousel()
{
    fathom::SceneDescription scene;
    fathom::Material gray, lamp, red;
    lamp.kind = fathom::MaterialKind::none;
    lamp.emission.radiance.value = {20, 20, 20};
    red.base_color.value = {0.7f, 0.1f, 0.1f};
    scene.materials = {gray, lamp, red};

    fathom::Node world, wheel;
    world.shapes.push_back({fathom::Disk{{0, 0, 0}, {0, 1, 0}, 20}, 0, "floor"});
    world.shapes.push_back({fathom::Rectangle{{-1, 6, -1}, {2, 0, 0}, {0, 0, 2}}, lamp_material, "lamp"});
    world.camera = 0;
    world.children = {carousel_node};
    for (int i = 0; i < 6; ++i) {
        const double angle = two_pi * i / 6;
        const fathom::Vec3d center = {2.5 * std::cos(angle), 0.6, 2.5 * std::sin(angle)};
        wheel.shapes.push_back({fathom::Sphere{center, i == 0 ? 0.6 : 0.4, {}}, 2, "ball"});
    }
    wheel.movable = true;  // an edit of this node then costs time in proportion to its contents, not to the whole scene
    scene.nodes = {world, wheel};
    scene.roots = {0};

    fathom::Camera camera;
    camera.position = {0, 4, 9};
    camera.look_at = {0, 0.5, 0};
    scene.cameras = {camera};
    scene.environment.kind = fathom::EnvironmentKind::constant;
    scene.environment.color = {0.1f, 0.1f, 0.12f};
    return scene;
}

}  // namespace

int main(int argc, char** argv)
try {
    const int frames = argc > 1 ? std::atoi(argv[1]) : 8;
    const std::string prefix = argc > 2 ? argv[2] : "frame-";

    fathom::EditableScene edit(carousel());
    fathom::RenderSettings settings;
    settings.width = 240, settings.height = 180;
    fathom::Warnings warnings;
    for (int frame = 0; frame < frames; ++frame) {
        const double share = double(frame) / frames;
        edit.set_transform(carousel_node, fathom::Transform::rotate({0, 1, 0}, two_pi / 6 * share));
        fathom::Material lamp = edit.description().materials[lamp_material];
        lamp.emission.radiance.value.b = float(20 - 15 * share);
        edit.set_material(lamp_material, lamp);

        // Job and scene end with this iteration. While one of them lives, compile() builds the whole scene anew.
        const fathom::RenderJob job(edit.compile(warnings), settings);
        fathom::Film film(job);
        fathom::render(job, {0, 32}, film);

        char number[16];
        std::snprintf(number, sizeof number, "%02d", frame);
        fathom::WriteOptions options;
        options.display.tonemap = fathom::Tonemap::khronos_neutral;
        fathom::write_image(prefix + number + ".png", film.image(false, false), options);
        std::printf("%s%s.png%s\n", prefix.c_str(), number, edit.recompiled() ? ": the whole scene compiled" : "");
    }
} catch (const fathom::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
