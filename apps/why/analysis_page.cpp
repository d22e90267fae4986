// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "report/cost_sheet.h"
#include "report/magma.h"
#include "why/analysis.h"

namespace fathom::cli {

namespace {

/// Rows of a table that the page shows.
constexpr std::size_t max_page_rows = 30;
/// Fraction of a map's values that its scale covers; brighter pixels have the last color.
constexpr double covered = 0.99;

constexpr const char* page_head = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>{title}</title>
<style>
body {{ font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 70em; padding: 0 1em; color: #222; background: #fff; }}
h1 {{ font-size: 1.4em; }} h2 {{ font-size: 1.1em; margin-top: 2em; }}
table {{ border-collapse: collapse; width: 100%; }}
th, td {{ text-align: left; padding: 2px 10px 2px 0; white-space: nowrap; }} td.name {{ width: 100%; white-space: normal; }}
.bar {{ display: inline-block; height: .75em; vertical-align: baseline; }}
.track {{ display: inline-block; width: 7em; }}
.noise {{ background: #b5367a; }} .time {{ background: #2a6f97; }} .light {{ background: #d9a400; }}
.maps {{ display: flex; flex-wrap: wrap; gap: 1em; }} figure {{ margin: 0; flex: 1 1 18em; }}
figure img {{ width: 100%; image-rendering: pixelated; }} .scale {{ height: 10px; }} figcaption {{ font-size: .9em; }}
.ends {{ display: flex; justify-content: space-between; font-size: .8em; }}
li {{ margin-bottom: .6em; }} .cause {{ color: #555; }}
@media (prefers-color-scheme: dark) {{ body {{ color: #ddd; background: #181818; }} .cause {{ color: #aaa; }} }}
</style></head><body>
)";

std::string escaped(const std::string& text)
{
    std::string result;
    for (const char c : text) {
        if (c == '&')
            result += "&amp;";
        else if (c == '<')
            result += "&lt;";
        else if (c == '>')
            result += "&gt;";
        else if (c == '"')
            result += "&quot;";
        else
            result += c;
    }
    return result;
}

std::string base64(const std::vector<unsigned char>& bytes)
{
    constexpr const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t word = 0;
        for (std::size_t k = 0; k < 3; ++k) word = word << 8 | (i + k < bytes.size() ? bytes[i + k] : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[word >> (18 - 6 * k) & 63];
    }
    return text;
}

std::string image_tag(Image image, const WriteOptions& options, const std::string& description)
{
    return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">", escaped(description),
                       base64(encode_png_image(image, options)));
}

Image make_picture(int width, int height)
{
    Image image;
    image.width = width, image.height = height;
    image.layers.push_back({"", {"R", "G", "B"}, std::vector<float>(3 * std::size_t(width) * std::size_t(height))});
    return image;
}

/// Value that the given fraction of the values does not exceed.
double quantile(std::vector<float> values, double fraction)
{
    const auto at = values.begin() + std::ptrdiff_t(fraction * double(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return double(*at);
}

std::string scale_tag(const std::string& last)
{
    std::string stops;
    for (int i = 0; i <= 9; ++i) {
        const Codes c = magma(i / 9.0);
        stops += fmt::format("{}rgb({:.0f},{:.0f},{:.0f})", i ? "," : "", c[0], c[1], c[2]);
    }
    return fmt::format(
        "<div class=\"scale\" style=\"background:linear-gradient(to right,{})\"></div>"
        "<div class=\"ends\"><span>0</span><span>{}</span></div>",
        stops, escaped(last));
}

template <class Text>
std::string map_figure(const RenderProfile& p, const std::vector<float>& values, const std::string& caption,
                       const Text& scale_end)
{
    const double largest = quantile(values, covered), end = largest > 0 ? largest : 1;
    Image image = make_picture(p.width, p.height);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const Codes codes = magma(double(values[i]) / end);
        for (std::size_t c = 0; c < 3; ++c) image.layers[0].pixels[3 * i + c] = linear_from_code(codes[c]);
    }
    return fmt::format("<figure>{}{}<figcaption>{}</figcaption></figure>\n", image_tag(std::move(image), {}, caption),
                       scale_tag(scale_end(largest)), escaped(caption));
}

std::string maps(const Analysis& a)
{
    const RenderProfile& p = a.profile;
    Image shown = make_picture(p.width, p.height);
    shown.layers[0].pixels = p.image;
    WriteOptions options;
    options.display = a.display;
    return "<div class=\"maps\">\n<figure>" + image_tag(std::move(shown), options, "the image") +
           "<figcaption>The image</figcaption></figure>\n" +
           map_figure(p, p.pixel_error, "Noise: relative error of each pixel", percent) +
           map_figure(p, p.pixel_seconds, "Cost: processor time of each pixel",
                      [](double s) { return fmt::format("{:.3g} ms", 1000 * s); }) +
           "</div>\n";
}

std::string bar(const char* kind, double share, const std::string& title)
{
    return fmt::format(
        "<td title=\"{}\"><span class=\"track\"><span class=\"bar {}\" style=\"width:{:.1f}%\"></span></span> {}</td>",
        escaped(title), kind, 100 * std::clamp(share, 0.0, 1.0), percent(share));
}

std::string table_html(const NamedTable& table, const CauseNames& names)
{
    std::string html = fmt::format("<h2>By {}</h2>\n<table><tr><th>noise</th>{}<th>light</th><th></th></tr>\n",
                                   table.title, table.has_work ? "<th>time</th>" : "");
    for (std::size_t i = 0; i < std::min(table.rows.size(), max_page_rows); ++i) {
        const ProfileRow& row = table.rows[i];
        html += "<tr>" + bar("noise", row.noise, fmt::format("standard error {:.1f} %", 100 * row.noise_error)) +
                (table.has_work
                     ? bar("time", row.time, fmt::format("{} rays, {} of them shadow rays", row.rays, row.shadow_rays))
                     : "") +
                bar("light", row.light, "of the image's light") +
                fmt::format("<td class=\"name\">{}</td></tr>\n", escaped(names.name(row)));
    }
    html += "</table>\n";
    if (table.rows.size() > max_page_rows)
        html += fmt::format("<p>{} more rows have less noise.</p>\n", table.rows.size() - max_page_rows);
    return html;
}

std::string remedies_html(const std::vector<Remedy>& remedies)
{
    std::string helping, useless;
    for (const Remedy& r : remedies) {
        if (r.helps())
            helping += fmt::format("<li><b>{}</b>: {}<br><span class=\"cause\">against {}{}</span></li>\n",
                                   escaped(r.action), escaped(gain_text(r.gain)), escaped(r.cause),
                                   escaped(r.price.empty() ? "" : "; " + r.price));
        else
            useless += fmt::format("{}{} ({:.2g})", useless.empty() ? "" : ", ", escaped(r.action), r.gain.value);
    }
    std::string html = "<h2>What helps, as measured</h2>\n";
    html += helping.empty() ? "<p>Nothing that was tried.</p>\n" : "<ol>" + helping + "</ol>\n";
    if (!useless.empty())
        html += fmt::format("<p class=\"cause\">Tried, without a gain that is certain: {}</p>\n", useless);
    return html;
}

}  // namespace

std::string analysis_page(const Analysis& a)
{
    const RenderProfile& p = a.profile;
    const std::string title = fmt::format("Why {} is noisy and slow", a.file);
    std::string html = fmt::format(page_head, fmt::arg("title", escaped(title)));
    html += fmt::format(
        "<h1>{}</h1>\n<p>{}x{} pixels, {} samples per pixel: error {}, {:.1f} s of processor time, {}rays</p>\n<ol>\n",
        escaped(title), p.width, p.height, p.samples_per_pixel, percent(p.error), p.seconds,
        with_prefix(double(p.rays)));
    for (const std::string& line : largest_causes(p, a.names)) html += fmt::format("<li>{}</li>\n", escaped(line));
    html += "</ol>\n" + maps(a) + remedies_html(a.remedies);
    for (const NamedTable& table : tables_of(p)) html += table_html(table, a.names);
    return html + "</body></html>\n";
}

}  // namespace fathom::cli
