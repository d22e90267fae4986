// SPDX-License-Identifier: Apache-2.0
#include <random>

#include "formats/assimp/ipc.h"
#include "formats/import_test_helpers.h"
#include "scene/material_table.h"

namespace fathom::test {
namespace {

#ifdef FATHOM_HAS_ASSIMP

class AssimpModule : public ImportTest {};

constexpr const char* collada = R"(<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><phong><diffuse><color>1 0.5 0.25 1</color></diffuse></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="red"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g" name="quad"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 100 0 0 100 0 200 0 0 200</float_array><technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist count="1" material="x"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n" name="thing"><translate>0 10 0</translate><instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="x" target="#m"/></technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>)";

constexpr const char* fbx = R"(; FBX 7.3.0 project file
FBXHeaderExtension:  {
	FBXHeaderVersion: 1003
	FBXVersion: 7300
}
GlobalSettings:  {
	Version: 1000
	Properties70:  {
		P: "UpAxis", "int", "Integer", "",2
		P: "UpAxisSign", "int", "Integer", "",1
		P: "FrontAxis", "int", "Integer", "",1
		P: "FrontAxisSign", "int", "Integer", "",-1
		P: "CoordAxis", "int", "Integer", "",0
		P: "CoordAxisSign", "int", "Integer", "",1
		P: "UnitScaleFactor", "double", "Number", "",1
	}
}
Objects:  {
	Geometry: 1, "Geometry::quad", "Mesh" {
		Vertices: *12 {
			a: 0,0,0,100,0,0,100,0,200,0,0,200
		}
		PolygonVertexIndex: *4 {
			a: 0,1,2,-4
		}
		GeometryVersion: 124
		LayerElementMaterial: 0 {
			Version: 101
			Name: ""
			MappingInformationType: "AllSame"
			ReferenceInformationType: "IndexToDirect"
			Materials: *1 {
				a: 0
			}
		}
		Layer: 0 {
			Version: 100
			LayerElement:  {
				Type: "LayerElementMaterial"
				TypedIndex: 0
			}
		}
	}
	Model: 2, "Model::thing", "Mesh" {
		Version: 232
		Properties70:  {
			P: "Lcl Translation", "Lcl Translation", "", "A",0,10,0
		}
	}
	Material: 3, "Material::red", "" {
		Version: 102
		ShadingModel: "phong"
		Properties70:  {
			P: "DiffuseColor", "Color", "", "A",1,0.5,0.25
		}
	}
}
Connections:  {
	C: "OO",2,0
	C: "OO",1,2
	C: "OO",3,2
}
)";

TEST_F(AssimpModule, ColladaAndFbxInMetresWithYUp)
{
    for (const auto& [name, content] : {std::pair{"a.dae", collada}, std::pair{"a.fbx", fbx}}) {
        SCOPED_TRACE(name);
        const SceneDescription scene = load(name, content);
        ASSERT_EQ(scene.meshes.size(), 1u);
        EXPECT_EQ(scene.meshes[0].indices.size(), 6u);
        const Bounds bounds = world_bounds(scene);
        expect_near(bounds.min, {0, 0, -0.1}, 1e-6);
        expect_near(bounds.max, {1, 2, -0.1}, 1e-6);
        ASSERT_FALSE(scene.materials.empty());
        EXPECT_EQ(scene.materials[0].name, "red");
        EXPECT_EQ(scene.materials[0].base_color.value, (Color{1, 0.5f, 0.25f}));
    }
}

/// Every member of Material survives serialization from the importer's subprocess.
TEST_F(AssimpModule, AnswersKeepEveryMemberOfMaterials)
{
    AssimpAnswer answer;
    Material m;
    m.name = "all";
    m.kind = MaterialKind::principled;
    // Every number differs from its default and from its neighbors.
    int next = 2;
    const auto change = [&](auto& value) {
        using T = std::remove_reference_t<decltype(value)>;
        if constexpr (std::is_same_v<T, ColorInput>)
            value = {{float(next), float(next + 1), 3}, next};
        else if constexpr (std::is_same_v<T, FloatInput>)
            value = {float(next), next, 1};
        else if constexpr (std::is_same_v<T, Color>)
            value = {float(next), 1, 2};
        else if constexpr (std::is_same_v<T, bool>)
            value = !value;
        else if constexpr (std::is_same_v<T, AlphaMode>)
            value = AlphaMode::blend;
        else if constexpr (std::is_arithmetic_v<T>)
            value = T(next);
        ++next;
    };
    for (const Parameter<Material>& p : material_parameters())
        std::visit([&](auto member) { change(member(m)); }, p.member);
    answer.scene.materials = {m, Material()};
    AssimpAnswer back;
    ASSERT_TRUE(from_bytes(to_bytes(answer), back));
    ASSERT_EQ(back.scene.materials.size(), 2u);
    EXPECT_EQ(back.scene.materials[0].name, "all");
    const auto same = [&](const Material& a, const Material& b, auto member) {
        using Member = decltype(member);
        if constexpr (std::is_same_v<Member, Field<Material, std::vector<RampStop>>> ||
                      std::is_same_v<Member, Field<Material, Vec2f>> ||
                      std::is_same_v<Member, Field<Material, Transform>>)
            return true;  // only textures have members of these types
        else if constexpr (requires { member(a).channel; })
            return member(a).value == member(b).value && member(a).texture == member(b).texture &&
                   member(a).channel == member(b).channel;
        else if constexpr (requires { member(a).texture; })
            return member(a).value == member(b).value && member(a).texture == member(b).texture;
        else
            return member(a) == member(b);
    };
    for (const Parameter<Material>& p : material_parameters()) {
        const auto kept = [&](auto member) { return same(m, back.scene.materials[0], member); };
        EXPECT_TRUE(std::visit(kept, p.member)) << p.key;
    }
}

/// FBX properties of physically based materials as Maya writes them.
TEST_F(AssimpModule, FbxWithLayers)
{
    std::string text = fbx;
    const std::string before = R"(P: "DiffuseColor", "Color", "", "A",1,0.5,0.25)";
    text.replace(text.find(before), before.size(), before + R"(
			P: "Maya", "Compound", "", ""
			P: "Maya|base_color", "Vector3D", "Vector", "",0.25,0.5,0.75
			P: "Maya|metallic", "Float", "", "",0.5
			P: "Maya|roughness", "Float", "", "",0.25
			P: "EmissiveColor", "Color", "", "A",1,0.5,0
			P: "Maya|emissive_intensity", "Float", "", "",4)");
    const SceneDescription scene = load("a.fbx", text);
    ASSERT_FALSE(scene.materials.empty());
    const Material& m = scene.materials[0];
    EXPECT_EQ(m.kind, MaterialKind::principled);
    EXPECT_EQ(m.metallic.value, 0.5f);
    EXPECT_EQ(m.roughness.value, 0.25f);
    EXPECT_EQ(m.base_color.value, (Color{0.25f, 0.5f, 0.75f}));
    EXPECT_EQ(m.emission.radiance.value, (Color{4, 2, 0}));
}

TEST_F(AssimpModule, FbxWithHeights)
{
    write("heights.png", "P5 1 1 255 0");
    std::string text = fbx;
    const auto put = [&](const std::string& before, const std::string& what) { text.insert(text.find(before), what); };
    put("P: \"DiffuseColor\"", "P: \"DisplacementFactor\", \"double\", \"Number\", \"\",2.5\n");
    put("}\nConnections", R"(	Texture: 4, "Texture::heights", "" {
		Type: "TextureVideoClip"
		Version: 202
		TextureName: "Texture::heights"
		FileName: "heights.png"
		RelativeFilename: "heights.png"
	}
)");
    put("C: \"OO\",2,0", "C: \"OP\",4,3,\"DisplacementColor\"\n\t");
    const SceneDescription scene = load("a.fbx", text);
    ASSERT_FALSE(scene.materials.empty());
    const Material& m = scene.materials[0];
    ASSERT_GE(m.displacement.height.texture, 0);
    EXPECT_EQ(m.displacement.height.value, 2.5f);
    EXPECT_EQ(scene.textures.at(std::size_t(m.displacement.height.texture)).color_space, ColorSpace::linear);
    EXPECT_EQ(scene.textures.at(std::size_t(m.displacement.height.texture)).name, "heights.png");
}

TEST_F(AssimpModule, Off)
{
    const SceneDescription scene = load("a.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
    EXPECT_EQ(scene.meshes.at(0).indices.size(), 6u);
}

TEST_F(AssimpModule, Mistakes)
{
    EXPECT_EQ(error_of("a.txt", "hello"), "this format is not supported");
    EXPECT_EQ(error_of("a", "hello"), "this format is not supported");
    EXPECT_NE(error_of("a.fbx", "hello"), "loaded");
    EXPECT_NE(error_of("a.dae", "<COLLADA"), "loaded");
    EXPECT_NE(error_of("a.3ds", std::string(100, 'M')), "loaded");
    EXPECT_EQ(error_of("a.fbx", ""), "the file is empty");
}

TEST_F(AssimpModule, DamagedFilesNeverCrash)
{
    std::mt19937 random(1);
    for (const auto& [name, content] : {std::pair{"a.dae", collada}, std::pair{"a.fbx", fbx}})
        for (int i = 0; i < 60; ++i) {
            std::string damaged = content;
            for (int k = 0; k < 3; ++k) damaged[random() % damaged.size()] = char(random() % 96 + 32);
            error_of(name, damaged);
        }
}

TEST_F(AssimpModule, MalformedFilesOfAssimp)
{
    const std::filesystem::path folder = std::filesystem::path(FATHOM_SHARED_SCENES) / "malformed/assimp";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no broken files at " << folder;
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file()) continue;
        SCOPED_TRACE(entry.path().string());
        error_of(entry.path());
        ++files;
    }
    EXPECT_GT(files, 20u);
    // Names of fuzzer-generated files don't tell the format.
    for (const auto& entry : std::filesystem::directory_iterator(folder / "fuzzer_data"))
        for (const char* name :
             {"f.obj", "f.ply", "f.stl", "f.gltf", "f.glb", "f.json", "f.off", "f.dae", "f.fbx", "f.3ds", "f.blend"}) {
            std::filesystem::copy_file(entry.path(), folder_ / name, std::filesystem::copy_options::overwrite_existing);
            error_of(folder_ / name);
        }
}

#else

TEST(AssimpModule, IsMissing)
{
    GTEST_SKIP() << "built without Assimp";
}

#endif

}  // namespace
}  // namespace fathom::test
