// SPDX-License-Identifier: Apache-2.0
// Cost of a 4K film file with all layers: its size, the copy that stalls rendering, and writing it.
//   film_file FILE [WIDTH HEIGHT [TIMES]]
#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/parallel_for.h>
#include <chrono>
#include <cstdlib>
#include <functional>

#include "fathom/error.h"
#include "fathom/film_file.h"
#include "film/film_data.h"

namespace fathom {

namespace {

/// A film of a noise image, with sums of the size that 1024 samples give.
Film made_film(int width, int height)
{
    RenderSettings settings;
    settings.width = width, settings.height = height, settings.alpha = true;
    settings.aovs = {Aov::albedo, Aov::normal, Aov::depth, Aov::position, Aov::instance_id, Aov::material_id};
    Film film(FilmKey{settings, std::string(32, '0')});
    film.data().add_range({0, 1024});
    tbb::parallel_for(std::size_t(0), std::size_t(width) * std::size_t(height), [&](std::size_t i) {
        std::uint64_t state = i * 0x9e3779b97f4a7c15u + 1;
        const auto random = [&] {
            state = (state ^ state >> 29) * 0xbf58476d1ce4e5b9u;
            return float(state >> 40) * 0x1p-24f;
        };
        std::uint32_t* const pixel = film.data().pixel(i);
        for (int c = 0; c < 3; ++c) {
            const double value = 1024 * double(random());
            ExactSum::add_number(radiance_sum(pixel, c), value);
            ExactSquareSum::add_number(square_sum(pixel, c), value * double(random()));
        }
        const FilmLayout& layout = film.data().layout;
        for (int s = 0; s < layout.sums; ++s) ExactSum::add_number(other_sum(pixel, s), 1024 * double(random()) - 300);
        for (const int whole : {layout.alpha, layout.hits}) {
            std::fill_n(other_sum(pixel, whole), ExactSum::words, 0u);
            ExactSum::add_number(other_sum(pixel, whole), std::floor(1024 * double(random())));
        }
        pixel[layout.ids] = 0, pixel[layout.ids + 1] = std::uint32_t(i % 100), pixel[layout.ids + 2] = 3;
    });
    return film;
}

double cpu_s()
{
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](timeval t) { return double(t.tv_sec) + 1e-6 * double(t.tv_usec); };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void measure(const char* what, const std::function<void()>& work)
{
    const auto start = std::chrono::steady_clock::now();
    const double cpu = cpu_s();
    work();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    fmt::print("{:<8} {:6.3f} s, {:6.3f} s of processors\n", what, seconds, cpu_s() - cpu);
}

int run(const char* file, int width, int height, int times)
{
    const Film film = made_film(width, height);
    FilmSnapshot snapshot;
    WriteOptions half;
    half.exr_half = true;
    for (int i = 0; i < times; ++i) {
        Image picture;
        measure("picture", [&] { picture = film.beauty(true); });
        measure("copy", [&] { snapshot.take(film, picture, half); });
        measure("write", [&] { snapshot.write(file); });
        measure("read", [&] { FilmFile(file).read(); });
    }
    fmt::print("{:.1f} MB, of sums of {:.1f} MB\n", double(snapshot.size_bytes()) / 1e6,
               4e-6 * double(film.data().words.size()));
    return 0;
}

}  // namespace

}  // namespace fathom

int main(int argc, char** argv)
{
    if (argc < 2) {
        fmt::print(stderr, "usage: film_file FILE [WIDTH HEIGHT [TIMES]]\n");
        return 2;
    }
    const auto number = [&](int i, int otherwise) { return argc > i ? std::atoi(argv[i]) : otherwise; };
    try {
        return fathom::run(argv[1], number(2, 3840), number(3, 2160), number(4, 3));
    } catch (const fathom::Error& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
}
