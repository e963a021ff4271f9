// Compressed, quantised and instanced geometry: what arrives is what was packed, and damage is refused.
#include "gltf_compress.h"
#include <map>

namespace lumel::scene {
namespace {

using nlohmann::json;

struct Compression : testing::Test {
    TemporaryFolder folder;
    GltfBuilder gltf;
    Scene load() { return loadGltf(gltf.writeGltf(folder)); }
};

void expectNear(glm::vec3 a, glm::vec3 b, float tolerance = 1e-5f)
{
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(a[c], b[c], tolerance);
}

// UVs by position: what is seen, in whatever order it is stored. `tolerance` of both.
void expectUnitSquare(const Mesh& mesh, float tolerance)
{
    ASSERT_EQ(mesh.indices.size(), 6u);
    float area = 0.0f;
    for (size_t i = 0; i < 6; i += 3) {
        const glm::vec3 a = mesh.vertices[mesh.indices[i]].position;
        const glm::vec3 b = mesh.vertices[mesh.indices[i + 1]].position;
        const glm::vec3 c = mesh.vertices[mesh.indices[i + 2]].position;
        area += 0.5f * glm::cross(b - a, c - a).z;
    }
    EXPECT_NEAR(area, 1.0f, 4.0f * tolerance) << "both triangles face +z";
    for (const Vertex& v : mesh.vertices) {
        EXPECT_NEAR(v.uv.x, v.position.x, 2.0f * tolerance);
        EXPECT_NEAR(v.uv.y, 1.0f - v.position.y, 2.0f * tolerance);
    }
}

TEST_F(Compression, MeshoptGivesBackEveryBit)
{
    gltf.quad();
    const Scene plain = load();
    packQuadWithMeshopt(gltf);
    const Scene packed = load();
    EXPECT_EQ(packed.meshes.at(0).indices, plain.meshes.at(0).indices);
    for (size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(packed.meshes[0].vertices.at(i).position, plain.meshes[0].vertices.at(i).position);
        EXPECT_EQ(packed.meshes[0].vertices[i].normal, plain.meshes[0].vertices[i].normal);
        EXPECT_EQ(packed.meshes[0].vertices[i].uv, plain.meshes[0].vertices[i].uv);
    }
}

TEST_F(Compression, MeshoptIndexSequences)
{
    gltf.quad();
    const size_t view = gltf.root["accessors"][3]["bufferView"];
    packView(gltf, view, packSequence({0, 1, 2, 0, 2, 3}, 4), "INDICES", 6, 2);
    addFallbackBuffer(gltf);
    EXPECT_EQ(load().meshes.at(0).indices, (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
}

TEST_F(Compression, MeshoptFilters)
{
    gltf.quad();
    // Octahedral normals in 8 bits with 4 bytes per normal, exponential positions with 12.
    const std::vector<float> normals = {0, 0, 1, 0, 0, 0, 1, 0, 0.6f, 0, 0.8f, 0, 0, 0.6f, 0.8f, 0};
    std::string octahedral(16, '\0'), exponential(48, '\0');
    meshopt_encodeFilterOct(octahedral.data(), 4, 4, 8, normals.data());
    const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 1, 1, 0.375f, 0, 1, 0};
    meshopt_encodeFilterExp(exponential.data(), 4, 12, 15, positions.data());
    packView(gltf, gltf.root["accessors"][1]["bufferView"], packVertices(octahedral.data(), 4, 4),
             "ATTRIBUTES", 4, 4, "OCTAHEDRAL");
    packView(gltf, gltf.root["accessors"][0]["bufferView"], packVertices(exponential.data(), 4, 12),
             "ATTRIBUTES", 4, 12, "EXPONENTIAL");
    gltf.root["accessors"][1]["componentType"] = 5120;
    gltf.root["accessors"][1]["normalized"] = true;
    gltf.root["extensionsUsed"].push_back("KHR_mesh_quantization");
    addFallbackBuffer(gltf);
    const Scene scene = load();
    for (size_t i = 0; i < 4; ++i) {
        expectNear(scene.meshes.at(0).vertices.at(i).normal,
                   {normals[4 * i], normals[4 * i + 1], normals[4 * i + 2]}, 0.02f);
        expectNear(scene.meshes[0].vertices[i].position,
                   {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]}, 1e-3f);
    }
}

TEST_F(Compression, DamagedMeshoptIsRefused)
{
    gltf.quad();
    packQuadWithMeshopt(gltf);
    const GltfBuilder whole = gltf;
    const char* path = "/bufferViews/0/extensions/EXT_meshopt_compression/";
    const auto refuse = [&](const char* key, const json& value, const char* part) {
        gltf = whole;
        gltf.root[json::json_pointer(std::string(path) + key)] = value;
        expectRefused(gltf.writeGltf(folder), part);
    };
    refuse("count", 1u << 31, "cannot hold");
    refuse("count", 0, "cannot hold");
    refuse("count", -1, "usable count");
    refuse("byteStride", 3, "cannot hold");
    refuse("byteStride", 0, "cannot hold");
    refuse("byteLength", 1 << 20, "past the end");
    refuse("byteLength", 2, "");
    refuse("buffer", 9, "buffer 9");
    refuse("buffer", 1, "past the end"); // compressed data in the fallback
    refuse("mode", "MAGIC", "mode 'MAGIC'");
    refuse("filter", "OCTAHEDRAL", "filter"); // needs a stride of 4 or 8
    refuse("filter", "MAGIC", "filter 'MAGIC'");
    gltf = whole;
    const size_t at = gltf.root[json::json_pointer(std::string(path) + "byteOffset")];
    gltf.binary[at] = 0; // the codec's first byte
    expectRefused(gltf.writeGltf(folder), "damaged EXT_meshopt_compression");
}

TEST_F(Compression, DracoMeshesAreDecoded)
{
    packQuadWithDraco(gltf);
    expectUnitSquare(load().meshes.at(0), 1e-3f); // 11 bits by default
}

TEST_F(Compression, DracoIsDecodedOnceForPrimitivesThatShareIt)
{
    packQuadWithDraco(gltf);
    gltf.root["materials"] = {json::object(), json::object()};
    gltf.root["meshes"][0]["primitives"].push_back(gltf.primitive());
    gltf.primitive(1)["material"] = 1;
    const Scene scene = load();
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.objects.size(), 2u);
}

TEST_F(Compression, DamagedDracoIsRefused)
{
    packQuadWithDraco(gltf);
    const GltfBuilder whole = gltf;
    for (size_t size = 0; size < whole.binary.size() - 8; size += 7) {
        gltf = whole;
        gltf.root["bufferViews"][0]["byteLength"] = std::max(size, size_t(1));
        expectRefused(gltf.writeGltf(folder), "Draco");
    }
    // Its numbers of vertices and faces, as varints of five bytes, follow the header and the traversal's
    // kind.
    gltf = whole;
    gltf.binary.replace(12, 10, "\xff\xff\xff\xff\x0f\xff\xff\xff\xff\x0f");
    expectRefused(gltf.writeGltf(folder), "more than 16777216 triangles");
    gltf = whole;
    gltf.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 17;
    expectRefused(gltf.writeGltf(folder), "POSITION is not in the Draco data");
    gltf = whole;
    gltf.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["NORMAL"] = 0;
    expectRefused(gltf.writeGltf(folder), "NORMAL");
    gltf = whole;
    gltf.primitive()["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = 5;
    expectRefused(gltf.writeGltf(folder), "buffer view 5");
}

// KHR_mesh_quantization and glTF 2.0, section 3.6.2.2: c / 127, c / 255, c / 32767, c / 65535; or as they
// are.
TEST_F(Compression, QuantisedPositionsOfEveryType)
{
    const auto check = [&]<class T>(T value, int type, bool normalised, float expected) {
        GltfBuilder fresh;
        gltf = fresh.quad();
        // Two components of padding where the element is not a multiple of 4 bytes.
        const size_t stride = sizeof(T) == 1 ? 4 : 8;
        std::string bytes(stride * 4, '\0');
        for (size_t v = 1; v < 4; ++v)
            std::memcpy(bytes.data() + v * stride + (v - 1) * sizeof(T), &value, sizeof(T));
        const size_t view = gltf.view(bytes.data(), bytes.size(), stride);
        gltf.root["accessors"][0] = {{"bufferView", view},
                                     {"componentType", type},
                                     {"type", "VEC3"},
                                     {"count", 4},
                                     {"normalized", normalised}};
        gltf.root["extensionsUsed"] = {"KHR_mesh_quantization"};
        gltf.root["extensionsRequired"] = {"KHR_mesh_quantization"};
        const Scene scene = load();
        for (int v = 1; v < 4; ++v) {
            glm::vec3 position(0.0f);
            position[v - 1] = expected;
            expectNear(scene.meshes.at(0).vertices.at(size_t(v)).position, position, 1e-6f);
        }
    };
    check(int8_t(-64), 5120, true, -64.0f / 127.0f);
    check(int8_t(-128), 5120, true, -1.0f);
    check(int8_t(-64), 5120, false, -64.0f);
    check(uint8_t(51), 5121, true, 0.2f);
    check(uint8_t(200), 5121, false, 200.0f);
    check(int16_t(16384), 5122, true, 16384.0f / 32767.0f);
    check(int16_t(-300), 5122, false, -300.0f);
    check(uint16_t(13107), 5123, true, 0.2f);
    check(uint16_t(60000), 5123, false, 60000.0f);
}

TEST_F(Compression, QuantisedNormalsTangentsAndUvs)
{
    gltf.quad();
    auto& attributes = gltf.primitive()["attributes"];
    attributes["NORMAL"] =
        gltf.accessor<int8_t>({0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0}, "VEC3", 5120, 4);
    gltf.root["bufferViews"].back()["byteStride"] = 4;
    gltf.root["accessors"].back()["normalized"] = true;
    attributes["TANGENT"] = gltf.accessor<int16_t>(
        {32767, 0, 0, -32767, 32767, 0, 0, -32767, 32767, 0, 0, -32767, 32767, 0, 0, -32767}, "VEC4", 5122,
        4);
    gltf.root["accessors"].back()["normalized"] = true;
    attributes["TEXCOORD_0"] =
        gltf.accessor<uint8_t>({0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, "VEC2", 5121, 4);
    gltf.root["bufferViews"].back()["byteStride"] = 4;
    gltf.root["extensionsUsed"] = {"KHR_mesh_quantization"};
    const Scene scene = load();
    const Vertex& v = scene.meshes.at(0).vertices.at(1);
    expectNear(v.normal, {0, 0, 1});
    EXPECT_EQ(v.tangent, glm::vec4(1, 0, 0, -1));
    EXPECT_EQ(v.uv, glm::vec2(1, 1));
}

TEST_F(Compression, InstancesShareTheMesh)
{
    gltf.quad();
    gltf.node()["translation"] = {10, 0, 0};
    gltf.node()["name"] = "leaf";
    json& attributes = gltf.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes["TRANSLATION"] = gltf.floats({1, 0, 0, 0, 2, 0}, "VEC3", 3);
    attributes["ROTATION"] = gltf.accessor<int16_t>({0, 0, 0, 32767, 0, 0, 23170, 23170}, "VEC4", 5122, 4);
    gltf.root["accessors"].back()["normalized"] = true; // the second turns by 90 degrees about z
    attributes["SCALE"] = gltf.floats({1, 1, 1, 2, 3, 4}, "VEC3", 3);
    gltf.root["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    gltf.root["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
    const Scene scene = load();
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.objects[0].mesh, scene.objects[1].mesh);
    EXPECT_EQ(scene.objects[1].name, "leaf#1");
    const auto moved = [&](size_t i, glm::vec3 p) {
        return glm::vec3(scene.objects[i].worldFromObject * glm::vec4(p, 1.0f));
    };
    expectNear(moved(0, {1, 1, 0}), {12, 1, 0}, 1e-4f);
    expectNear(moved(1, {1, 0, 0}), {10, 4, 0}, 1e-3f); // scaled by 2, turned to +y, moved by (10, 2)
    expectNear(moved(1, {0, 1, 0}), {7, 2, 0}, 1e-3f);
}

TEST_F(Compression, BrokenInstancesAreRefused)
{
    gltf.quad();
    json& extension = gltf.node()["extensions"]["EXT_mesh_gpu_instancing"];
    extension = json::object();
    expectRefused(gltf.writeGltf(folder), "no attributes");
    extension["attributes"] = {{"TRANSLATION", 99}};
    expectRefused(gltf.writeGltf(folder), "accessor 99");
    extension["attributes"] = {{"TRANSLATION", 0}, {"SCALE", gltf.floats({1, 1, 1}, "VEC3", 3)}};
    expectRefused(gltf.writeGltf(folder), "1 elements");
    extension["attributes"] = {{"ROTATION", gltf.floats({0, 0, 0, 0}, "VEC4", 4)}};
    expectRefused(gltf.writeGltf(folder), "wrong rotation");
    gltf.root["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 2'000'000}});
    extension["attributes"] = {{"TRANSLATION", gltf.root["accessors"].size() - 1}};
    expectRefused(gltf.writeGltf(folder), "more than 1048576 objects");
}

} // namespace
} // namespace lumel::scene
