// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "formats/io/read_file.h"
#include "formats/mitsuba/mitsuba.h"
#include "formats/mitsuba/reader.h"
#include "scene/units.h"

namespace fathom {

namespace mitsuba {

namespace {

}  // namespace

void Reader::report(const Element& element, const std::string& message)
{
    const std::string& id = element.attribute("id");
    const std::string what = fmt::format("{}: {} '{}'", element.place.file ? *element.place.file : "",
                                         printable(element.tag), printable(element.type()));
    ReportCount& told = report_counts_[{what, message}];
    ++told.times;
    if (id.empty()) return;
    if (told.ids.empty()) told.first_id = id;
    told.ids.insert(id);
}

void Reader::add_reported_warnings()
{
    for (const auto& [key, told] : report_counts_) {
        const std::size_t others = told.ids.empty() ? 0 : told.ids.size() - 1;
        const std::string ids = told.ids.empty() ? ""
                                : others == 0    ? fmt::format(" ('{}')", printable(told.first_id))
                                                 : fmt::format(" ('{}' and {} more)", printable(told.first_id), others);
        context_.warnings.add(fmt::format("{}{}: {}", key.first, ids, key.second), told.times);
    }
}

SceneDescription Reader::read()
{
    scene_.file = document_.files.front();
    // A Mitsuba scene has its own light or is meant to be dark, so automatic lights are disabled.
    scene_.hints.own_light = true;
    // The sensor is read first, because shapes and film depend on it.
    for (const auto& child : document_.root->children)
        if (child->tag == "sensor") read_sensor(*child);
    for (const auto& child : document_.root->children) read_root(*child);
    if (hides_emitters_)
        for (const int lamp : emissive_materials_)
            scene_.materials[std::size_t(lamp)].visibility.hidden_from_camera = true;
    finish_media();
    add_reported_warnings();
    return std::move(scene_);
}

void Reader::read_root(const Element& element)
{
    const std::string& tag = element.tag;
    if (tag == "shape") return read_shape(element, scene_.roots);
    if (tag == "emitter") return read_emitter(element);
    if (tag == "integrator") return read_integrator(element);
    if (tag == "ref") {
        const Element& meant = document_.find(element);
        if (meant.tag == "shape" || meant.tag == "emitter") read_root(meant);
        return;
    }
    // These elements are read when something refers to them.
    for (const char* known :
         {"sensor", "bsdf", "texture", "medium", "alias", "spectrum", "rgb", "float", "string", "integer", "boolean"})
        if (tag == known) return;
    report(element, "is ignored");
}

void Reader::read_integrator(const Element& element)
{
    Object integrator(element, document_);
    // Integrators such as `aov` or `moment` wrap another one.
    if (const std::vector<const Element*> nested = integrator.children("integrator"); !nested.empty()) {
        report(element, "only the nested integrator is used");
        return read_integrator(*nested[0]);
    }
    const std::string& type = integrator.type();
    const bool direct = type == "direct";
    if (type != "path" && type != "volpath" && type != "volpathmis" && !direct)
        report(element, "is not supported: path tracing is used");
    // Mitsuba's max_depth counts path segments including the one to the light; Fathom counts scattering vertices.
    const int depth = direct ? 2 : integrator.integer("max_depth", -1);
    if (depth >= 0) scene_.hints.max_depth = std::max(0, depth - 1);
    scene_.hints.roulette_depth = direct ? 5 : integrator.integer("rr_depth", 5);
    if (integrator.boolean("hide_emitters", false)) hide_emitters();
    // Parameters of other integrators don't affect the result.
    if (type == "path") integrator.finish(context_.warnings);
}

/// Hides emissive shapes and the environment from camera rays.
void Reader::hide_emitters()
{
    scene_.hints.background = Color{0, 0, 0};
    hides_emitters_ = true;
}

void Reader::read_film(const Element& element)
{
    Object film(element, document_);
    scene_.hints.width = film.integer("width", 768);
    scene_.hints.height = film.integer("height", 576);
    if (*scene_.hints.width < 1 || *scene_.hints.height < 1 || *scene_.hints.width > 1 << 20 ||
        *scene_.hints.height > 1 << 20)
        element.fail("the film size must be from 1 to 1048576");
    read_crop(film);
    film.ignore({"file_format", "pixel_format", "component_format", "sample_border", "compensate", "banner", "gamma",
                 "variant", "high_quality_edges", "attach_log"});
    scene_.hints.filter = "gaussian";
    for (const Element* filter : film.children("rfilter")) {
        Object of(*filter, document_);
        const std::string& type = filter->type();
        const bool is_own = type == "box" || type == "tent" || type == "gaussian";
        scene_.hints.filter = is_own ? type : "blackman-harris";
        scene_.hints.filter_radius.reset();
        if (!is_own) {
            report(*filter, "filters with negative lobes are not supported: 'blackman-harris' is used");
            of.ignore({"B", "C", "lobes"});
        }
        // Both renderers truncate the Gaussian at four standard deviations.
        const double radius = type == "gaussian" ? 4 * of.number("stddev", 0.5)
                              : type == "box"    ? of.number("radius", 0.5)
                                                 : of.number("radius", 1);
        if (!(radius > 0 && radius <= 64)) filter->fail("the filter radius must be above 0 and at most 64 pixels");
        if (is_own && radius != (type == "gaussian" ? 2 : type == "box" ? 0.5 : 1)) scene_.hints.filter_radius = radius;
        of.finish(context_.warnings);
    }
    film.finish(context_.warnings);
}

/// Reads the crop window: the part of the film that is rendered.
void Reader::read_crop(Object& film)
{
    film_width_ = scene_.hints.width.value(), film_height_ = scene_.hints.height.value();
    const int x = film.integer("crop_offset_x", 0), y = film.integer("crop_offset_y", 0),
              width = film.integer("crop_width", film_width_ - x),
              height = film.integer("crop_height", film_height_ - y);
    if (x < 0 || y < 0 || width < 1 || height < 1 || width > film_width_ - x || height > film_height_ - y)
        film.element().fail(fmt::format("the crop of {}x{} pixels at {}, {} is not inside the film of {}x{}", width,
                                        height, x, y, film_width_, film_height_));
    scene_.hints.width = width, scene_.hints.height = height;
    crop_middle_ = {x + width / 2.0, y + height / 2.0};
}

/// Converts the camera of the whole film to that of the crop window, by lens shift and field of view.
void Reader::look_at_crop(Object& sensor, Camera& camera) const
{
    const double width = scene_.hints.width.value_or(film_width_), height = scene_.hints.height.value_or(film_height_);
    camera.fov_aspect = width / height;
    camera.height *= height / film_height_;
    if (height != film_height_) camera.fov_y = 2 * std::atan(std::tan(camera.fov_y / 2) * height / film_height_);
    const auto offset = [&](const char* name) {
        return camera.kind == CameraKind::perspective ? sensor.number(name, 0) : 0;
    };
    camera.shift_x = (crop_middle_[0] + (offset("principal_point_offset_x") - 0.5) * film_width_) / width;
    camera.shift_y = ((0.5 - offset("principal_point_offset_y")) * film_height_ - crop_middle_[1]) / height;
}

Reader::FieldOfView Reader::field_of_view(Object& object)
{
    if (object.has("fov")) {
        const double fov = object.number("fov", 0);
        if (!(fov > 0 && fov < 180)) object.element().fail("'fov' must be above 0 and below 180 degrees");
        const std::string axis = object.text("fov_axis", "x");
        return {fov * radians_per_degree, axis == "y"          ? FovAxis::height
                                          : axis == "diagonal" ? FovAxis::diagonal
                                          : axis == "smaller"  ? FovAxis::smaller
                                          : axis == "larger"   ? FovAxis::larger
                                                               : FovAxis::width};
    }
    // Focal lengths refer to the diagonal of a 36 by 24 mm image.
    std::string text = object.text("focal_length", "50mm");
    if (text.ends_with("mm")) text.resize(text.size() - 2);
    const std::vector<double> f = numbers_of(object.element(), text);
    if (f.size() != 1 || !(f[0] > 0)) object.element().fail("'focal_length' must be a length in mm, such as 50mm");
    return {2 * std::atan(std::hypot(36, 24) / 2 / f[0]), FovAxis::diagonal};
}

double Reader::vertical_fov(Object& sensor, double aspect)
{
    const auto [angle, axis] = field_of_view(sensor);
    const double half = std::tan(angle / 2);
    if (axis == FovAxis::height || axis == (aspect >= 1 ? FovAxis::smaller : FovAxis::larger)) return angle;
    if (axis == FovAxis::diagonal) return 2 * std::atan(half / std::hypot(1, aspect));
    return 2 * std::atan(half / aspect);
}

void Reader::read_sensor(const Element& element)
{
    Object sensor(element, document_);
    for (const Element* film : sensor.children("film"))
        if (!scene_.hints.width) read_film(*film);
    for (const Element* sampler : sensor.children("sampler")) {
        Object object(*sampler, document_);
        if (!scene_.hints.samples) scene_.hints.samples = std::max(1, object.integer("sample_count", 4));
    }
    const std::string& type = sensor.type();
    if (type != "perspective" && type != "thinlens" && type != "orthographic") {
        report(element, "is not supported and is ignored");
        return;
    }
    const double aspect = double(film_width_) / film_height_;
    const Transform world = sensor.transform("to_world");
    Camera camera;
    camera.name = element.attribute("id");
    camera.position = world.point({0, 0, 0});
    camera.look_at = world.point({0, 0, 1});
    camera.up = normalize(world.vector({0, 1, 0}));
    if (world.determinant() < 0) report(element, "mirroring by a camera's transform is not supported and is ignored");
    if (type == "orthographic") {
        camera.kind = CameraKind::orthographic;
        camera.height = 2 * length(world.vector({1, 0, 0})) / aspect;
        camera.fov_axis = FovAxis::width;
    } else {
        camera.fov_y = vertical_fov(sensor, aspect);
        camera.fov_axis = field_of_view(sensor).axis;
    }
    // The first sensor is the one that is rendered.
    if (const Element* medium = sensor.child("medium"); medium && scene_.cameras.empty()) camera_medium_ = medium;
    if (type == "thinlens") camera.aperture = 2 * sensor.number("aperture_radius", 0);
    camera.focus_distance = type == "thinlens" ? sensor.number("focus_distance", 1) : 0;
    camera.shutter_open = sensor.number("shutter_open", 0);
    camera.shutter_close = std::max(camera.shutter_open, sensor.number("shutter_close", 0));
    look_at_crop(sensor, camera);
    sensor.ignore({"near_clip", "far_clip", "fov", "fov_axis", "focus_distance", "aperture_radius", "srf"});
    sensor.finish(context_.warnings);
    scene_.cameras.push_back(camera);
    Node node;
    node.camera = int(scene_.cameras.size()) - 1;
    scene_.roots.push_back(add_node(std::move(node)));
}

}  // namespace mitsuba

SceneDescription read_mitsuba(const SourceFile& file, LoadContext& context)
{
    const mitsuba::Document document =
        mitsuba::read_document(file.path, file.bytes(), file.options.definitions, context);
    return mitsuba::Reader(document, context).read();
}

}  // namespace fathom
