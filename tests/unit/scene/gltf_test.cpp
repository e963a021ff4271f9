// What a correct file becomes. gltf_hostile_test.cpp has the others.
#include "expect_near.h"
#include "gltf_builder.h"
#include <set>

namespace lumel::scene {
namespace {

using nlohmann::json;

struct Gltf : testing::Test {
    TemporaryFolder folder;
    GltfBuilder gltf;
    Scene load() { return loadGltf(gltf.writeGltf(folder)); }
};

glm::vec3 transformed(const Object& object, glm::vec3 p)
{
    return glm::vec3(object.worldFromObject * glm::vec4(p, 1.0f));
}

// Corners of each triangle in world space: what is seen, however it is stored.
std::vector<glm::vec3> corners(const Mesh& mesh)
{
    std::vector<glm::vec3> points;
    for (uint32_t index : mesh.indices)
        points.push_back(mesh.vertices[index].position);
    return points;
}

TEST_F(Gltf, QuadArrivesAsItIs)
{
    gltf.quad();
    gltf.root["meshes"][0]["name"] = "square";
    const Scene scene = load();
    ASSERT_EQ(scene.meshes.size(), 1u);
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.name, "square");
    EXPECT_EQ(mesh.vertices.size(), 4u);
    EXPECT_EQ(mesh.indices, (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
    expectNear(mesh.vertices[2].position, {1, 1, 0});
    expectNear(mesh.vertices[2].normal, {0, 0, 1});
    EXPECT_EQ(mesh.vertices[2].uv, glm::vec2(1, 0));
    EXPECT_EQ(mesh.uvProblem, "");
    expectNear(mesh.bounds.lower, {0, 0, 0});
    expectNear(mesh.bounds.upper, {1, 1, 0});
    EXPECT_EQ(scene.objects[0].name, "square");
    EXPECT_TRUE(scene.cameras.empty());
    EXPECT_TRUE(scene.lights.empty());
}

TEST_F(Gltf, GlbAndDataUriHoldTheSameAsFiles)
{
    gltf.quad();
    const Scene fromFiles = load();
    const Scene fromGlb = loadGltf(gltf.writeGlb(folder));
    gltf.root["buffers"] = {{{"byteLength", gltf.binary.size()},
                             {"uri", "data:application/gltf-buffer;base64," + base64(gltf.binary)}}};
    const Scene fromData = load();
    for (const Scene* other : {&fromGlb, &fromData}) {
        EXPECT_EQ(other->meshes[0].indices, fromFiles.meshes[0].indices);
        EXPECT_EQ(corners(other->meshes[0]), corners(fromFiles.meshes[0]));
    }
}

TEST_F(Gltf, UrisAreDecodedAndMayNameFoldersBelow)
{
    gltf.quad();
    std::filesystem::create_directory(folder / "parts of it");
    writeText(folder / "parts of it/a+b%.bin", gltf.binary);
    gltf.root["buffers"] = {{{"byteLength", gltf.binary.size()}, {"uri", "parts%20of%20it/a+b%25.bin"}}};
    EXPECT_EQ(load().meshes.size(), 1u);
    gltf.root["buffers"][0]["uri"] = "./parts of it/a+b%25.bin"; // not encoded, as some exporters leave it
    EXPECT_EQ(load().meshes.size(), 1u);
}

TEST_F(Gltf, BuffersMayBePadded)
{
    gltf.quad();
    gltf.root["buffers"] = {{{"byteLength", gltf.binary.size()}, {"uri", "data.bin"}}};
    gltf.binary += "padding";
    EXPECT_EQ(load().meshes.size(), 1u);
}

// --- Geometry

TEST_F(Gltf, AllIndexTypesAreEqual)
{
    gltf.quad();
    const auto expected = corners(load().meshes[0]);
    gltf.primitive()["indices"] = gltf.accessor<uint8_t>({0, 1, 2, 0, 2, 3}, "SCALAR", 5121, 1);
    EXPECT_EQ(corners(load().meshes[0]), expected);
    gltf.primitive()["indices"] = gltf.accessor<uint32_t>({0, 1, 2, 0, 2, 3}, "SCALAR", 5125, 1);
    EXPECT_EQ(corners(load().meshes[0]), expected);
}

TEST_F(Gltf, WithoutIndicesVerticesCountInOrder)
{
    gltf.primitive()["attributes"]["POSITION"] = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3", 3);
    EXPECT_EQ(corners(load().meshes[0]), (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST_F(Gltf, StripsAndFansKeepTheirWinding)
{
    gltf.quad();
    gltf.primitive()["mode"] = 5; // strip
    gltf.primitive()["indices"] = gltf.accessor<uint16_t>({0, 1, 3, 2}, "SCALAR", 5123, 1);
    const Scene strip = load();
    gltf.primitive()["mode"] = 6; // fan
    gltf.primitive()["indices"] = gltf.accessor<uint16_t>({0, 1, 2, 3}, "SCALAR", 5123, 1);
    const Scene fan = load();
    for (const Scene* scene : {&strip, &fan}) {
        const auto points = corners(scene->meshes[0]);
        ASSERT_EQ(points.size(), 6u);
        for (size_t i = 0; i < 6; i += 3)
            EXPECT_GT(glm::cross(points[i + 1] - points[i], points[i + 2] - points[i]).z, 0.5f);
    }
}

TEST_F(Gltf, StripStitchesAreLeftOut)
{
    gltf.quad();
    gltf.primitive()["mode"] = 5;
    gltf.primitive()["indices"] = gltf.accessor<uint16_t>({0, 1, 3, 3, 3, 2}, "SCALAR", 5123, 1);
    EXPECT_EQ(load().meshes[0].indices.size(), 3u);
}

TEST_F(Gltf, PointsAndLinesAreSkipped)
{
    gltf.quad();
    json lines = gltf.primitive();
    lines["mode"] = 1;
    gltf.root["meshes"][0]["primitives"].push_back(lines);
    EXPECT_EQ(load().objects.size(), 1u);
}

TEST_F(Gltf, InterleavedVerticesAreRead)
{
    // position and UV in 20 bytes
    const std::vector<float> data = {0, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0, 1, 0, 0, 0};
    const size_t view = gltf.view(data.data(), data.size() * 4, 20);
    gltf.root["accessors"] = {
        {{"bufferView", view}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 3}},
        {{"bufferView", view}, {"byteOffset", 12}, {"componentType", 5126}, {"type", "VEC2"}, {"count", 3}}};
    gltf.primitive()["attributes"] = {{"POSITION", 0}, {"TEXCOORD_0", 1}};
    const Scene scene = load();
    expectNear(scene.meshes[0].vertices[1].position, {1, 0, 0});
    EXPECT_EQ(scene.meshes[0].vertices[1].uv, glm::vec2(1, 1));
    EXPECT_EQ(scene.meshes[0].vertices[2].uv, glm::vec2(0, 0));
}

TEST_F(Gltf, NormalisedUvsAreDecoded)
{
    gltf.quad();
    gltf.primitive()["attributes"]["TEXCOORD_0"] =
        gltf.accessor<uint16_t>({0, 65535, 65535, 65535, 65535, 0, 0, 0}, "VEC2", 5123, 2);
    gltf.root["accessors"].back()["normalized"] = true;
    EXPECT_EQ(load().meshes[0].vertices[1].uv, glm::vec2(1, 1));
    gltf.primitive()["attributes"]["TEXCOORD_0"] =
        gltf.accessor<uint8_t>({0, 255, 51, 255, 255, 0, 0, 0}, "VEC2", 5121, 2);
    gltf.root["accessors"].back()["normalized"] = true;
    EXPECT_FLOAT_EQ(load().meshes[0].vertices[1].uv.x, 0.2f);
}

TEST_F(Gltf, SparseValuesReplaceOthers)
{
    gltf.quad();
    const uint8_t index = 2;
    const float value[3] = {3, 2, 1};
    gltf.root["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", gltf.view(&index, 1)}, {"componentType", 5121}}},
        {"values", {{"bufferView", gltf.view(value, 12)}}}};
    const Scene scene = load();
    expectNear(scene.meshes[0].vertices[2].position, {3, 2, 1});
    expectNear(scene.meshes[0].vertices[3].position, {0, 1, 0});
}

TEST_F(Gltf, SparseValuesMayStandOnZeros)
{
    const uint8_t index[2] = {1, 2};
    const float value[6] = {1, 0, 0, 0, 1, 0};
    gltf.root["accessors"] = {{{"componentType", 5126},
                               {"type", "VEC3"},
                               {"count", 3},
                               {"sparse",
                                {{"count", 2},
                                 {"indices", {{"bufferView", gltf.view(index, 2)}, {"componentType", 5121}}},
                                 {"values", {{"bufferView", gltf.view(value, 24)}}}}}}};
    gltf.primitive()["attributes"] = {{"POSITION", 0}};
    EXPECT_EQ(corners(load().meshes[0]), (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST_F(Gltf, UnusedVerticesAreDropped)
{
    gltf.quad();
    gltf.primitive()["indices"] = gltf.accessor<uint16_t>({1, 2, 3}, "SCALAR", 5123, 1);
    const Scene scene = load();
    EXPECT_EQ(scene.meshes[0].vertices.size(), 3u);
    EXPECT_EQ(corners(scene.meshes[0]), (std::vector<glm::vec3>{{1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
}

TEST_F(Gltf, MeshesAreSharedByObjectsAndMaterials)
{
    gltf.quad();
    gltf.root["materials"] = {{{"name", "red"}}, {{"name", "blue"}}};
    json blue = gltf.primitive();
    gltf.primitive()["material"] = 0;
    blue["material"] = 1;
    gltf.root["meshes"].push_back({{"primitives", {blue}}});
    gltf.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 1}}, {{"mesh", 0}}};
    gltf.root["scenes"][0]["nodes"] = {0, 1, 2};
    const Scene scene = load();
    EXPECT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.objects.size(), 3u);
    EXPECT_EQ(scene.materials[size_t(scene.objects[1].material)].name, "blue");
    EXPECT_EQ(scene.materials[size_t(scene.objects[2].material)].name, "red");
}

TEST_F(Gltf, UnusedMaterialsAreDropped)
{
    gltf.quad();
    gltf.root["materials"] = {{{"name", "unused"}}, {{"name", "used"}}};
    gltf.primitive()["material"] = 1;
    const Scene scene = load();
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].name, "used");
    EXPECT_EQ(scene.objects[0].material, 0);
}

// --- Nodes

TEST_F(Gltf, TransformsMultiplyDownTheTree)
{
    gltf.quad();
    const float s = std::sqrt(0.5f); // a quarter turn about +z
    gltf.root["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}, {"rotation", {0, 0, s, s}}},
                          {{"children", {2}}, {"scale", {2, 3, 4}}},
                          {{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}}};
    const Scene scene = load();
    // (1, 1, 0) -> moved (6, 1, 0) -> scaled (12, 3, 0) -> turned (-3, 12, 0) -> moved (7, 12, 0)
    expectNear(transformed(scene.objects[0], {1, 1, 0}), {7, 12, 0});
    expectNear(scene.bounds.lower, {7, 10, 0});
    expectNear(scene.bounds.upper, {10, 12, 0});
}

TEST_F(Gltf, OnlyTheDefaultSceneIsRead)
{
    gltf.quad();
    gltf.root["nodes"] = {{{"mesh", 0}, {"name", "first"}}, {{"mesh", 0}, {"name", "second"}}};
    gltf.root["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
    gltf.root["scene"] = 1;
    const Scene scene = load();
    ASSERT_EQ(scene.objects.size(), 1u);
    EXPECT_EQ(scene.objects[0].name, "second");
}

TEST_F(Gltf, WithoutScenesTheRootNodesAreRead)
{
    gltf.quad();
    gltf.root.erase("scene");
    gltf.root.erase("scenes");
    gltf.root["nodes"] = {{{"mesh", 0}, {"name", "child"}}, {{"children", {0}}, {"translation", {0, 0, 5}}}};
    const Scene scene = load();
    ASSERT_EQ(scene.objects.size(), 1u);
    expectNear(transformed(scene.objects[0], {0, 0, 0}), {0, 0, 5});
}

TEST_F(Gltf, ObjectsScaledToNothingAreNotDrawn)
{
    gltf.quad();
    gltf.root["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"scale", {1, 0, 1}}}};
    gltf.root["scenes"][0]["nodes"] = {0, 1};
    EXPECT_EQ(load().objects.size(), 1u);
}

TEST_F(Gltf, CamerasLookAlongTheirNodesMinusZ)
{
    gltf.quad();
    const float s = std::sqrt(0.5f); // a quarter turn about +y: -z becomes -x
    gltf.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.5}, {"znear", 0.25}}}},
                            {{"type", "orthographic"},
                             {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 0.1}, {"zfar", 10}}}}};
    gltf.root["nodes"].push_back({{"name", "eye"},
                                  {"camera", 0},
                                  {"translation", {4, 5, 6}},
                                  {"rotation", {0, s, 0, s}},
                                  {"scale", {2, 2, 2}}});
    gltf.root["nodes"].push_back({{"name", "flat"}, {"camera", 1}});
    gltf.root["scenes"][0]["nodes"] = {0, 1, 2};
    const Scene scene = load();
    ASSERT_EQ(scene.cameras.size(), 1u) << "the orthographic one is skipped";
    const Camera& camera = scene.cameras[0];
    EXPECT_EQ(camera.name, "eye");
    expectNear(camera.eye, {4, 5, 6});
    expectNear(glm::normalize(camera.target - camera.eye), {-1, 0, 0});
    expectNear(camera.up, {0, 1, 0});
    EXPECT_FLOAT_EQ(camera.yFov, 0.5f);
    EXPECT_FLOAT_EQ(camera.nearMetres, 0.25f);
    // The target lies beside the middle of the scene, so that orbits turn about the model.
    EXPECT_NEAR(camera.target.x, 0.5f, 1e-5f);
}

TEST_F(Gltf, LightsKeepUnitsAndDirection)
{
    gltf.quad();
    gltf.root["extensionsUsed"] = {"KHR_lights_punctual"};
    gltf.root["extensionsRequired"] = {"KHR_lights_punctual"};
    gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "directional"}, {"intensity", 3}, {"color", {1, 0.5, 0.25}}},
        {{"type", "point"}, {"range", 7}},
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}},
        {{"type", "spot"}, {"spot", json::object()}}};
    const float s = std::sqrt(0.5f); // a quarter turn about -x: -z becomes -y
    for (int i = 0; i < 4; ++i) {
        gltf.root["nodes"].push_back({{"rotation", {-s, 0, 0, s}},
                                      {"translation", {i, 0, 0}},
                                      {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
        gltf.root["scenes"][0]["nodes"].push_back(i + 1);
    }
    const Scene scene = load();
    ASSERT_EQ(scene.lights.size(), 4u);
    const Light& sun = scene.lights[0];
    EXPECT_EQ(sun.type, LightType::directional);
    expectNear(sun.direction, {0, -1, 0});
    expectNear(sun.colour, {1, 0.5f, 0.25f});
    EXPECT_FLOAT_EQ(sun.intensity, 3.0f);
    EXPECT_EQ(scene.lights[1].type, LightType::point);
    EXPECT_FLOAT_EQ(scene.lights[1].range, 7.0f);
    expectNear(scene.lights[1].position, {1, 0, 0});
    EXPECT_FLOAT_EQ(scene.lights[1].intensity, 1.0f);
    EXPECT_FLOAT_EQ(scene.lights[2].innerCone, 0.2f);
    EXPECT_FLOAT_EQ(scene.lights[2].outerCone, 0.4f);
    EXPECT_FLOAT_EQ(scene.lights[3].innerCone, 0.0f);
    EXPECT_FLOAT_EQ(scene.lights[3].outerCone, 0.7853982f);
}

} // namespace
} // namespace lumel::scene
