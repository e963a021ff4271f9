// Which coordinates a loaded mesh is lit at, and where its material's maps are read.
#include "charts/lit_uvs.h"
#include "gltf_builder.h"

namespace lumel::scene {
namespace {

using nlohmann::json;

const std::vector<float> kUnique = {0, 1, 1, 1, 1, 0, 0, 0};
const std::vector<float> kTiled = {0, 4, 4, 4, 4, 0, 0, 0};
const std::vector<float> kFolded = {0, 0, 1, 0, 1, 1, 1, 0}; // both triangles on top of each other

struct GltfUvs : testing::Test {
    TemporaryFolder folder;
    GltfBuilder gltf;
    Scene load() { return loadGltf(gltf.writeGltf(folder)); }

    void uvs(const std::vector<float>& first, const std::vector<float>& second = {})
    {
        gltf.quad(true, false);
        if (!first.empty())
            gltf.primitive()["attributes"]["TEXCOORD_0"] = gltf.floats(first, "VEC2", 2);
        if (!second.empty())
            gltf.primitive()["attributes"]["TEXCOORD_1"] = gltf.floats(second, "VEC2", 2);
    }
    // A material with these textures, all of one image and sampler.
    void material(const json& pbr, const json& others = json::object(), const json& sampler = json::object())
    {
        writeText(folder / "a.png", "never decoded");
        gltf.root["images"] = {{{"uri", "a.png"}}};
        gltf.root["samplers"] = {sampler};
        gltf.root["textures"] = {{{"source", 0}, {"sampler", 0}}};
        gltf.material() = others;
        gltf.material()["pbrMetallicRoughness"] = pbr;
        gltf.primitive()["material"] = 0;
    }
    static json texture(int set, const json& transform = {})
    {
        json info = {{"index", 0}, {"texCoord", set}};
        if (!transform.is_null())
            info["extensions"]["KHR_texture_transform"] = transform;
        return info;
    }
};

void expectUvs(const Mesh& mesh, glm::vec2 Vertex::*member, const std::vector<float>& expected)
{
    ASSERT_EQ(mesh.vertices.size() * 2, expected.size());
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
        EXPECT_FLOAT_EQ((mesh.vertices[i].*member).x, expected[2 * i]) << i;
        EXPECT_FLOAT_EQ((mesh.vertices[i].*member).y, expected[2 * i + 1]) << i;
    }
}

TEST_F(GltfUvs, UniqueOnesAreLitAsTheyAre)
{
    uvs(kUnique, kTiled);
    const Mesh mesh = load().meshes[0];
    EXPECT_FALSE(mesh.unwrapped);
    expectUvs(mesh, &Vertex::uv, kUnique);
    expectUvs(mesh, &Vertex::materialUv, kUnique);
    expectUvs(mesh, &Vertex::emissionUv, kUnique);
}

TEST_F(GltfUvs, TheSecondSetIsLitWhereTheFirstIsNotUnique)
{
    for (const auto& first : {kTiled, kFolded, std::vector<float>()}) {
        uvs(first, kUnique);
        const Mesh mesh = load().meshes[0];
        EXPECT_FALSE(mesh.unwrapped);
        EXPECT_EQ(mesh.uvProblem, "");
        for (size_t i = 0; i < 4; ++i) { // where the first set is folded, tangents need more vertices
            EXPECT_EQ(mesh.vertices[i].uv, glm::vec2(kUnique[2 * i], kUnique[2 * i + 1]));
            if (!first.empty()) {
                EXPECT_EQ(mesh.vertices[i].materialUv, glm::vec2(first[2 * i], first[2 * i + 1]));
            }
        }
    }
}

TEST_F(GltfUvs, WhereNoneIsUniqueTheMeshIsUnwrapped)
{
    for (const auto& [first, second] : {std::pair(kTiled, kFolded), std::pair(kFolded, std::vector<float>()),
                                        std::pair(std::vector<float>(), std::vector<float>())}) {
        uvs(first, second);
        const Mesh mesh = load().meshes[0];
        ASSERT_TRUE(mesh.unwrapped);
        EXPECT_EQ(mesh.unwrapped->charts, 1u);
        EXPECT_EQ(mesh.uvProblem, "");
        EXPECT_EQ(mesh.indices.size(), 6u);
    }
}

TEST_F(GltfUvs, ProblemsAreNamed)
{
    Mesh mesh;
    mesh.vertices.resize(4);
    mesh.indices = {0, 1, 2, 0, 2, 3};
    const auto set = [](const std::vector<float>& values) {
        std::vector<glm::vec2> uvs;
        for (size_t i = 0; i < values.size(); i += 2)
            uvs.emplace_back(values[i], values[i + 1]);
        return uvs;
    };
    const auto problem = [&](const std::vector<float>& a, const std::vector<float>& b) {
        chooseLitUvs(std::vector{set(a), set(b)}, mesh);
        return mesh.uvProblem;
    };
    EXPECT_EQ(problem({}, {}), "no UVs");
    EXPECT_EQ(problem(kTiled, {}), "UVs leave [0, 1]");
    EXPECT_EQ(problem(kTiled, std::vector<float>(8, 0.5f)), "UVs leave [0, 1]"); // the first set's
    expectUvs(mesh, &Vertex::uv, kTiled);
    EXPECT_EQ(problem(std::vector<float>(8, 0.5f), {}), "UVs cover no area");
    EXPECT_EQ(problem(kTiled, kUnique), "");
}

TEST_F(GltfUvs, MapsAreReadAtTheirOwnSet)
{
    uvs(kUnique, kTiled);
    material({{"baseColorTexture", texture(1)}}, {{"occlusionTexture", texture(0)}});
    const Mesh mesh = load().meshes[0];
    expectUvs(mesh, &Vertex::uv, kUnique);
    expectUvs(mesh, &Vertex::materialUv, kTiled);
    expectUvs(mesh, &Vertex::emissionUv, kUnique);
}

TEST_F(GltfUvs, TransformsMoveTheMapsNotTheLumels)
{
    uvs(kUnique);
    // (u, v) scaled by (2, 3), turned by a quarter from u towards -v: (3 v, -2 u), then moved.
    const json transform = {{"offset", {0.5, 0.25}}, {"rotation", std::acos(0.0)}, {"scale", {2, 3}}};
    material({{"baseColorTexture", texture(0, transform)}});
    gltf.root["extensionsUsed"] = {"KHR_texture_transform"};
    gltf.root["extensionsRequired"] = {"KHR_texture_transform"};
    const Scene scene = load();
    const Mesh& mesh = scene.meshes[0];
    expectUvs(mesh, &Vertex::uv, kUnique);
    for (const Vertex& v : mesh.vertices) {
        EXPECT_NEAR(v.materialUv.x, 3.0f * v.uv.y + 0.5f, 1e-5f);
        EXPECT_NEAR(v.materialUv.y, -2.0f * v.uv.x + 0.25f, 1e-5f);
        // Tangents point where the map's u grows: here down the picture, along -y.
        EXPECT_NEAR(v.tangent.y, -1.0f, 1e-5f);
    }
    // The transform's own set counts.
    uvs(kUnique, kTiled);
    material({{"baseColorTexture", texture(0, {{"texCoord", 1}})}});
    expectUvs(load().meshes[0], &Vertex::materialUv, kTiled);
}

TEST_F(GltfUvs, WrapModesAreRead)
{
    uvs(kUnique);
    material({{"baseColorTexture", texture(0)}}, json::object(), {{"wrapS", 33071}, {"wrapT", 33648}});
    const Scene scene = load();
    EXPECT_EQ(scene.materials[0].uv.wrapU, Wrap::clamp);
    EXPECT_EQ(scene.materials[0].uv.wrapV, Wrap::mirror);
    EXPECT_EQ(scene.materials[0].emissionUv.wrapU, Wrap::clamp); // none of its own
}

TEST_F(GltfUvs, OneMeshUnderTwoTransformsIsTwo)
{
    uvs(kUnique);
    material({{"baseColorTexture", texture(0)}});
    gltf.root["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"] =
        texture(0, {{"offset", {0.5, 0}}});
    gltf.root["materials"][2]["pbrMetallicRoughness"]["baseColorTexture"] = texture(0);
    auto& primitives = gltf.root["meshes"][0]["primitives"];
    for (int i = 1; i < 3; ++i) {
        primitives[size_t(i)] = primitives[0];
        primitives[size_t(i)]["material"] = i;
    }
    const Scene scene = load();
    EXPECT_EQ(scene.meshes.size(), 2u);
    ASSERT_EQ(scene.objects.size(), 3u);
    EXPECT_EQ(scene.objects[0].mesh, scene.objects[2].mesh);
}

TEST_F(GltfUvs, WrongTransformsAreRefused)
{
    for (const json& transform : {json{{"offset", {1}}}, json{{"scale", "large"}}, json{{"rotation", "left"}},
                                  json{{"offset", {"a", 1}}}, json{{"rotation", 1e300}}}) {
        uvs(kUnique);
        material({{"baseColorTexture", texture(0, transform)}});
        expectRefused(gltf.writeGltf(folder), "material 'material 0'");
    }
}

TEST_F(GltfUvs, TransformsBeyondFloatsAreRefused)
{
    uvs({0, 1e30f, 1e30f, 1, 1, 0, 0, 0});
    material({{"baseColorTexture", texture(0, {{"scale", {1e30, 1e30}}})}});
    expectRefused(gltf.writeGltf(folder), "out of range");
}

} // namespace
} // namespace lumel::scene
