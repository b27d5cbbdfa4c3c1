// Known answers through assimp: small text files of each kind.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <utility>

#include "files/gltf_builder.h"
#include "files/mesh_import.h"
#include "files/png_encode.h"
#include "files/scene_read.h"

namespace goldthread {
namespace {

using test::bytes_of;
using test::TempFolder;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(MeshRead, ObjWithItsMaterials) {
  TempFolder folder;
  const std::vector<uint8_t> png = encode_png(1, 1, 3, std::vector<uint8_t>{0, 255, 0});
  folder.write("green.png", std::string(png.begin(), png.end()));
  folder.write("box.mtl",
               "newmtl paint\nKd 0.5 0.25 0.125\nmap_Kd green.png\nnewmtl lamp\nKd 0 0 0\nKe 10 5 2\n"
               "newmtl lost\nKd 1 1 1\nmap_Kd gone.png\n");
  const std::string file =
      folder.write("box.obj",
                   "mtllib box.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
                   "o square\nusemtl paint\nf 1/1 2/2 3/3 4/1\no other\nusemtl lamp\nf 1 2 3\n"
                   "o third\nusemtl lost\nf 1 2 4\n");
  const Result<Scene> scene = read_scene(file);
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->triangle_count(), 4u);  // a square is two
  EXPECT_EQ(scene->bounds().high, vec3(1, 1, 0));
  const auto material = [&](const std::string& name) {
    for (const Material& m : scene->materials)
      if (m.name == name) return m;
    ADD_FAILURE() << name;
    return Material{};
  };
  EXPECT_EQ(material("paint").base_colour, vec3(0.5f, 0.25f, 0.125f));
  EXPECT_EQ(material("paint").metallic, 0);
  EXPECT_TRUE(material("paint").base_colour_texture.present());
  EXPECT_EQ(material("lamp").emission, vec3(10, 5, 2));
  EXPECT_FALSE(material("lost").base_colour_texture.present());
  EXPECT_THAT(scene->warnings, Contains(HasSubstr("gone.png")));
  for (const Instance& instance : scene->instances)
    for (const Primitive& primitive : scene->meshes[instance.mesh].primitives)
      for (size_t v = 0; v < primitive.texcoords[0].size(); ++v)
        EXPECT_EQ(primitive.texcoords[0][v].y,
                  primitive.positions[v] == vec3(1, 1, 0) ? 0 : 1);  // v runs down
  for (uint32_t i = 0; i < scene->instances.size(); ++i) EXPECT_EQ(scene->instances[i].source_node, i);
}

TEST(MeshRead, PlyWithVertexColours) {
  TempFolder folder;
  const Result<Scene> scene = read_scene(folder.write(
      "tri.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 "
      "1 2\n"));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->triangle_count(), 1u);
  const Primitive& primitive = scene->meshes.at(0).primitives.at(0);
  ASSERT_EQ(primitive.colours.size(), 3u);
  EXPECT_EQ(primitive.colours[0], vec4(1, 0, 0, 1));
}

TEST(MeshRead, VertexColoursAreDecodedFromSrgb) {
  TempFolder folder;
  const Result<Scene> scene = read_scene(folder.write(
      "tri.ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 188 188 188\n1 0 0 188 188 188\n"
      "0 1 0 188 188 188\n3 0 1 2\n"));
  ASSERT_TRUE(scene) << scene.error().line();
  for (const vec4& colour : scene->meshes.at(0).primitives.at(0).colours)
    EXPECT_NEAR(colour.x, 0.5f, 0.005f);  // 188 is half the light
  EXPECT_EQ(scene->materials.at(0).base_colour, vec3(1));
}

TEST(MeshRead, ObjColoursOfSomeObjectsOnly) {
  TempFolder folder;
  const Result<Scene> scene =
      read_scene(folder.write("two.obj",
                              "o plain\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n"
                              "o red\r\nv 5 0 0 1 0 0\r\nv 6 0 0 1 0 0\r\nv 5 1 0 1 0 0\r\nf 4 5 6\r\n"));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->triangle_count(), 2u);
  for (const Mesh& mesh : scene->meshes) {
    const Primitive& primitive = mesh.primitives.at(0);
    ASSERT_EQ(primitive.colours.size(), 3u);
    for (size_t v = 0; v < 3; ++v)
      EXPECT_EQ(vec3(primitive.colours[v]), primitive.positions[v].x < 3 ? vec3(1) : vec3(1, 0, 0));
  }
}

TEST(MeshRead, ObjCommentsAreNoColours) {
  TempFolder folder;
  const Result<Scene> scene =
      read_scene(folder.write("two.obj",
                              "v 0 0 0 # three plain words\nv +1 0 0\nv 0 1 0\nf 1 2 3\n"
                              "v 5 0 0 1 0 0 # red as they come\nv 6 0 0 1 0 0\nv 5 1 0 1 0 0\nf 4 5 6\n"));
  ASSERT_TRUE(scene) << scene.error().line();
  size_t red = 0;
  for (const Mesh& mesh : scene->meshes)
    for (const Primitive& primitive : mesh.primitives) {
      ASSERT_EQ(primitive.colours.size(), primitive.positions.size());
      for (size_t v = 0; v < primitive.positions.size(); ++v) {
        const bool far = primitive.positions[v].x > 3;
        EXPECT_EQ(vec3(primitive.colours[v]), far ? vec3(1, 0, 0) : vec3(1)) << primitive.positions[v].x;
        red += far ? 1 : 0;
      }
    }
  EXPECT_EQ(red, 3u);
}

TEST(MeshRead, APictureThatCannotBeOpenedIsNotCalledMissing) {
  TempFolder folder;
  std::filesystem::create_directory(folder.path("paint.png"));
  folder.write("box.mtl", "newmtl paint\nmap_Kd C:\\somewhere\\else\\paint.png\n");
  const Result<Scene> scene = read_scene(folder.write(
      "box.obj", "mtllib box.mtl\nusemtl paint\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1/1 2/1 3/1\n"));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_THAT(scene->warnings, Contains(HasSubstr("not a regular file")));
}

TEST(MeshRead, WhatHasNoMaterialIsGrey) {
  TempFolder folder;
  const char* const stl =
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
      "endsolid s\n";
  const char* const ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const std::string& file : {folder.write("s.stl", stl), folder.write("p.ply", ply),
                                  folder.write("o.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")}) {
    const Result<Scene> scene = read_scene(file);
    ASSERT_TRUE(scene) << scene.error().line();
    const Primitive& primitive = scene->meshes.at(0).primitives.at(0);
    EXPECT_EQ(scene->materials.at(primitive.material).base_colour, vec3(0.8f)) << file;
  }
}

TEST(MeshRead, ObjTexturesThatStandForAColour) {
  // Blender writes no Kd or Ke beside a map.
  TempFolder folder;
  const std::vector<uint8_t> png = encode_png(1, 1, 3, std::vector<uint8_t>{0, 255, 0});
  folder.write("textures/green.png", std::string(png.begin(), png.end()));
  folder.write(
      "m.mtl",
      "newmtl found\nmap_Kd /home/someone/green.png\nnewmtl glow\nKd 0 0 0\nmap_Ke D:\\art\\green.png\n"
      "newmtl lost\nmap_Kd gone.png\n");
  const Result<Scene> scene = read_scene(
      folder.write("m.obj",
                   "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl found\nf 1 2 3\nusemtl glow\nf 1 2 3\n"
                   "usemtl lost\nf 1 2 3\n"));
  ASSERT_TRUE(scene) << scene.error().line();
  size_t judged = 0;
  for (const Material& material : scene->materials) {
    if (material.name == "found") {
      EXPECT_EQ(material.base_colour, vec3(1));
      EXPECT_TRUE(material.base_colour_texture.present());
    } else if (material.name == "glow") {
      EXPECT_EQ(material.emission, vec3(1));
      EXPECT_TRUE(material.emission_texture.present());
    } else if (material.name == "lost") {
      EXPECT_EQ(material.base_colour, vec3(0.8f));
    } else {
      continue;
    }
    ++judged;
  }
  EXPECT_EQ(judged, 3u);
  EXPECT_THAT(scene->warnings, Contains(AllOf(HasSubstr("glow"), HasSubstr("nit"))));
  EXPECT_THAT(scene->warnings, Contains(HasSubstr("gone.png")));
}

TEST(MeshRead, ManyLostTexturesAreCounted) {
  TempFolder folder;
  std::string materials, uses;
  for (int i = 0; i < 10; ++i) {
    materials += fmt::format("newmtl m{}\nKd 1 1 1\nmap_Kd gone{}.png\n", i, i);
    uses += fmt::format("usemtl m{}\nf 1 2 3\n", i);
  }
  folder.write("m.mtl", materials);
  const Result<Scene> scene =
      read_scene(folder.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n" + uses));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->warnings.size(), 4u);
  EXPECT_THAT(scene->warnings, Contains(HasSubstr("7 more textures")));
}

TEST(MeshRead, StlJoinsEqualVertices) {
  TempFolder folder;
  std::string text = "solid s\n";
  for (const char* corners :
       {"vertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n", "vertex 0 0 0\nvertex 1 1 0\nvertex 0 1 0\n"})
    text += std::string("facet normal 0 0 1\nouter loop\n") + corners + "endloop\nendfacet\n";
  const Result<Scene> scene = read_scene(folder.write("square.stl", text + "endsolid s\n"));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->triangle_count(), 2u);
  EXPECT_EQ(scene->meshes.at(0).primitives.at(0).positions.size(), 4u);
}

TEST(MeshRead, ColladaTurnsZUpAndTakesUnits) {
  TempFolder folder;
  const Result<Scene> scene = read_scene(folder.write(
      "tri.dae",
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g" name="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 100 0 0 0 0 100</float_array>
<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)"));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_LT(length(scene->bounds().high - vec3(1, 1, 0)), 1e-4f);  // the metre along Z stands up
}

TEST(MeshRead, ColladaSpotsShineInTheirFalloffAngle) {
  TempFolder folder;
  const std::string before =
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Y_UP</up_axis></asset>
<library_lights><light id="l"><technique_common><spot><color>1 1 1</color><falloff_angle>50</falloff_angle>
<falloff_exponent>0.15</falloff_exponent></spot></technique_common>)";
  const std::string after = R"(</light></library_lights>
<library_geometries><geometry id="g" name="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 0 1</float_array>
<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node>
<node id="k"><translate>0 3 0</translate><instance_light url="#l"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  const Result<Scene> scene = read_scene(folder.write("spot.dae", before + after));
  ASSERT_TRUE(scene) << scene.error().line();
  ASSERT_EQ(scene->lights.size(), 1u);
  EXPECT_NEAR(scene->lights[0].outer_cone, glm::radians(25.0f), 1e-4f);
  EXPECT_NEAR(scene->lights[0].inner_cone, glm::radians(25.0f), 1e-4f);
  EXPECT_EQ(scene->lights[0].position, vec3(0, 3, 0));
  const Result<Scene> soft = read_scene(folder.write(
      "soft.dae",
      before + R"(<extra><technique profile="FCOLLADA"><outer_cone>60</outer_cone></technique></extra>)" +
          after));
  ASSERT_TRUE(soft) << soft.error().line();
  EXPECT_NEAR(soft->lights.at(0).outer_cone, glm::radians(30.0f), 1e-4f);
}

TEST(MeshRead, ContentOfAnotherFormatIsNamed) {
  TempFolder folder;
  const std::pair<const char*, const char*> kinds[] = {{".fbx", "; FBX 7.4.0 project file\n"},
                                                       {".fbx", "Kaydara FBX Binary  "},
                                                       {".ply", "ply\nformat ascii 1.0\n"},
                                                       {".dae", "<?xml version=\"1.0\"?>\n<COLLADA>"},
                                                       {".stl", "solid s\nfacet normal 0 0 1\n"}};
  for (const auto& [extension, start] : kinds) {
    const std::string file = folder.write("wrong.obj", start);
    const Result<Scene> scene = read_scene(file);
    ASSERT_FALSE(scene) << extension;
    EXPECT_EQ(scene.error().code, ErrorCode::kBadInput);
    EXPECT_THAT(scene.error().cure, HasSubstr(extension));
  }
}

std::string ply_header(const char* format) {
  return std::string("ply\nformat ") + format +
         " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 40\nproperty list uchar uint vertex_indices\nend_header\n";
}

TEST(MeshRead, TruncatedPlyIsAnError) {
  // At any place: assimp itself reads on past the end.
  TempFolder folder;
  std::string text = ply_header("ascii") + "0 0 0\n1 0 0\n0 1 0\n";
  std::string binary = ply_header("binary_little_endian") + bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0});
  for (int face = 0; face < 40; ++face) {
    text += "3 0 1 2\n";
    binary += '\3';
    binary += bytes_of<uint32_t>({0, 1, 2});
  }
  for (const std::string& whole : {text, binary}) {
    const Result<Scene> scene = read_scene(folder.write("whole.ply", whole));
    ASSERT_TRUE(scene) << scene.error().line();
    EXPECT_EQ(scene->triangle_count(), 40u);
    for (size_t size = 10; size + 8 < whole.size(); size += 5) {
      const Result<Scene> cut = read_scene(folder.write("cut.ply", whole.substr(0, size)));
      ASSERT_FALSE(cut) << size;
      EXPECT_EQ(cut.error().code, ErrorCode::kBadInput);
      EXPECT_THAT(cut.error().line(), HasSubstr("cut off"));
    }
  }
}

TEST(MeshRead, PlyLinesMayEndInABareCarriageReturn) {
  TempFolder folder;
  std::string text = ply_header("ascii") + "0 0 0\n1 0 0\n0 1 0\n", faces;
  for (int face = 0; face < 40; ++face) {
    text += "3 0 1 2\n";
    faces += '\3' + bytes_of<uint32_t>({0, 1, 2});
  }
  std::replace(text.begin(), text.end(), '\n', '\r');
  std::string header = ply_header("binary_little_endian");
  std::replace(header.begin(), header.end(), '\n', '\r');
  // A coordinate with the byte of a carriage return in it.
  const std::string binary = header + bytes_of<float>({0, 0, 0, 8.8125f, 0, 0, 0, 1, 0}) + faces;
  ASSERT_NE(bytes_of<float>({8.8125f}).find('\r'), std::string::npos);
  for (const std::string& whole : {text, binary}) {
    const Result<Scene> scene = read_scene(folder.write("mac.ply", whole));
    ASSERT_TRUE(scene) << scene.error().line();
    EXPECT_EQ(scene->triangle_count(), 40u);
    EXPECT_EQ(scene->bounds().high, whole == text ? vec3(1, 1, 0) : vec3(8.8125f, 1, 0));
    const Result<Scene> cut = read_scene(folder.write("cut.ply", whole.substr(0, whole.size() - 20)));
    ASSERT_FALSE(cut);
    EXPECT_THAT(cut.error().line(), HasSubstr("cut off"));
  }
}

TEST(MeshRead, PlyHeaderLinesThatMakeNoSenseAreNamed) {
  TempFolder folder;
  for (const char* line :
       {"element vertex many", "property fl", "property list uchar", "polish all", "format xml 1.0"}) {
    std::string text = "ply\nformat ascii 1.0\ncomment by hand\nelement vertex 0\n";
    text += line;
    text += "\nend_header\n";
    const Result<Scene> scene = read_scene(folder.write("odd.ply", text));
    ASSERT_FALSE(scene) << line;
    EXPECT_EQ(scene.error().code, ErrorCode::kBadInput);
    EXPECT_EQ(scene.error().place, "header line 5") << line;
    EXPECT_THAT(scene.error().message, HasSubstr(line));
  }
}

TEST(MeshRead, FacesThatNameNoVertexAreErrors) {
  // assimp's own steps would read there.
  TempFolder folder;
  for (const std::vector<uint32_t>& corners :
       {std::vector<uint32_t>{0, 1, 168430090}, std::vector<uint32_t>{}}) {
    std::string bytes = ply_header("binary_little_endian") + bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0});
    for (int face = 0; face < 40; ++face) {
      bytes += char(corners.size());
      bytes += bytes_of(corners);
    }
    const Result<Scene> scene = read_scene(folder.write("wild.ply", bytes));
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().code, ErrorCode::kBadInput);
    EXPECT_EQ(scene.error().place, "mesh 0 face 0");
  }
}

TEST(MeshRead, MessagesStayPrintable) {
  EXPECT_EQ(plain_text("two\nlines\tand \x1b[31mcolour\x7f"), "two lines and ?[31mcolour?");
  EXPECT_EQ(plain_text("caf\xc3\xa9"), "caf\xc3\xa9");
  EXPECT_EQ(plain_text(std::string(1000, 'x')), std::string(200, 'x') + "...");
  // And in the line that a user sees: the index is one that no assimp takes.
  TempFolder folder;
  const Result<Scene> scene =
      read_scene(folder.write("bad.obj", "v 0 0 0\nv \x1b[31m" + std::string(1000, 'x') + " 0 0\nf 1 2 9\n"));
  ASSERT_FALSE(scene);
  const std::string line = scene.error().line();
  EXPECT_LT(line.size(), 500u);
  EXPECT_TRUE(std::all_of(line.begin(), line.end(), [](unsigned char c) { return c >= ' '; })) << line;
}

TEST(MeshRead, BadFilesAreErrors) {
  TempFolder folder;
  for (const char* name : {"bad.ply", "bad.fbx", "bad.dae", "bad.obj", "bad.stl"})
    for (const char* text : {"", "nonsense\n"}) {
      const std::string file = folder.write(name, text);
      const Result<Scene> scene = read_scene(file);
      if (scene) {
        EXPECT_EQ(scene->triangle_count(), 0u) << name;
        continue;
      }
      EXPECT_EQ(scene.error().code, ErrorCode::kBadInput) << name;
      EXPECT_EQ(scene.error().file, file);
    }
  EXPECT_THAT(read_scene(folder.path("gone.obj")).error().message, HasSubstr("cannot open"));
}

}  // namespace
}  // namespace goldthread
