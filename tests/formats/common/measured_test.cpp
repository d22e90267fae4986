// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>

#include "formats/common/measured_file.h"
#include "formats/common/spectra.h"
#include "formats/import_test_helpers.h"

namespace fathom::test {
namespace {

/// An RGL measured BSDF file with separate fields, so that each can be corrupted.
struct File {
    struct Field {
        std::string name;
        std::vector<std::uint64_t> shape;
        std::vector<float> values;
        int type = 10;
        std::string bytes = {};  ///< raw bytes, in place of values
    };
    std::vector<Field> fields;
    std::string magic = std::string("tensor_file\0\1\0", 14);
    std::int64_t offset_error = 0;
    std::uint32_t count_error = 0;

    Field& operator[](const std::string& name)
    {
        for (Field& f : fields)
            if (f.name == name) return f;
        throw std::runtime_error("no field " + name);
    }
    std::string bytes() const
    {
        std::string header = magic, data;
        const auto put = [&](std::uint64_t value, int size) {
            for (int i = 0; i < size; ++i) header += char(value >> (8 * i) & 0xff);
        };
        std::size_t size = header.size() + 4;
        for (const Field& f : fields) size += 13 + f.name.size() + 8 * f.shape.size();
        put(fields.size() + count_error, 4);
        for (const Field& f : fields) {
            put(f.name.size(), 2);
            header += f.name;
            put(f.shape.size(), 2), put(std::uint64_t(f.type), 1);
            put(std::uint64_t(std::int64_t(size + data.size()) + offset_error), 8);
            for (const std::uint64_t n : f.shape) put(n, 8);
            data += f.values.empty() ? f.bytes
                                     : std::string(reinterpret_cast<const char*>(f.values.data()), f.values.size() * 4);
        }
        return header + data;
    }
};

std::vector<float> count_from(float first, std::size_t n)
{
    std::vector<float> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(first + float(i) / 64);
    return values;
}

/// A valid file in which all sizes and all values differ.
File file_of(bool spectral = false)
{
    File file;
    const std::uint64_t channels = spectral ? 4 : 3;
    file.fields = {{"phi_i", {3}, {-3, 0, 3}},
                   {"theta_i", {2}, {0, 1}},
                   {"ndf", {3, 2}, count_from(1, 6)},
                   {"sigma", {2, 4}, count_from(2, 8)},
                   {"vndf", {3, 2, 2, 3}, count_from(3, 36)},
                   {"luminance", {3, 2, 4, 2}, count_from(4, 48)},
                   {spectral ? "spectra" : "rgb", {3, 2, channels, 2, 3}, count_from(5, 36 * channels)},
                   {"jacobian", {1}, {}, 1, std::string(1, '\1')},
                   {"description", {4}, {}, 1, "felt"}};
    if (spectral) file.fields.push_back({"wavelengths", {4}, {420, 480, 570, 700}});
    return file;
}

MeasuredBrdf read(const File& file)
{
    return read_measured("folder/felt.bsdf", file.bytes());
}

void expect_table(const MeasuredTable& table, int width, int height, const std::vector<float>& values)
{
    EXPECT_EQ(table.width, width);
    EXPECT_EQ(table.height, height);
    EXPECT_EQ(table.values, values);
}

TEST(MeasuredFile, EachTable)
{
    File file = file_of();
    const MeasuredBrdf brdf = read(file);
    EXPECT_EQ(brdf.name, "felt.bsdf");
    EXPECT_EQ(brdf.phi, (std::vector<float>{-3, 0, 3}));
    EXPECT_EQ(brdf.theta, (std::vector<float>{0, 1}));
    expect_table(brdf.ndf, 2, 3, count_from(1, 6));
    expect_table(brdf.sigma, 4, 2, count_from(2, 8));
    expect_table(brdf.vndf, 3, 2, count_from(3, 36));
    expect_table(brdf.luminance, 2, 4, count_from(4, 48));
    expect_table(brdf.color, 3, 2, count_from(5, 108));
    EXPECT_TRUE(brdf.color_is_per_facet);
    EXPECT_FALSE(brdf.is_isotropic());
    file["jacobian"].bytes[0] = '\0';
    EXPECT_FALSE(read(file).color_is_per_facet);
    file.fields.erase(file.fields.begin() + 7, file.fields.end());
    EXPECT_TRUE(read(file).color_is_per_facet);
}

TEST(MeasuredFile, SpectraBecomeColorsInDaylight)
{
    File file = file_of(true);
    const MeasuredBrdf brdf = read(file);
    ASSERT_EQ(brdf.color.values.size(), 108u);
    const std::vector<float>& spectra = file["spectra"].values;
    const float waves[] = {420, 480, 570, 700};
    for (std::size_t slice = 0; slice < 6; ++slice)
        for (std::size_t i = 0; i < 6; ++i) {
            // Integral over the whole spectrum; values are zero outside the measured wavelengths.
            std::vector<SpectrumPoint> points;
            for (std::size_t w = 0; w < 4; ++w)
                points.push_back({double(waves[w]), double(spectra[(slice * 4 + w) * 6 + i])});
            const Color c = color_in_daylight(points);
            const auto channel = [&](std::size_t k) { return brdf.color.values[(slice * 3 + k) * 6 + i]; };
            EXPECT_NEAR(channel(0), c.r, 1e-5 * double(c.r));
            EXPECT_NEAR(channel(1), c.g, 1e-5 * double(c.g));
            EXPECT_NEAR(channel(2), c.b, 1e-5 * double(c.b));
        }
    // A constant spectrum is white.
    file["wavelengths"].values = {300, 400, 700, 900};
    file["spectra"].values.assign(144, 0.5f);
    for (const float x : read(file).color.values) EXPECT_NEAR(x, 0.5, 1e-5);
    // If a file has RGB data as well as spectra, RGB is used.
    file.fields.push_back({"rgb", {3, 2, 3, 2, 3}, count_from(7, 108)});
    EXPECT_EQ(read(file).color.values, count_from(7, 108));
}

std::string message_of(const std::string& bytes)
{
    return error_in_file("felt.bsdf", [&] { read_measured("felt.bsdf", bytes); });
}

TEST(MeasuredFile, ErrorsNameTheirPlace)
{
    const auto broken = [](const std::function<void(File&)>& breaks, bool spectral = false) {
        File file = file_of(spectral);
        breaks(file);
        return message_of(file.bytes());
    };
    EXPECT_EQ(message_of(file_of().bytes()), "loaded");
    EXPECT_EQ(message_of(""), "is not a tensor file, the format of the RGL material database");
    EXPECT_EQ(broken([](File& f) { f.magic[0] = 'T'; }),
              "is not a tensor file, the format of the RGL material database");
    EXPECT_EQ(broken([](File& f) { f.magic[12] = 2; }), "header: has version 2.0: only 1.0 is supported");
    EXPECT_EQ(broken([](File& f) { f.count_error = 1u << 30; }).substr(0, 1), "'");
    EXPECT_EQ(broken([](File& f) { f.offset_error = 1; }), "'description': ends beyond the end of the file");
    EXPECT_EQ(broken([](File& f) { f["ndf"].type = 12; }), "'ndf': has numbers of an unknown type, 12");
    EXPECT_EQ(broken([](File& f) { f["ndf"].type = 5; }), "'ndf': must contain 32-bit floats");
    EXPECT_EQ(broken([](File& f) { f["ndf"].name = "nfd"; }), "'ndf': is missing");
    EXPECT_EQ(broken([](File& f) { f["rgb"].name = "bgr"; }), "'rgb': is missing");
    EXPECT_EQ(broken([](File& f) { f["ndf"].name = "sigma"; }), "'sigma': appears twice");
    EXPECT_EQ(broken([](File& f) { f["ndf"].shape = {6}; }), "'ndf': has 1 dimensions, expected 2");
    EXPECT_EQ(broken([](File& f) { f["ndf"].shape = {0, 3}; }), "'ndf': is empty");
    EXPECT_EQ(broken([](File& f) { f["ndf"].shape = std::vector<std::uint64_t>(9, 1); }),
              "'ndf': has 9 dimensions: up to 8 are supported");
    const std::uint64_t huge = 1ull << 33;
    EXPECT_EQ(broken([&](File& f) { f["ndf"].shape = {huge, huge}; }),
              "'ndf': has more numbers than fit into the file");
    EXPECT_EQ(broken([&](File& f) { f["ndf"].shape = {~0ull, 2}; }), "'ndf': has more numbers than fit into the file");
    EXPECT_EQ(broken([](File& f) { f["vndf"].shape = {2, 3, 2, 3}; }),
              "'vndf': has 2 tables along dimension 0, expected 3");
    EXPECT_EQ(broken([](File& f) { f["rgb"].shape = {3, 2, 2, 3, 3}; }),
              "'rgb': has 2 tables along dimension 2, expected 3");
    EXPECT_EQ(broken([](File& f) { f["ndf"].shape = {1, 6}; }),
              "'ndf': a table of 6 by 1 values: 2 to 4096 are supported along each axis");
    EXPECT_EQ(broken([](File& f) { f["sigma"].values[3] = NAN; }), "'sigma': the value nan can't be rendered");
    EXPECT_EQ(broken([](File& f) { f["vndf"].values[9] = -1; }), "'vndf': the value -1 can't be rendered");
    EXPECT_EQ(broken([](File& f) { f["rgb"].values[9] = -1; }), "loaded");
    EXPECT_EQ(broken([](File& f) { f["rgb"].values[9] = INFINITY; }), "'rgb': the value inf can't be rendered");
    EXPECT_EQ(broken([](File& f) { f["theta_i"].values[1] = 0; }), "'theta_i': angles must increase");
    EXPECT_EQ(broken([](File& f) { f["phi_i"].values[1] = 90; }), "'phi_i': 90 is not an angle in radians");
    EXPECT_EQ(broken([](File& f) { f["wavelengths"].values[1] = 400; }, true), "'wavelengths': must increase");
    EXPECT_EQ(broken([](File& f) { f["wavelengths"].shape = {0}; }, true), "'wavelengths': is empty");
    EXPECT_EQ(broken([](File& f) { f["wavelengths"].name = "waves"; }, true), "'wavelengths': is missing");
}

TEST(MeasuredFile, CutAnywhereItIsNoFile)
{
    for (const bool spectral : {false, true}) {
        const std::string bytes = file_of(spectral).bytes();
        for (std::size_t size = 0; size < bytes.size(); ++size)
            EXPECT_NE(message_of(bytes.substr(0, size)), "loaded") << size;
    }
}

class MeasuredScenes : public ImportTest {
protected:
    void SetUp() override
    {
        ImportTest::SetUp();
        write("Felt.bsdf", file_of().bytes());
        std::filesystem::create_directory(folder_ / "sub");
        write("sub/paint.bsdf", file_of(true).bytes());
    }
    /// Materials of the shapes in node order.
    static std::vector<Material> materials_of(const SceneDescription& scene)
    {
        std::vector<Material> materials;
        for (const Node& node : scene.nodes)
            for (const Shape& shape : node.shapes) materials.push_back(scene.materials.at(std::size_t(shape.material)));
        return materials;
    }
    void expect_both(const SceneDescription& scene)
    {
        for (const auto& [message, times] : warnings_.counts()) ADD_FAILURE() << message;
        ASSERT_EQ(scene.measured.size(), 2u);
        EXPECT_EQ(scene.measured[0].name, "Felt.bsdf");
        EXPECT_EQ(scene.measured[0].color.values, count_from(5, 108));
        EXPECT_EQ(scene.measured[1].name, "paint.bsdf");
        const std::vector<Material> materials = materials_of(scene);
        ASSERT_EQ(materials.size(), 3u);
        for (const Material& m : materials) EXPECT_EQ(m.kind, MaterialKind::measured);
        EXPECT_EQ(materials[0].measured, 0);
        EXPECT_EQ(materials[1].measured, 1);
        EXPECT_EQ(materials[2].measured, 0);
        EXPECT_EQ(scene.files.size(), 3u);
    }
};

TEST_F(MeasuredScenes, OfFathom)
{
    const SceneDescription scene = load("a.json", R"({"fathom": 1, "materials":
        {"felt": {"kind": "measured", "file": "felt.bsdf"}, "paint": {"kind": "measured", "file": "sub/paint.bsdf"}},
        "scene": [{"sphere": {"radius": 1}, "material": "felt"}, {"sphere": {"radius": 1}, "material": "paint"},
                  {"sphere": {"radius": 1}, "material": {"kind": "measured", "file": "Felt.bsdf", "bump": 0.1}}]})");
    expect_both(scene);
    EXPECT_EQ(error_of("b.json", R"({"fathom": 1, "materials": {"m": {"kind": "measured"}}})"),
              "/materials/m: key 'file' is missing");
    EXPECT_EQ(error_of("b.json", R"({"fathom": 1, "materials": {"m": {"kind": "measured", "file": ""}}})"),
              "/materials/m/file: the path of a file is empty");
}

TEST_F(MeasuredScenes, OfPbrt)
{
    expect_both(load("a.pbrt", R"(WorldBegin
Material "measured" "string filename" "Felt.bsdf" Shape "sphere"
Material "measured" "string filename" "sub/paint.bsdf" Shape "sphere"
MakeNamedMaterial "again" "string type" "measured" "string filename" "Felt.bsdf" NamedMaterial "again" Shape "sphere")"));
    EXPECT_EQ(error_of("b.pbrt", "WorldBegin\nMaterial \"measured\" Shape \"sphere\""),
              "line 2, column 1: Material 'measured': it needs a 'filename'");
}

TEST_F(MeasuredScenes, OfMitsuba)
{
    const SceneDescription scene = load("a.xml", R"(<scene version="3.0.0">
<shape type="sphere"><bsdf type="measured"><string name="filename" value="Felt.bsdf"/></bsdf></shape>
<shape type="sphere"><bsdf type="measured"><string name="filename" value="sub/paint.bsdf"/></bsdf></shape>
<shape type="sphere"><bsdf type="twosided"><bsdf type="measured"><string name="filename" value="Felt.bsdf"/></bsdf></bsdf></shape>
</scene>)");
    expect_both(scene);
    const std::vector<Material> materials = materials_of(scene);
    EXPECT_TRUE(materials[0].visibility.black_back);
    EXPECT_FALSE(materials[2].visibility.black_back);
    EXPECT_NE(
        error_of("b.xml", R"(<scene version="3.0.0"><shape type="sphere"><bsdf type="measured"/></shape></scene>)")
            .find("needs a 'filename'"),
        std::string::npos);
}

/// Anisotropic measurements are oriented by texture coordinates; a sphere gets those of the imported format.
TEST_F(MeasuredScenes, ShapesHaveTangentsForThem)
{
    const auto ways = [&](const std::string& name, const std::string& material) {
        const SceneDescription scene = load(name, material);
        for (const Node& node : scene.nodes)
            if (!node.shapes.empty()) return std::pair(node.shapes[0].geometry.index(), node.parent_from_node.m);
        throw std::runtime_error("no shape");
    };
    File same_from_all_sides = file_of();
    same_from_all_sides["phi_i"].values = {0}, same_from_all_sides["phi_i"].shape = {1};
    for (const char* name : {"vndf", "luminance", "rgb"}) {
        auto& field = same_from_all_sides[name];
        field.shape[0] = 1;
        field.values.resize(field.values.size() / 3);
    }
    write("even.bsdf", same_from_all_sides.bytes());
    const auto mitsuba = [&](const std::string& bsdf) {
        return ways("a.xml",
                    "<scene version=\"3.0.0\"><shape type=\"sphere\"><bsdf type=" + bsdf + "</bsdf></shape></scene>");
    };
    const auto drawn_out = mitsuba(R"("principled"><float name="anisotropic" value="0.5"/>)");
    EXPECT_EQ(mitsuba(R"("measured"><string name="filename" value="Felt.bsdf"/>)"), drawn_out);
    EXPECT_NE(mitsuba(R"("measured"><string name="filename" value="even.bsdf"/>)"), drawn_out);
    const auto pbrt = [&](const std::string& material) {
        return ways("a.pbrt", "WorldBegin Material " + material + " Shape \"sphere\"");
    };
    const auto brushed = pbrt(R"("conductor" "float uroughness" 0.1 "float vroughness" 0.4)");
    EXPECT_EQ(pbrt(R"("measured" "string filename" "Felt.bsdf")"), brushed);
}

/// Errors name the broken measurement file, not the scene file.
TEST_F(MeasuredScenes, BrokenFilesAreNamed)
{
    write("cut.bsdf", file_of().bytes().substr(0, 500));
    for (const auto& [name, text] :
         {std::pair{"c.json", R"({"fathom": 1, "materials": {"m": {"kind": "measured", "file": "cut.bsdf"}}})"},
          std::pair{"c.pbrt", "WorldBegin\nMaterial \"measured\" \"string filename\" \"cut.bsdf\" Shape \"sphere\""},
          std::pair{"c.xml",
                    "<scene version=\"3.0.0\"><shape type=\"sphere\"><bsdf type=\"measured\"><string "
                    "name=\"filename\" value=\"cut.bsdf\"/></bsdf></shape></scene>"}})
        try {
            load(name, text);
            ADD_FAILURE() << name;
        } catch (const Error& e) {
            EXPECT_EQ(e.file(), (folder_ / "cut.bsdf").string());
            EXPECT_EQ(e.place(), "'vndf'");
        }
}

}  // namespace
}  // namespace fathom::test
