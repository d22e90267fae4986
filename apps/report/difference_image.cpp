// SPDX-License-Identifier: Apache-2.0
#include "report/difference_image.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>

#include "options/image_options.h"
#include "report/bitmap_font.h"
#include "report/magma.h"

namespace fathom::cli {

namespace {

constexpr Codes white{255, 255, 255}, gray{150, 150, 150}, outline{0, 230, 230};

/// An image that is drawn.
class Canvas {
public:
    Canvas(int width, int height)
    {
        image_.width = width, image_.height = height;
        image_.layers.push_back(
            {"", {"R", "G", "B"}, std::vector<float>(3 * std::size_t(width) * std::size_t(height))});
    }
    void set(int x, int y, const Codes& codes)
    {
        if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
        float* const pixel =
            &image_.layers[0].pixels[3 * (std::size_t(y) * std::size_t(image_.width) + std::size_t(x))];
        for (std::size_t c = 0; c < 3; ++c) pixel[c] = linear_from_code(codes[c]);
    }
    void fill(int x0, int y0, int x1, int y1, const Codes& codes)
    {
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x) set(x, y, codes);
    }
    void frame(int x0, int y0, int x1, int y1, const Codes& codes)
    {
        fill(x0, y0, x1, y0 + 1, codes), fill(x0, y1 - 1, x1, y1, codes);
        fill(x0, y0, x0 + 1, y1, codes), fill(x1 - 1, y0, x1, y1, codes);
    }
    /// Writes text, each pixel of the font as a square of `size`.
    void write(int left, int top, int size, const std::string& text, const Codes& codes)
    {
        for (std::size_t i = 0; i < text.size(); ++i)
            for (int y = 0; y < BitmapFont::cell_height; ++y)
                for (int x = 0; x < BitmapFont::cell_width; ++x)
                    if (BitmapFont::pixel(text[i], x, y)) {
                        const int px = left + size * (int(i) * BitmapFont::cell_width + x), py = top + size * y;
                        fill(px, py, px + size, py + size, codes);
                    }
    }
    Image take() { return std::move(image_); }

private:
    Image image_;
};

/// Values of the map and its scale.
struct Map {
    const std::vector<float>& values;
    double largest;  ///< value at the right end of the scale
    std::string name;
};

Map map_of(const ImageDifference& d)
{
    if (d.color) return {d.color->flip.map, 1, "FLIP"};
    double largest = 0;
    for (const float value : d.differences)
        if (std::isfinite(value)) largest = std::max(largest, double(value));
    return {d.differences, largest > 0 ? largest : 1, "difference"};
}

/// Lines of text below the map, short enough for small images.
std::vector<std::string> captions(const Comparison& c)
{
    const ImageDifference& d = c.difference;
    std::vector<std::string> lines;
    if (d.color)
        lines.push_back(fmt::format("FLIP: mean {:.4f}, largest {:.4f}", d.color->flip.mean, d.color->flip.max));
    lines.push_back(fmt::format("{} of {} pixels differ", d.different_pixels, std::int64_t(d.width) * d.height));
    if (d.largest.difference > 0)
        lines.push_back(fmt::format("most in {} of {},{}: {:.4g}", d.largest.channel, d.largest.x, d.largest.y,
                                    d.largest.difference));
    if (!c.noise || d.is_same()) return lines;
    if (c.noise->is_noise()) lines.emplace_back("explained by noise");
    if (c.noise->whole_changed) lines.emplace_back("the mean changed");
    if (!c.noise->changes.empty())
        lines.push_back(fmt::format("{} blocks changed (outlined)", c.noise->changes.size()));
    return lines;
}

/// The scale: a bar with its ends as numbers.
void draw_scale(Canvas& canvas, int left, int top, int width, int size, const Map& map)
{
    const int bar_height = 8 * size;
    for (int x = 0; x < width; ++x)
        canvas.fill(left + x, top, left + x + 1, top + bar_height, magma(x / double(width - 1)));
    canvas.frame(left, top, left + width, top + bar_height, gray);
    const std::string last = fmt::format("{:.3g}", map.largest);
    const int text_top = top + bar_height + 2 * size;
    const auto text_width = [&](const std::string& text) { return int(text.size()) * BitmapFont::cell_width * size; };
    canvas.write(left, text_top, size, "0", gray);
    canvas.write(left + (width - text_width(map.name)) / 2, text_top, size, map.name, gray);
    canvas.write(left + width - text_width(last), text_top, size, last, gray);
}

}  // namespace

Image difference_picture(const Comparison& c)
{
    constexpr int min_width = 240, margin = 6, scale_height = 22;
    const ImageDifference& d = c.difference;
    const Map map = map_of(d);
    const std::vector<std::string> lines = captions(c);
    // Small images are magnified, such that their pixels can be seen and the text has room.
    const int zoom = std::max(1, min_width / std::max(d.width, d.height));
    const int width = std::max(min_width, zoom * d.width), size = width >= 900 ? 2 : 1;
    const int text_height = size * BitmapFont::cell_height * int(lines.size());
    const int top = zoom * d.height, panel = 3 * margin + size * scale_height + text_height;
    Canvas canvas(width, top + panel);
    for (int y = 0; y < d.height; ++y)
        for (int x = 0; x < d.width; ++x) {
            const double value = double(map.values[std::size_t(y) * std::size_t(d.width) + std::size_t(x)]);
            canvas.fill(zoom * x, zoom * y, zoom * (x + 1), zoom * (y + 1), magma(value / map.largest));
        }
    if (c.noise && !d.is_same())
        for (const NoiseTest::Change& block : c.noise->changes)
            canvas.frame(zoom * block.x0, zoom * block.y0, zoom * block.x1, zoom * block.y1, outline);
    canvas.fill(0, top, width, top + 1, gray);
    draw_scale(canvas, margin, top + margin, width - 2 * margin, size, map);
    for (std::size_t i = 0; i < lines.size(); ++i)
        canvas.write(margin, top + 2 * margin + size * (scale_height + int(i) * BitmapFont::cell_height), size,
                     lines[i], white);
    return canvas.take();
}

void write_difference(const std::filesystem::path& file, const Comparison& c)
{
    if (!is_exr("", file)) return write_image(file, difference_picture(c), {});
    Image values;
    values.width = c.difference.width, values.height = c.difference.height;
    values.layers.push_back({"", {"Y"}, map_of(c.difference).values});
    write_image(file, values, {});
}

}  // namespace fathom::cli
