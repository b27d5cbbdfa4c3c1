// Known answers from FBX files in their text form, written as Blender and the FBX SDK write them.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "files/gltf_builder.h"
#include "files/png_encode.h"
#include "files/scene_read.h"

namespace goldthread {
namespace {

using test::TempFolder;
using ::testing::Contains;
using ::testing::HasSubstr;

/// The parts of an FBX file that a test may want otherwise.
struct Fbx {
  std::string creator = "FBX SDK/FBX Plugins version 2020.3";
  int coord = 0, coord_sign = 1, up = 1, up_sign = 1, front = 2, front_sign = 1;
  double unit = 1;  ///< centimetres
  std::string model_properties, material_properties, texture_properties, more_objects, more_connections;
  std::string texture_of;  ///< property of the material, or none

  /// One triangle with corners at 100 along each axis.
  std::string text() const {
    std::string out = fmt::format(
        "; FBX 7.4.0 project file\n"
        "FBXHeaderExtension:  {{\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7400\n\tCreator: \"{}\"\n}}\n"
        "GlobalSettings:  {{\n\tVersion: 1000\n\tProperties70:  {{\n",
        creator);
    const auto setting = [&](const char* name, int value) {
      out += fmt::format("\t\tP: \"{}\", \"int\", \"Integer\", \"\",{}\n", name, value);
    };
    setting("UpAxis", up);
    setting("UpAxisSign", up_sign);
    setting("FrontAxis", front);
    setting("FrontAxisSign", front_sign);
    setting("CoordAxis", coord);
    setting("CoordAxisSign", coord_sign);
    out += fmt::format("\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",{}\n\t}}\n}}\n", unit);
    out +=
        "Objects:  {\n"
        "\tGeometry: 10, \"Geometry::g\", \"Mesh\" {\n\t\tVertices: *9 {\n\t\t\ta: "
        "100,0,0,0,100,0,0,0,100\n\t\t}\n"
        "\t\tPolygonVertexIndex: *3 {\n\t\t\ta: 0,1,-3\n\t\t}\n"
        "\t\tLayerElementMaterial: 0 {\n\t\t\tVersion: 101\n\t\t\tMappingInformationType: \"AllSame\"\n"
        "\t\t\tReferenceInformationType: \"IndexToDirect\"\n\t\t\tMaterials: *1 {\n\t\t\t\ta: "
        "0\n\t\t\t}\n\t\t}\n"
        "\t\tLayer: 0 {\n\t\t\tVersion: 100\n\t\t\tLayerElement:  {\n\t\t\t\tType: \"LayerElementMaterial\"\n"
        "\t\t\t\tTypedIndex: 0\n\t\t\t}\n\t\t}\n\t}\n"
        "\tModel: 20, \"Model::thing\", \"Mesh\" {\n\t\tVersion: 232\n\t\tProperties70:  {\n" +
        model_properties +
        "\t\t}\n\t}\n"
        "\tMaterial: 30, \"Material::paint\", \"\" {\n\t\tVersion: 102\n\t\tShadingModel: \"phong\"\n"
        "\t\tProperties70:  {\n" +
        material_properties + "\t\t}\n\t}\n";
    if (!texture_of.empty())
      out +=
          "\tTexture: 40, \"Texture::t\", \"\" {\n\t\tType: \"TextureVideoClip\"\n\t\tVersion: 202\n"
          "\t\tFileName: \"C:\\work\\maps\\green.png\"\n\t\tRelativeFilename: \"..\\maps\\green.png\"\n"
          "\t\tProperties70:  {\n" +
          texture_properties + "\t\t}\n\t}\n";
    out += more_objects + "}\nConnections:  {\n\tC: \"OO\",20,0\n\tC: \"OO\",10,20\n\tC: \"OO\",30,20\n" +
           more_connections;
    if (!texture_of.empty()) out += "\tC: \"OP\",40,30, \"" + texture_of + "\"\n";
    return out + "}\n";
  }
};

std::string colour(const char* name, double value) {
  return fmt::format("\t\t\tP: \"{}\", \"Color\", \"\", \"A\",{},{},{}\n", name, value, value, value);
}

std::string green_png() {
  const std::vector<uint8_t> png = encode_png(1, 1, 3, std::vector<uint8_t>{0, 255, 0});
  return {png.begin(), png.end()};
}

TEST(MeshReadFbx, UnitsAndAxes) {
  TempFolder folder;
  Fbx y_up, z_up, x_up, inches;
  z_up.up = 2, z_up.front = 1, z_up.front_sign = -1;  // 3ds Max
  x_up.up = 0, x_up.coord = 1, x_up.coord_sign = -1;  // Blender's "X up, Y forward" has these
  inches.unit = 2.54;
  for (const Fbx& fbx : {y_up, z_up, x_up, inches}) {
    const Result<Scene> scene = read_scene(folder.write("axes.fbx", fbx.text()));
    ASSERT_TRUE(scene) << scene.error().line();
    ASSERT_EQ(scene->triangle_count(), 1u);
    const Instance& instance = scene->instances.at(0);
    const auto& positions = scene->meshes[instance.mesh].primitives.at(0).positions;
    const auto world = [&](int axis) {
      for (const vec3& p : positions)
        if (std::abs(p[axis]) > 0) return vec3(instance.transform * vec4(p, 1));
      return vec3(0);
    };
    const float metre = float(fbx.unit);
    EXPECT_LT(length(world(fbx.coord) - metre * float(fbx.coord_sign) * vec3(1, 0, 0)), 1e-4f);
    EXPECT_LT(length(world(fbx.up) - metre * float(fbx.up_sign) * vec3(0, 1, 0)), 1e-4f);
    EXPECT_LT(length(world(fbx.front) - metre * float(fbx.front_sign) * vec3(0, 0, 1)), 1e-4f);
  }
}

TEST(MeshReadFbx, ATextureReplacesTheColour) {
  TempFolder folder;
  Fbx fbx;
  fbx.material_properties = colour("DiffuseColor", 0.5);
  fbx.texture_of = "DiffuseColor";
  const std::string file = folder.write("textured.fbx", fbx.text());
  const Result<Scene> lost = read_scene(file);
  ASSERT_TRUE(lost) << lost.error().line();
  EXPECT_EQ(lost->materials.at(0).base_colour, vec3(0.5f));
  EXPECT_THAT(lost->warnings, Contains(HasSubstr("green.png")));
  folder.write("green.png", green_png());  // where Windows had another folder
  const Result<Scene> found = read_scene(file);
  ASSERT_TRUE(found) << found.error().line();
  EXPECT_EQ(found->materials.at(0).base_colour, vec3(1));
  EXPECT_TRUE(found->materials.at(0).base_colour_texture.present());
  EXPECT_TRUE(found->warnings.empty());
}

TEST(MeshReadFbx, AnEmissionTextureShinesWithoutAColour) {
  TempFolder folder;
  folder.write("green.png", green_png());
  Fbx fbx;
  fbx.material_properties = colour("EmissiveColor", 0);
  fbx.texture_of = "EmissiveColor";
  const Result<Scene> scene = read_scene(folder.write("glow.fbx", fbx.text()));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->materials.at(0).emission, vec3(1));
  EXPECT_TRUE(scene->materials.at(0).emission_texture.present());
  EXPECT_THAT(scene->warnings, Contains(HasSubstr("paint")));
}

TEST(MeshReadFbx, EmissionUnderItsOldName) {
  TempFolder folder;
  Fbx fbx;
  fbx.material_properties =
      colour("EmissiveColor", 0) + "\t\t\tP: \"Emissive\", \"Vector3D\", \"Vector\", \"\",50,40,25\n";
  const Result<Scene> scene = read_scene(folder.write("old.fbx", fbx.text()));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->materials.at(0).emission, vec3(50, 40, 25));
}

TEST(MeshReadFbx, RepeatsOfATexture) {
  TempFolder folder;
  folder.write("green.png", green_png());
  Fbx fbx;
  fbx.texture_of = "DiffuseColor";
  fbx.texture_properties =
      "\t\t\tP: \"Translation\", \"Vector\", \"\", \"A\",0.25,0.5,0\n"
      "\t\t\tP: \"Scaling\", \"Vector\", \"\", \"A\",2,4,1\n";
  for (const char* creator : {"FBX SDK/FBX Plugins version 2020.3", "Blender (stable FBX IO) - 3.4.1"}) {
    fbx.creator = creator;
    const Result<Scene> scene = read_scene(folder.write("tiles.fbx", fbx.text()));
    ASSERT_TRUE(scene) << scene.error().line();
    const Texture& texture = scene->materials.at(0).base_colour_texture;
    const bool blender = creator[0] == 'B';
    EXPECT_EQ(texture.scale, blender ? vec2(0.5f, 0.25f) : vec2(2, 4)) << creator;
    // The lower left corner, v = 1 with us, lies at the translation.
    const vec2 corner = texture.scale * vec2(0, 1) + texture.offset;
    EXPECT_LT(glm::length(corner - vec2(0.25f, 0.5f)), 1e-6f) << corner.x << " " << corner.y;
  }
}

TEST(MeshReadFbx, HiddenObjectsAreLeftOut) {
  TempFolder folder;
  Fbx fbx;
  fbx.model_properties = "\t\t\tP: \"Show\", \"bool\", \"\", \"\",0\n";
  const Result<Scene> scene = read_scene(folder.write("hidden.fbx", fbx.text()));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->triangle_count(), 0u);
  EXPECT_THAT(scene->warnings, Contains(HasSubstr("hidden")));
}

TEST(MeshReadFbx, AMetallicPaint) {
  TempFolder folder;
  Fbx fbx;
  fbx.material_properties = colour("DiffuseColor", 0.5) + colour("Maya|base_color", 0.25) +
                            "\t\t\tP: \"Maya|metallic\", \"Number\", \"\", \"A\",0.75\n";
  const Result<Scene> scene = read_scene(folder.write("metal.fbx", fbx.text()));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->materials.at(0).base_colour, vec3(0.25f));
  EXPECT_EQ(scene->materials.at(0).metallic, 0.75f);
}

TEST(MeshReadFbx, LightsStandWhereTheirNodesDo) {
  TempFolder folder;
  Fbx fbx;
  fbx.up = 2, fbx.front = 1, fbx.front_sign = -1;
  fbx.more_objects =
      "\tNodeAttribute: 50, \"NodeAttribute::lamp\", \"Light\" {\n\t\tTypeFlags: "
      "\"Light\"\n\t\tProperties70:  {\n"
      "\t\t\tP: \"LightType\", \"enum\", \"\", \"\",2\n\t\t\tP: \"Intensity\", \"Number\", \"\", \"A\",700\n"
      "\t\t\tP: \"InnerAngle\", \"Number\", \"\", \"A\",40\n\t\t\tP: \"OuterAngle\", \"Number\", \"\", "
      "\"A\",60\n"
      "\t\t}\n\t}\n"
      "\tModel: 51, \"Model::lamp\", \"Light\" {\n\t\tVersion: 232\n\t\tProperties70:  {\n"
      "\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",100,0,300\n"
      "\t\t\tP: \"Lcl Rotation\", \"Lcl Rotation\", \"\", \"A\",90,0,0\n\t\t}\n\t}\n";
  fbx.more_connections = "\tC: \"OO\",51,0\n\tC: \"OO\",50,51\n";
  const Result<Scene> scene = read_scene(folder.write("lamp.fbx", fbx.text()));
  ASSERT_TRUE(scene) << scene.error().line();
  ASSERT_EQ(scene->lights.size(), 1u);
  const Light& light = scene->lights[0];
  EXPECT_EQ(light.kind, LightKind::kSpot);
  EXPECT_EQ(light.intensity, vec3(7));
  EXPECT_LT(length(light.position - vec3(1, 3, 0)), 1e-4f);
  EXPECT_LT(length(light.direction - vec3(0, -1, 0)), 1e-4f);  // its -Y, turned to -Z, which is down
  EXPECT_NEAR(light.inner_cone, glm::radians(20.0f), 1e-4f);
  EXPECT_NEAR(light.outer_cone, glm::radians(30.0f), 1e-4f);
}

TEST(MeshReadFbx, WithoutMeshesThereIsNothingToBake) {
  TempFolder folder;
  std::string text = Fbx().text();
  text.erase(text.find("\tC: \"OO\",10,20\n"), 15);
  const Result<Scene> scene = read_scene(folder.write("nothing.fbx", text));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->triangle_count(), 0u);
}

}  // namespace
}  // namespace goldthread
