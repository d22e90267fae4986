// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>
#include <sys/wait.h>

#include <algorithm>

#include "formats/import_test_helpers.h"

// Rules for which referenced files are read.
namespace fathom::test {
namespace {

namespace fs = std::filesystem;

class Files : public ImportTest {
protected:
    void SetUp() override
    {
        ImportTest::SetUp();
        fs::create_directories(folder_ / "scene" / "Textures");
    }
    SceneDescription confined(const std::string& name, const std::string& content)
    {
        LoadOptions options;
        options.confine = true;
        return load_scene(write(name, content), options, warnings_);
    }
    void expect_outside(const std::string& name, const std::string& content)
    {
        EXPECT_NO_THROW(load_scene(write(name, content), {}, warnings_)) << content;
        expect_refused(name, content);
    }
    void expect_refused(const std::string& name, const std::string& content)
    {
        try {
            confined(name, content);
            ADD_FAILURE() << "loaded: " << content;
        } catch (const Error& error) {
            EXPECT_NE(std::string(error.what()).find("outside the scene's folder"), std::string::npos) << error.what();
        }
    }
};

std::string json_with(const std::string& members)
{
    return R"({"fathom": 1, "scene": [{"sphere": {}}], )" + members + "}";
}
std::string textured(const std::string& file)
{
    return json_with(R"("textures": {"t": {"image": ")" + file + R"("}})");
}
const std::string gltf_end = R"("scenes": [{"nodes": []}], "nodes": []})";

std::string gltf_with(const std::string& buffer, const std::string& image)
{
    return R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [{"primitives":
        [{"attributes": {"POSITION": 0}, "material": 0}]}], "accessors": [{"bufferView": 0, "componentType": 5126,
        "count": 3, "type": "VEC3"}], "bufferViews": [{"buffer": 0, "byteLength": 36}], "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}], "buffers": [{"byteLength": 36, "uri": ")" +
           buffer + R"("}], "images": [{"uri": ")" + image + R"("}]})";
}

TEST_F(Files, AreListed)
{
    write("scene/m.mtl", "newmtl a\nmap_Kd a.png\n");
    write("scene/a.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    const SceneDescription scene = load("scene/s.json", R"({"fathom": 1, "scene": [{"model": "a.obj"}]})");
    EXPECT_EQ(scene.files,
              (std::vector<fs::path>{folder_ / "scene/s.json", folder_ / "scene/a.obj", folder_ / "scene/m.mtl"}));
}

TEST_F(Files, WhoseNamesDifferInCase)
{
    write("scene/Textures/Wood.PNG", "");
    write("scene/Textures/b.png", "");
    write("scene/Textures/B.png", "");
    const auto image = [&](const char* name) { return load("scene/s.json", textured(name)).images.at(0).path; };
    EXPECT_EQ(image("Textures/Wood.PNG"), folder_ / "scene/Textures/Wood.PNG");
    EXPECT_EQ(image("textures/wood.png"), folder_ / "scene/Textures/Wood.PNG");
    EXPECT_EQ(image(R"(.\\TEXTURES\\wood.png)"), folder_ / "scene/Textures/Wood.PNG");
    // An exact match wins; otherwise the result doesn't depend on the folder's order.
    EXPECT_EQ(image("Textures/b.png"), folder_ / "scene/Textures/b.png");
    EXPECT_EQ(image("textures/b.PNG"), folder_ / "scene/Textures/B.png");
    EXPECT_EQ(image("textures/none.png"), folder_ / "scene/textures/none.png");
    // Files referenced by a referenced file follow the same rules.
    write("scene/M.mtl", "newmtl red\nKd 1 0 0\nmap_Kd textures\\WOOD.png\n");
    const SceneDescription obj =
        load("scene/a.obj", "mtllib .\\m.MTL\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
    EXPECT_EQ(obj.materials.size(), 1u);
    EXPECT_EQ(obj.images.at(0).path, folder_ / "scene/Textures/Wood.PNG");
    EXPECT_TRUE(warnings_.empty());
}

TEST_F(Files, OutsideTheFolderAreRefusedWhereTheSceneIsConfined)
{
    write("secret.png", "");
    write("secret.mtl", "newmtl a\n");
    const float numbers[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::string triangle(reinterpret_cast<const char*>(numbers), sizeof numbers);
    write("secret.bin", triangle);
    write("secret.ply",
          "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
          "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    fs::create_symlink("../secret.png", folder_ / "scene/link.png");
    fs::create_directory_symlink("..", folder_ / "scene/up");
    const std::string absolute = fs::absolute(folder_ / "secret.png").string();
    for (const std::string& file :
         {std::string("../secret.png"), absolute, std::string("link.png"), std::string("up/secret.png"),
          std::string(R"(..\\secret.png)"), std::string("UP/SECRET.png"), std::string("Textures/../../none.png")})
        expect_outside("scene/s.json", textured(file));
    expect_outside("scene/s.json", json_with(R"("environment": {"kind": "image", "image": "../secret.png"})"));
    expect_outside("scene/s.json", R"({"fathom": 1, "scene": [{"model": "../secret.ply"}]})");
    const std::string faces = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    expect_outside("scene/a.obj", "mtllib ../secret.mtl\n" + faces);
    write("scene/in.mtl", "newmtl a\nmap_Kd ../secret.png\n");
    expect_outside("scene/a.obj", "mtllib in.mtl\nusemtl a\n" + faces);
    write("scene/in.bin", triangle);
    expect_outside("scene/a.gltf", gltf_with("in.bin", "../secret.png"));
    expect_outside("scene/a.gltf", gltf_with("../secret.bin", "Textures/in.png"));
    // The error doesn't reveal whether the file exists.
    expect_refused("scene/s.json", R"({"fathom": 1, "scene": [{"model": "../none.ply"}]})");
}

TEST_F(Files, InsideTheFolderAreRead)
{
    write("scene/Textures/a.png", "");
    fs::create_symlink("Textures/a.png", folder_ / "scene/link.png");
    write("scene/in.mtl", "newmtl a\nmap_Kd Textures/a.png\n");
    write("scene/a.obj", "mtllib in.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    EXPECT_EQ(confined("scene/s.json", R"({"fathom": 1, "scene": [{"model": "a.obj"}], "environment": {"kind": "image",
        "image": "link.png"}})")
                  .images.size(),
              2u);
    // The scene file itself may be a symbolic link that leaves the folder, because the user named it.
    write("other.json", R"({"fathom": 1, "scene": [{"model": "a.obj"}]})");
    fs::create_symlink("../other.json", folder_ / "scene/o.json");
    LoadOptions options;
    options.confine = true;
    EXPECT_EQ(load_scene(folder_ / "scene/o.json", options, warnings_).meshes.size(), 1u);
}

TEST_F(Files, PipesAndDevicesAreRefusedAtOnce)
{
    for (const char* name : {"a.json", "a.obj", "a.gltf", "a.dae", "a.mtl", "a.bin"})
        ASSERT_EQ(mkfifo((folder_ / name).c_str(), 0600), 0);
    for (const char* name : {"a.json", "a.obj", "a.gltf", "a.dae"})
        EXPECT_EQ(error_of(folder_ / name), "is a named pipe, not a file");
    EXPECT_EQ(error_of(fs::path("/dev/zero")), "is a device, not a file");
    EXPECT_THROW(load("m.json", R"({"fathom": 1, "scene": [{"model": "a.obj"}]})"), Error);
    load("b.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_EQ(warnings_.counts().count((folder_ / "b.obj").string() + ": the material file 'a.mtl' is missing"), 1u);
}

/// Loads from an unnamed pipe, as in `cat FILE | fathom render /dev/stdin`.
std::string loaded_from_pipe(const std::string& content)
{
    int ends[2];
    if (pipe(ends) != 0) return "no pipe";
    const pid_t writer = fork();
    if (writer == 0) {
        close(ends[0]);
        [[maybe_unused]] const ssize_t n = ::write(ends[1], content.data(), content.size());
        _exit(0);
    }
    close(ends[1]);
    std::string result = "loaded";
    try {
        Warnings warnings;
        load_scene("/dev/fd/" + std::to_string(ends[0]), {}, warnings);
    } catch (const Error& error) {
        result = error.message();
    }
    close(ends[0]);
    waitpid(writer, nullptr, 0);
    return result;
}

TEST(StandardInput, IsReadWhereTheContentTellsTheFormat)
{
    EXPECT_EQ(loaded_from_pipe("\n {\"fathom\": 1, \"scene\": [{\"sphere\": {}}]}"), "loaded");
    EXPECT_EQ(loaded_from_pipe(R"({"asset": {"version": "2.0"}, )" + gltf_end), "loaded");
    EXPECT_EQ(loaded_from_pipe("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              "its format can't be detected from the content: give a file whose name has an extension, or --format");
}

}  // namespace
}  // namespace fathom::test
