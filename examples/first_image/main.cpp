// SPDX-License-Identifier: Apache-2.0
/// A first image: a glass ball and a gold ball on a floor under a gradient sky, written to a file.
///
/// usage: first_image [FILE]      FILE: .png, .jpg, .webp, .avif, .hdr or .exr (default first-image.png)
#include <fathom/error.h>
#include <fathom/render.h>

#include <cstdio>

int main(int argc, char** argv)
try {
    // Materials, shapes, nodes and cameras are entries of vectors and refer to each other by index.
    fathom::SceneDescription scene;
    fathom::Material floor, glass, gold;
    floor.base_color.value = {0.5f, 0.5f, 0.5f};
    glass.kind = fathom::MaterialKind::glass;
    gold.kind = fathom::MaterialKind::metal;
    gold.base_color.value = {1.0f, 0.77f, 0.34f};
    gold.roughness.value = 0.3f;
    scene.materials = {floor, glass, gold};

    fathom::Node node;
    node.shapes.push_back({fathom::Disk{{0, 0, 0}, {0, 1, 0}, 20}, 0, "floor"});
    node.shapes.push_back({fathom::Sphere{{-1.1, 1, 0}, 1, {}}, 1, "glass ball"});
    node.shapes.push_back({fathom::Sphere{{1.1, 1, 0}, 1, {}}, 2, "gold ball"});
    node.camera = 0;
    scene.nodes.push_back(node);
    scene.roots = {0};
    scene.cameras.emplace_back().position = {0, 2, 8};
    scene.cameras[0].look_at = {0, 1, 0};
    scene.environment.kind = fathom::EnvironmentKind::gradient;

    // Compiling builds the acceleration structures. The compiled scene never changes.
    fathom::Warnings warnings;
    const fathom::Scene compiled = fathom::Scene::compile(scene, "", warnings);

    fathom::RenderSettings settings;
    settings.width = 400, settings.height = 300;
    const fathom::RenderJob job(compiled, settings);
    fathom::Film film(job);
    fathom::render(job, {0, 64}, film);

    const char* file = argc > 1 ? argv[1] : "first-image.png";
    fathom::write_image(file, film.image(false, false), {});
    std::printf("%s: 64 samples per pixel, %s\n", file, fathom::simd_name());
} catch (const fathom::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
