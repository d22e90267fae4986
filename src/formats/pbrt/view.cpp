// SPDX-License-Identifier: Apache-2.0
// Reading of camera, film, filter, sampler and integrator.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "formats/io/read_file.h"
#include "formats/pbrt/reader.h"
#include "scene/units.h"

namespace fathom::pbrt {

namespace {

constexpr int max_pixels = 1 << 20;

/// The part of the film plane at distance 1 that is visible with a field of view of 90 degrees: left, right, bottom,
/// top.
std::array<double, 4> screen(const Parameters& camera, double aspect)
{
    const std::vector<float> said = camera.numbers("screenwindow");
    if (!said.empty()) {
        if (said.size() != 4 || !(said[1] > said[0]) || !(said[3] > said[2]))
            camera.fail("'screenwindow' must be four numbers: left, right, bottom, top");
        return {said[0], said[1], said[2], said[3]};
    }
    // The shorter side spans [-1, 1].
    if (aspect > 1) return {-aspect, aspect, -1, 1};
    return {-1, 1, -1 / aspect, 1 / aspect};
}

}  // namespace

void Reader::read_film(const Parameters& film)
{
    const int width = film.integer("xresolution", 1280), height = film.integer("yresolution", 720);
    if (width < 1 || height < 1 || width > max_pixels || height > max_pixels)
        film.fail(fmt::format("the film size must be from 1 to {}", max_pixels));
    read_crop(film, width, height);
    if (film.plugin() != "rgb") report(film, "is not supported: 'rgb' is used");
    film.ignore({"cropwindow", "pixelbounds", "filename", "savefp16", "diagonal"});
    const std::string sensor = film.text("sensor", "cie1931");
    const double iso = film.number("iso", 100);
    if (!(iso > 0)) film.fail("'iso' must be above 0");
    // An exposure time of 1 s at ISO 100 leaves radiance unscaled.
    const double open = camera_ ? camera_->number("shutteropen", 0) : 0,
                 close = camera_ ? camera_->number("shutterclose", 1) : 1;
    const double ratio = (close - open) * iso / 100;
    if (ratio > 0 && ratio != 1) scene_.hints.exposure = std::log2(ratio);
    // maxcomponentvalue refers to the sensor's values. It darkens images (a bias), so the warning suggests an option
    // instead of applying it.
    const double most = film.number("maxcomponentvalue", std::numeric_limits<double>::infinity());
    if (std::isfinite(most) && ratio > 0)
        report(film, fmt::format("'maxcomponentvalue' is ignored, because it darkens images: samples are not clamped; "
                                 "--clamp-indirect {:.4g} clamps those of light from two surfaces or more",
                                 most / ratio));
    if (sensor != "cie1931")
        report(film,
               fmt::format("the sensor '{}' is not supported: 'cie1931' is used, without the colors of its filters",
                           printable(sensor)));
    // Fathom's default white corresponds to pbrt's white balance of 6500 K.
    if (const double kelvin = film.number("whitebalance", 0); kelvin != 0) {
        scene_.hints.white_balance = std::clamp(kelvin, min_white_kelvin, max_white_kelvin);
        if (kelvin != *scene_.hints.white_balance)
            report(film, fmt::format("'whitebalance' is out of range: {} K is used", *scene_.hints.white_balance));
    }
    film.finish(reporter_);
}

/// Reads the crop window in pixels; 'pixelbounds' takes precedence over 'cropwindow', as in pbrt.
void Reader::read_crop(const Parameters& film, int width, int height)
{
    const std::vector<std::int32_t> bounds = film.integers("pixelbounds");
    const std::vector<float> window = film.numbers("cropwindow");
    std::array<int, 4> part = {0, width, 0, height};
    if (!bounds.empty()) {
        if (bounds.size() != 4) film.fail("'pixelbounds' must be four numbers: x0, x1, y0, y1");
        for (int i = 0; i < 4; ++i) part[i] = std::clamp(bounds[i], 0, i < 2 ? width : height);
    } else if (!window.empty()) {
        if (window.size() != 4) film.fail("'cropwindow' must be four numbers from 0 to 1: x0, x1, y0, y1");
        for (int i = 0; i < 4; ++i)
            part[i] = int(std::ceil((i < 2 ? width : height) * std::clamp(window[i], 0.f, 1.f)));
    }
    if (part[0] >= part[1] || part[2] >= part[3]) film.fail("its crop is empty");
    scene_.hints.width = part[1] - part[0], scene_.hints.height = part[3] - part[2];
    film_size_ = {width, height};
    crop_ = part;
}

void Reader::read_filter(const Parameters& filter)
{
    const std::string& type = filter.plugin();
    const bool is_triangle = type == "triangle", is_gaussian = type == "gaussian";
    const bool is_own = type == "box" || is_triangle || is_gaussian;
    scene_.hints.filter = is_triangle ? "tent" : is_own ? type : "blackman-harris";
    scene_.hints.filter_radius.reset();
    if (!is_own) {
        report(filter, "filters with negative lobes are not supported: 'blackman-harris' is used");
        filter.ignore({"xradius", "yradius", "B", "C", "tau"});
    } else {
        const double usual = is_triangle   ? 2
                             : is_gaussian ? 1.5
                                           : 0.5,
                     x = filter.number("xradius", usual), y = filter.number("yradius", usual);
        if (x != y) report(filter, "different radii along x and y are not supported: the radius along x is used");
        // Fathom's radius is four standard deviations; the weight of pbrt's Gaussian beyond them is negligible.
        const double radius = is_gaussian ? 4 * filter.number("sigma", 0.5) : x;
        if (!(radius > 0 && radius <= 64)) filter.fail("the filter radius must be above 0 and at most 64 pixels");
        if (radius != (is_gaussian ? 2 : is_triangle ? 1 : 0.5)) scene_.hints.filter_radius = radius;
    }
    filter.finish(reporter_);
}

void Reader::read_sampler(const Parameters& sampler)
{
    const int samples = sampler.plugin() == "stratified"
                            ? sampler.integer("xsamples", 4) * sampler.integer("ysamples", 4)
                            : sampler.integer("pixelsamples", 16);
    scene_.hints.samples = std::clamp(samples, 1, 1 << 24);
    // Fathom uses its own sample distribution.
    sampler.ignore({"randomization", "seed", "jitter", "pixelsamples", "xsamples", "ysamples"});
    sampler.finish(reporter_);
}

void Reader::read_integrator(const Parameters& integrator)
{
    const std::string& type = integrator.plugin();
    if (type != "path" && type != "volpath") report(integrator, "is not supported: path tracing is used");
    scene_.hints.max_depth = std::max(0, integrator.integer("maxdepth", 5));
    // Parameters of light sampling and of other integrators don't affect the expected image.
    if (type == "path" || type == "volpath") {
        integrator.ignore({"lightsampler"});
        if (integrator.boolean("regularize", false)) report(integrator, "'regularize' is ignored");
        integrator.finish(reporter_);
    }
}

void Reader::finish_camera()
{
    if (!scene_.hints.filter) scene_.hints.filter = "gaussian";
    if (film_) read_film(*film_);
    if (camera_) read_camera(*camera_);
}

/// The part of the screen window that the crop shows.
std::array<double, 4> Reader::crop_window(const std::array<double, 4>& window) const
{
    const auto x = [&](int at) { return std::lerp(window[0], window[1], double(at) / film_size_[0]); };
    const auto y = [&](int at) { return std::lerp(window[3], window[2], double(at) / film_size_[1]); };
    return {x(crop_[0]), x(crop_[1]), y(crop_[3]), y(crop_[2])};
}

/// A camera's position and shift, without its projection.
Camera Reader::placed_camera(const Parameters& of, const std::array<double, 4>& window) const
{
    const double width = window[1] - window[0], height = window[3] - window[2];
    Camera camera;
    // By default the screen window grows along the longer side; an explicit window keeps its height.
    if (!of.has("screenwindow")) camera.fov_axis = FovAxis::smaller, camera.fov_aspect = width / height;
    camera.shift_x = (window[0] + window[1]) / 2 / width, camera.shift_y = (window[2] + window[3]) / 2 / height;
    camera.position = world_from_camera_.point({0, 0, 0});
    camera.look_at = world_from_camera_.point({0, 0, 1});
    camera.up = normalize(world_from_camera_.vector({0, 1, 0}));
    return camera;
}

void Reader::read_spherical(const Parameters& of, Camera& camera)
{
    const std::string mapping = of.text("mapping", "equalarea");
    if (mapping != "equalarea" && mapping != "equirectangular")
        of.fail(fmt::format("'mapping' must be 'equalarea' or 'equirectangular', found '{}'", printable(mapping)));
    const bool equal = mapping == "equalarea";
    camera.kind = equal ? CameraKind::equal_area : CameraKind::spherical;
    camera.look_at = world_from_camera_.point(equal ? Vec3d{0, 0, -1} : Vec3d{-1, 0, 0});
    camera.shift_x = camera.shift_y = 0;
    if (crop_ != std::array<int, 4>{0, film_size_[0], 0, film_size_[1]})
        report(of, "the crop of a spherical camera is ignored: the image shows all directions");
}

void Reader::read_realistic(const Parameters& of, double aspect, double scale, Camera& camera)
{
    report(of, "the lens is approximated by a thin lens, with a film diagonal of 35 mm");
    camera.aperture = of.number("aperturediameter", 1) * 1e-3 * scale;
    camera.focus_distance = of.number("focusdistance", 10) * scale;
    // Lens files are not supported; a 50 mm lens is assumed.
    const double film_height = 0.035 / std::hypot(1, aspect) * (crop_[3] - crop_[2]) / film_size_[1];
    camera.fov_y = 2 * std::atan(film_height / 2 / 0.050);
    of.ignore({"lensfile", "aperture"});
}

void Reader::read_perspective(const Parameters& of, double half_height, Camera& camera)
{
    const double fov = of.number("fov", 90) * radians_per_degree;
    if (!(fov > 0) || !(fov < std::numbers::pi)) of.fail("'fov' must be above 0 and below 180 degrees");
    camera.fov_y = 2 * std::atan(std::tan(fov / 2) * half_height);
    if (of.plugin() != "perspective") report(of, "is not supported: a perspective camera is used");
}

void Reader::read_thin_lens(const Parameters& of, double scale, Camera& camera)
{
    const double radius = of.number("lensradius", 0);
    if (of.plugin() == "perspective")
        camera.aperture = 2 * radius * scale;
    else if (radius > 0)
        report(of, "the lens of an orthographic camera is ignored");
    const double focus = of.number("focaldistance", 1e6);
    camera.focus_distance = radius > 0 ? focus * scale : 0;
}

void Reader::read_camera(const Parameters& of)
{
    const std::string& type = of.plugin();
    const double determinant = world_from_camera_.determinant();
    if (!std::isnormal(determinant)) of.fail("its transform must be invertible");
    // pbrt's cameras are left-handed: x right, y up, z forward. Images of spherical cameras are mirrored.
    mirrored_ = (determinant > 0) != (type == "spherical");
    const double said = of.number("frameaspectratio", 0);
    const double aspect = said > 0 ? said : double(film_size_[0]) / film_size_[1];
    if (said > 0) report(of, "'frameaspectratio' applies to the view only: the image has the film's size");
    const std::array<double, 4> window = crop_window(screen(of, aspect));
    Camera camera = placed_camera(of, window);
    const double half_height = (window[3] - window[2]) / 2;
    const double scale = std::cbrt(std::abs(determinant));
    if (type == "orthographic") {
        camera.kind = CameraKind::orthographic;
        camera.height = 2 * half_height * length(world_from_camera_.vector({0, 1, 0}));
    } else if (type == "spherical") {
        read_spherical(of, camera);
    } else if (type == "realistic") {
        read_realistic(of, aspect, scale, camera);
    } else {
        read_perspective(of, half_height, camera);
    }
    if (type == "perspective" || type == "orthographic") read_thin_lens(of, scale, camera);
    camera.shutter_open = of.number("shutteropen", 0);
    camera.shutter_close = std::max(camera.shutter_open, of.number("shutterclose", 1));
    of.finish(reporter_);
    scene_.cameras.push_back(camera);
    Node node;
    node.camera = int(scene_.cameras.size()) - 1;
    scene_.roots.push_back(add_node(std::move(node)));
}

}  // namespace fathom::pbrt
