// SPDX-License-Identifier: Apache-2.0
/// Merging films: two halves of a render, as two machines would make them, go through files and add up to the bits of
/// one run. Exits with 1 if a single bit differs.
///
///     merge_films SCENE [FOLDER]      SCENE: any scene or model file; FOLDER: where the films go (default: this one)
#include <fathom/error.h>
#include <fathom/film_file.h>
#include <fathom/lighting.h>
#include <fathom/load.h>
#include <fathom/render.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <utility>

namespace {

constexpr std::uint64_t samples = 32;

fathom::RenderSettings settings()
{
    fathom::RenderSettings settings;
    settings.width = 160, settings.height = 120;
    settings.aovs = {fathom::Aov::albedo, fathom::Aov::normal};
    settings.guiding = true;  // part of the key of a film: all parts must agree on it
    return settings;
}

/// Adds a camera if the file has none, and studio light if the scene is dark.
fathom::Scene load(const std::filesystem::path& file)
{
    fathom::Warnings warnings;
    fathom::SceneDescription scene = fathom::load_scene(file, {}, warnings);
    fathom::FramingOptions framing;
    framing.aspect = double(settings().width) / settings().height;
    fathom::add_default_camera(scene, framing);
    return fathom::compile_lit(std::move(scene), "", fathom::LightingMode::automatic, framing.aspect, warnings).scene;
}

/// Does the work of one machine: loads the scene, renders some of the samples, and writes an EXR with their exact sums.
void render_part(const std::filesystem::path& scene, fathom::SampleRange range, const std::filesystem::path& file)
{
    const fathom::RenderJob job(load(scene), settings());
    fathom::Film film(job);
    fathom::render(job, range, film);
    fathom::write_film(file, film, film.image(false, false), {});
}

}  // namespace

int main(int argc, char** argv)
try {
    if (argc < 2) {
        std::fprintf(stderr, "usage: merge_films SCENE [FOLDER]\n");
        return 2;
    }
    const std::filesystem::path scene = argv[1], folder = argc > 2 ? argv[2] : ".";
    const std::filesystem::path first = folder / "half-1.exr", second = folder / "half-2.exr";
    render_part(scene, {0, samples / 2}, first);
    render_part(scene, {samples / 2, samples}, second);

    // The order of films does not matter. merge() throws if the scene or settings differ, or if samples overlap.
    fathom::Film merged = fathom::FilmFile(second).read();
    fathom::FilmFile(first).add_to(merged);
    fathom::write_image(folder / "merged.png", merged.image(false, false), {});

    const fathom::RenderJob job(load(scene), settings());
    fathom::Film whole(job);
    fathom::render(job, {0, samples}, whole);
    // The images have radiance, albedo, normals and variance.
    const fathom::Image image = merged.image(false, true), expected = whole.image(false, true);
    bool identical = merged.samples() == whole.samples();
    for (std::size_t i = 0; i < expected.layers.size(); ++i)
        identical = identical && image.layers[i].pixels == expected.layers[i].pixels;
    std::printf("merged.png: %llu samples per pixel, %s\n", static_cast<unsigned long long>(merged.samples_per_pixel()),
                identical ? "identical to one run" : "DIFFERENT from one run");
    return identical ? 0 : 1;
} catch (const fathom::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
