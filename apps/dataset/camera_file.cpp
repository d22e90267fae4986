// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "dataset/view_cameras.h"
#include "fathom/error.h"

namespace fathom::cli {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Reads one transforms.json.
class CameraReader {
public:
    CameraReader(const fs::path& file, const std::optional<Size>& size) : file_(file.string()), size_(size) {}

    CameraFile read()
    {
        const Json all = parse();
        if (!all.is_object() || !all.contains("frames") || !all["frames"].is_array())
            fail("", "expected an object with the list 'frames'");
        CameraFile result;
        if (!size_) result.size = size_ = own_size(all);
        if (all["frames"].empty()) fail("frames", "the list is empty");
        for (std::size_t i = 0; i < all["frames"].size(); ++i)
            result.cameras.push_back(camera(all, all["frames"][i], fmt::format("frames[{}]", i)));
        return result;
    }

private:
    [[noreturn]] void fail(const std::string& place, const std::string& message) const
    {
        throw Error(file_, place, message);
    }

    Json parse() const
    {
        std::ifstream stream(file_);
        if (!stream) fail("", "can't be read");
        Json all = Json::parse(stream, nullptr, false);
        if (all.is_discarded()) fail("", "is not valid JSON");
        return all;
    }

    std::optional<double> number(const Json& object, const std::string& place, const char* key) const
    {
        if (!object.contains(key)) return {};
        if (!object[key].is_number()) fail(place, fmt::format("'{}': expected a number", key));
        const double value = object[key];
        if (!std::isfinite(value)) fail(place, fmt::format("'{}': the number is not finite", key));
        return value;
    }
    /// A number of the frame, or else of the whole file.
    std::optional<double> number(const Json& all, const Json& frame, const std::string& place, const char* key) const
    {
        const std::optional<double> own = number(frame, place, key);
        return own ? own : number(all, "", key);
    }

    std::optional<Size> own_size(const Json& all) const
    {
        const std::optional<double> w = number(all, "", "w"), h = number(all, "", "h");
        if (!w || !h) return {};
        if (!(*w >= 1 && *w <= 65535 && *h >= 1 && *h <= 65535)) fail("w, h", "sizes are 1 to 65535 pixels");
        return Size{int(*w), int(*h)};
    }

    Camera camera(const Json& all, const Json& frame, const std::string& place) const
    {
        if (!frame.is_object()) fail(place, "expected an object");
        for (const char* key : {"k1", "k2", "k3", "k4", "p1", "p2"})
            if (number(all, frame, place, key).value_or(0) != 0)
                fail(place, fmt::format("'{}': lens distortion can't be rendered; set it to 0", key));
        Camera camera;
        set_pose(camera, matrix(frame, place), place);
        set_lens(camera, all, frame, place);
        camera.name = frame.contains("file_path") && frame["file_path"].is_string() ? frame["file_path"] : Json(place);
        return camera;
    }

    Transform matrix(const Json& frame, const std::string& place) const
    {
        const std::string at = place + ".transform_matrix";
        if (!frame.contains("transform_matrix")) fail(place, "'transform_matrix' is missing");
        const Json& rows = frame["transform_matrix"];
        Transform t;
        bool fits = rows.is_array() && (rows.size() == 3 || rows.size() == 4);
        for (std::size_t r = 0; fits && r < 3; ++r) {
            fits = rows[r].is_array() && rows[r].size() == 4;
            for (std::size_t c = 0; fits && c < 4; ++c) {
                fits = rows[r][c].is_number() && std::isfinite(rows[r][c].get<double>());
                if (fits) t.m[r][c] = rows[r][c];
            }
        }
        if (!fits) fail(at, "expected 4x4 finite numbers");
        return t;
    }

    void set_pose(Camera& camera, const Transform& z_up_from_camera, const std::string& place) const
    {
        const Transform t = z_up_from_world().inverse() * z_up_from_camera;
        const Vec3d back = t.vector({0, 0, 1}), up = t.vector({0, 1, 0});
        if (!(length(cross(normalize(back), normalize(up))) > 1e-3) || t.determinant() <= 0)
            fail(place + ".transform_matrix", "the axes must be those of a rotation");
        camera.position = t.point({});
        camera.look_at = camera.position - normalize(back);
        camera.up = normalize(up);
    }

    void set_lens(Camera& camera, const Json& all, const Json& frame, const std::string& place) const
    {
        const Size size = size_.value_or(Size{800, 800});
        const Size given = own_size(all).value_or(size);
        const std::optional<double> fx = number(all, frame, place, "fl_x"), fy = number(all, frame, place, "fl_y");
        const std::optional<double> angle = number(all, frame, place, "camera_angle_x");
        if (fx && fy && std::abs(*fx / *fy - 1) > 1e-3)
            fail(place, "'fl_x', 'fl_y': pixels that are not square can't be rendered");
        const double aspect = double(size.width) / size.height;
        double half_width = 0;  // tangent of half the horizontal angle of view
        if (fx)
            half_width = 0.5 * given.width / *fx;
        else if (angle)
            half_width = std::tan(*angle / 2);
        else
            fail(place, "neither 'fl_x' nor 'camera_angle_x' says the angle of view");
        if (!(half_width > 1e-6 && half_width < 1e3))
            fail(place, "the angle of view must be above 0 and below 180 degrees");
        camera.fov_y = 2 * std::atan(half_width / aspect);
        if (const auto cx = number(all, frame, place, "cx")) camera.shift_x = 0.5 - *cx / given.width;
        if (const auto cy = number(all, frame, place, "cy")) camera.shift_y = *cy / given.height - 0.5;
    }

    std::string file_;
    std::optional<Size> size_;
};

}  // namespace

CameraFile read_camera_file(const fs::path& file, const std::optional<Size>& size)
{
    return CameraReader(file, size).read();
}

}  // namespace fathom::cli
