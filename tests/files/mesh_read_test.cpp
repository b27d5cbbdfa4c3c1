// Known answers through assimp: small text files of each kind.
#include <gmock/gmock.h>

#include "files/gltf_builder.h"
#include "files/png_encode.h"
#include "files/scene_read.h"

namespace goldthread {
namespace {

using test::TempFolder;
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
