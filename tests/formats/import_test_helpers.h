// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "fathom/load.h"
#include "support/error_message.h"
#include "support/near.h"

namespace fathom::test {

/// Fixture with a temporary folder for each test, removed afterwards.
class ImportTest : public ::testing::Test {
protected:
    void SetUp() override
    {
        const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() / (std::string("fathom_") + info->test_suite_name() + '_' +
                                                            info->name() + '_' + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path write(const std::string& name, const std::string& content)
    {
        const std::filesystem::path path = folder_ / name;
        std::ofstream(path, std::ios::binary) << content;
        return path;
    }
    SceneDescription load(const std::string& name, const std::string& content)
    {
        return load_scene(write(name, content), {}, warnings_);
    }
    /// Error message after the file name, or "loaded".
    std::string error_of(const std::string& name, const std::string& content) { return error_of(write(name, content)); }
    std::string error_of(const std::filesystem::path& path)
    {
        return error_in_file(path.string(), [&] { load_scene(path, {}, warnings_); });
    }

    /// Number of warnings that contain these words.
    std::size_t warning_count(const std::string& words) const
    {
        std::size_t count = 0;
        for (const auto& [message, times] : warnings_.counts())
            if (message.find(words) != std::string::npos) count += times;
        return count;
    }
    bool has_warning(const std::string& words) const { return warning_count(words) > 0; }

    std::filesystem::path folder_;
    Warnings warnings_;
};

inline constexpr double degree = std::numbers::pi / 180;

inline void expect_color(const Color& c, double r, double g, double b, double tolerance = 1e-6)
{
    EXPECT_NEAR(c.r, r, tolerance);
    EXPECT_NEAR(c.g, g, tolerance);
    EXPECT_NEAR(c.b, b, tolerance);
}

/// Normal of the triangle whose three indices begin at `first`, as long as its area.
inline Vec3d area_vector(const Mesh& mesh, std::size_t first)
{
    const auto corner = [&](std::size_t k) {
        const Vec3f p = mesh.positions[mesh.indices[first + k]];
        return Vec3d{p.x, p.y, p.z};
    };
    return cross(corner(1) - corner(0), corner(2) - corner(0)) * 0.5;
}

inline std::string bytes_of(const std::filesystem::path& file)
{
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace fathom::test
