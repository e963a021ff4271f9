// Skins and morph targets, against slow formulas in double that share nothing with the loader.
#include "gltf_builder.h"
#include "scene/animation.h"
#include <numbers>
#include <random>

namespace lumel::scene {
namespace {

using nlohmann::json;

// A quad under a skin of two joints: the second hangs one metre above the first, which moves and turns.
struct DeformingGltf : testing::Test {
    TemporaryFolder folder;
    GltfBuilder gltf;
    const std::vector<float> joints{0, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0};
    const std::vector<float> weights{0.75f, 0.25f, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 1, 0, 0, 0};

    DeformingGltf()
    {
        gltf.quad();
        gltf.root["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}},
                              {{"children", {2}}, {"scale", {2, 1, 1}}},
                              {{"translation", {0, 1, 0}}}};
        gltf.root["scenes"] = {{{"nodes", {0, 1}}}};
        gltf.root["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverses()}}};
        setJoints(gltf.accessor(cast<uint8_t>(joints), "VEC4", 5121, 4), gltf.floats(weights, "VEC4", 4));
        gltf.root["animations"] = {{{"samplers",
                                     {{{"input", gltf.floats({0, 2}, "SCALAR", 1)},
                                       {"output", gltf.floats({0, 0, 0, 4, 0, 2}, "VEC3", 3)}},
                                      {{"input", gltf.floats({0, 2}, "SCALAR", 1)},
                                       {"output", gltf.floats({0, 0, 0, 1, 0, 0, 1, 0}, "VEC4", 4)}}}},
                                    {"channels",
                                     {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}},
                                      {{"sampler", 1}, {"target", {{"node", 2}, {"path", "rotation"}}}}}}}};
    }
    template<class T>
    static std::vector<T> cast(const std::vector<float>& values, float scale = 1.0f)
    {
        std::vector<T> all;
        for (float v : values)
            all.push_back(T(std::round(v * scale)));
        return all;
    }
    size_t inverses()
    {
        std::vector<float> values(32, 0.0f);
        for (size_t i = 0; i < 32; i += 16)
            values[i] = values[i + 5] = values[i + 10] = values[i + 15] = 1.0f;
        values[16 + 13] = -1.0f; // the second stands at y = 1
        return gltf.floats(values, "MAT4", 16);
    }
    void setJoints(size_t jointAccessor, size_t weightAccessor)
    {
        gltf.primitive()["attributes"]["JOINTS_0"] = jointAccessor;
        gltf.primitive()["attributes"]["WEIGHTS_0"] = weightAccessor;
    }
    Scene load() { return loadGltf(gltf.writeGlb(folder)); }
    void expectDeformationRefused(const std::string& part) { expectRefused(gltf.writeGltf(folder), part); }

    // By hand: the first joint goes to (2 t, 0, t), twice as wide along x; the second turns by pi t / 2 about
    // z.
    glm::dvec3 placeOf(size_t vertex, double t) const
    {
        const glm::dvec3 p(vertex == 1 || vertex == 2, vertex >= 2, 0.0);
        const double angle = std::numbers::pi * t / 2.0, c = std::cos(angle), s = std::sin(angle);
        const glm::dvec3 turned(c * p.x - s * (p.y - 1.0), s * p.x + c * (p.y - 1.0), p.z);
        const auto first = [&](glm::dvec3 q) { return glm::dvec3(2.0 * q.x + 2.0 * t, q.y, q.z + t); };
        const glm::dvec3 places[2] = {first(p), first(turned + glm::dvec3(0, 1, 0))};
        glm::dvec3 sum(0.0);
        for (size_t k = 0; k < 4; ++k)
            sum += double(weights[4 * vertex + k]) * places[size_t(joints[4 * vertex + k])];
        return sum;
    }
    void expectOracle(const Scene& scene, double tolerance)
    {
        ASSERT_EQ(scene.deformed.size(), 1u);
        const Mesh& mesh = scene.meshes[0];
        for (const double t : {0.0, 0.3, 1.0, 1.9}) {
            const Shapes shapes = shapesAt(scene.skins, scene.deformed, scene.animation, t);
            const auto vertices = deformedVertices(mesh, shapes.joints[0], shapes.weights[0]);
            const Bounds box = deformedBounds(mesh.deformation.extents, shapes.joints[0], shapes.weights[0]);
            for (size_t i = 0; i < vertices.size(); ++i) {
                const glm::vec3 at = vertices[i].position, rest = mesh.vertices[i].position;
                const size_t corner = rest.y == 0.0f ? size_t(rest.x) : 3 - size_t(rest.x); // of the file
                EXPECT_LT(glm::distance(glm::dvec3(at), placeOf(corner, t)), tolerance) << t << ' ' << i;
                EXPECT_TRUE(glm::all(glm::lessThanEqual(box.lower, at + 1e-4f)));
                EXPECT_TRUE(glm::all(glm::greaterThanEqual(box.upper, at - 1e-4f)));
            }
        }
    }
};

TEST_F(DeformingGltf, JointsTakeVerticesWhereTheFormulaSays)
{
    const Scene scene = load();
    expectOracle(scene, 1e-5);
    EXPECT_EQ(scene.objects[0].worldFromObject, glm::mat4(1.0f)) << "the node's own place counts for nothing";
    EXPECT_EQ(scene.animation.seconds, 2.0);
}

TEST_F(DeformingGltf, EveryComponentTypeSaysTheSame)
{
    const auto normalized = [&](size_t accessor) {
        gltf.root["accessors"][accessor]["normalized"] = true;
        return accessor;
    };
    const size_t shorts = gltf.accessor(cast<uint16_t>(joints), "VEC4", 5123, 4);
    setJoints(shorts, normalized(gltf.accessor(cast<uint8_t>(weights, 255), "VEC4", 5121, 4)));
    expectOracle(load(), 0.02);
    setJoints(shorts, normalized(gltf.accessor(cast<uint16_t>(weights, 65535), "VEC4", 5123, 4)));
    expectOracle(load(), 1e-4);
}

TEST_F(DeformingGltf, TheSecondSetCounts)
{
    // The same skin with the influences in another order, half of them in the second set.
    std::vector<float> first(16, 0.0f), second(16, 0.0f), jointsOfSecond(16, 0.0f);
    for (size_t v = 0; v < 4; ++v) {
        first[4 * v] = weights[4 * v];
        second[4 * v + 2] = weights[4 * v + 1];
        jointsOfSecond[4 * v + 2] = joints[4 * v + 1];
    }
    setJoints(gltf.accessor(cast<uint8_t>(joints), "VEC4", 5121, 4), gltf.floats(first, "VEC4", 4));
    gltf.primitive()["attributes"]["JOINTS_1"] =
        gltf.accessor(cast<uint8_t>(jointsOfSecond), "VEC4", 5121, 4);
    gltf.primitive()["attributes"]["WEIGHTS_1"] = gltf.floats(second, "VEC4", 4);
    expectOracle(load(), 1e-5);
}

TEST_F(DeformingGltf, WeightsAreMadeToSumToOne)
{
    std::vector<float> scaled = weights;
    for (float& w : scaled)
        w *= 7.0f;
    setJoints(gltf.accessor(cast<uint8_t>(joints), "VEC4", 5121, 4), gltf.floats(scaled, "VEC4", 4));
    expectOracle(load(), 1e-5);
    // Without any, the first joint takes all; negative ones count for nothing.
    setJoints(gltf.accessor(cast<uint8_t>(joints), "VEC4", 5121, 4),
              gltf.floats({0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 4));
    const Scene scene = load();
    for (const shared::Influence& influence : scene.meshes[0].deformation.influences) {
        EXPECT_EQ(influence.joint, 0u);
        EXPECT_EQ(influence.weight, 1.0f);
    }
}

TEST_F(DeformingGltf, VerticesThatAreSplitOrUnwrappedKeepTheirJoints)
{
    gltf.primitive()["attributes"].erase("NORMAL"); // flat: vertices of its own for each triangle
    gltf.primitive()["attributes"].erase("TEXCOORD_0");
    const Scene scene = load();
    EXPECT_TRUE(scene.meshes[0].unwrapped);
    expectOracle(scene, 1e-5);
}

TEST_F(DeformingGltf, NormalsStandOnTheDeformedSurface)
{
    const Scene scene = load();
    Shapes shapes = shapesAtRest(scene);
    // Scales that differ by axis tilt normals away from where the matrix itself would take them.
    shapes.joints[0][0] = shapes.joints[0][1] =
        glm::scale(glm::rotate(glm::mat4(1.0f), 0.7f, glm::vec3(1, 2, 3)), glm::vec3(1, 3, -0.2f)) *
        glm::rotate(glm::mat4(1.0f), 1.0f, glm::vec3(3, 1, 0));
    const auto v = deformedVertices(scene.meshes[0], shapes.joints[0], {});
    for (const shared::Vertex& vertex : v) {
        EXPECT_NEAR(glm::dot(vertex.normal, glm::normalize(v[1].position - v[0].position)), 0.0f, 1e-4f);
        EXPECT_NEAR(glm::dot(vertex.normal, glm::normalize(v[2].position - v[0].position)), 0.0f, 1e-4f);
        EXPECT_NEAR(glm::length(vertex.normal), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::length(glm::vec3(vertex.tangent)), 1.0f, 1e-5f);
    }
    shapes.joints[0][0] = shapes.joints[0][1] = glm::mat4(0.0f); // scaled to nothing
    for (const shared::Vertex& vertex : deformedVertices(scene.meshes[0], shapes.joints[0], {}))
        EXPECT_EQ(glm::length(vertex.normal), 1.0f);
}

TEST_F(DeformingGltf, SkinsOfTheirOwnGiveShapesOfTheirOwn)
{
    gltf.root["nodes"].push_back({{"mesh", 0}, {"skin", 0}});
    gltf.root["nodes"].push_back({{"mesh", 0}, {"skin", 1}});
    gltf.root["nodes"].push_back({{"mesh", 0}});
    gltf.root["skins"].push_back({{"joints", {2, 1}}});
    gltf.root["scenes"] = {{{"nodes", {0, 1, 3, 4, 5}}}};
    const Scene scene = load();
    ASSERT_EQ(scene.objects.size(), 4u);
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.deformed.size(), 2u);
    EXPECT_EQ(scene.objects[0].deformed, scene.objects[1].deformed);
    EXPECT_NE(scene.objects[0].deformed, scene.objects[2].deformed);
    EXPECT_EQ(scene.objects[3].deformed, -1) << "no skin: as it is";
    EXPECT_EQ(scene.skins[1].joints[0].jointFromMesh, glm::mat4(1.0f)) << "no inverse bind matrices";
}

TEST_F(DeformingGltf, InstancesOfASkinnedMeshShareItsShapeEachAtItsOwnPlace)
{
    gltf.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", gltf.floats({0, 0, 0, 7, 8, 9}, "VEC3", 3)}};
    const Scene scene = load();
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.deformed.size(), 1u);
    EXPECT_EQ(glm::vec3(scene.objects[1].worldFromObject[3]), glm::vec3(7, 8, 9));
}

TEST_F(DeformingGltf, DamagedSkinsAreRefused)
{
    const json good = gltf.root;
    const auto damage = [&](const char* pointer, const json& value, const char* part) {
        gltf.root = good;
        gltf.root[json::json_pointer(pointer)] = value;
        SCOPED_TRACE(pointer);
        expectDeformationRefused(part);
    };
    damage("/nodes/0/skin", 3, "skin 3 does not exist");
    damage("/skins/0/joints", {1}, "names joint 1 of skin 0, which has 1");
    damage("/skins/0/joints", {1, 77}, "joint node 77, which is not in the scene");
    damage("/skins/0/joints", {1, 2, 1}, "2 inverse bind matrices for 3 joints");
    damage("/skins/0/inverseBindMatrices", 99, "accessor 99");
    damage("/nodes/2/children", {1}, "its own ancestor");
    damage("/scenes/0/nodes", {0}, "not in the scene");
    gltf.root = good;
    gltf.primitive()["attributes"].erase("WEIGHTS_0");
    expectDeformationRefused("only one of JOINTS_0 and WEIGHTS_0");
    gltf.root = good;
    gltf.primitive()["attributes"]["JOINTS_0"] = gltf.floats(joints, "VEC4", 4);
    expectDeformationRefused("a type that glTF 2.0 does not allow");
    gltf.root = good;
    gltf.primitive()["attributes"]["WEIGHTS_0"] = gltf.floats({1, 0, 0, 0}, "VEC4", 4);
    expectDeformationRefused("1 elements for 4 vertices");
    gltf.primitive()["attributes"]["WEIGHTS_0"] = gltf.floats(std::vector<float>(16, NAN), "VEC4", 4);
    expectDeformationRefused("not finite");
    gltf.root = good;
    gltf.node(1)["scale"] = {1e30, 1e30, 1e30};
    gltf.root["skins"][0]["inverseBindMatrices"] = gltf.floats(std::vector<float>(32, 1e30f), "MAT4", 16);
    expectDeformationRefused("skinned vertices that are not finite");
}

// --- Morph targets

// A quad with two targets: the first, sparse, lifts a corner; the second moves all to the right.
struct MorphingGltf : testing::Test {
    TemporaryFolder folder;
    GltfBuilder gltf;

    explicit MorphingGltf(bool withNormals = true)
    {
        gltf.quad(withNormals);
        const uint8_t corner = 2;
        const float lift[3] = {0, 0, 3};
        const size_t indices = gltf.view(&corner, 1), values = gltf.view(lift, 12);
        gltf.root["accessors"].push_back({{"componentType", 5126},
                                          {"type", "VEC3"},
                                          {"count", 4},
                                          {"sparse",
                                           {{"count", 1},
                                            {"indices", {{"bufferView", indices}, {"componentType", 5121}}},
                                            {"values", {{"bufferView", values}}}}}});
        gltf.primitive()["targets"] = {
            {{"POSITION", gltf.root["accessors"].size() - 1}},
            {{"POSITION", gltf.floats({1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3", 3)}}};
    }
    void animate(const char* interpolation, const std::vector<float>& values)
    {
        gltf.root["animations"] = {
            {{"samplers",
              {{{"input", gltf.floats({1, 3}, "SCALAR", 1)},
                {"output", gltf.floats(values, "SCALAR", 1)},
                {"interpolation", interpolation}}}},
             {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
    }
    Scene load() { return loadGltf(gltf.writeGlb(folder)); }
    std::vector<float> weightsAt(double t)
    {
        const Scene scene = load();
        return shapesAt(scene.skins, scene.deformed, scene.animation, t).weights[0];
    }
};

TEST_F(MorphingGltf, TargetsAddTheirWeightedDeltas)
{
    gltf.root["meshes"][0]["weights"] = {0.5, -2};
    const Scene scene = load();
    const auto rest = deformedVertices(scene.meshes[0], {}, scene.deformed[0].weights);
    for (size_t i = 0; i < rest.size(); ++i) {
        glm::vec3 expected = scene.meshes[0].vertices[i].position + glm::vec3(-2, 0, 0);
        if (scene.meshes[0].vertices[i].position == glm::vec3(1, 1, 0))
            expected.z += 1.5f;
        EXPECT_LT(glm::distance(rest[i].position, expected), 1e-6f);
    }
    EXPECT_EQ(scene.deformed[0].bounds.lower, glm::vec3(-2, 0, 0));
    EXPECT_EQ(scene.deformed[0].bounds.upper, glm::vec3(-1, 1, 1.5f));
    EXPECT_EQ(scene.bounds.upper, glm::vec3(-1, 1, 1.5f));
    gltf.node()["weights"] = {1, 0}; // the node's come before the mesh's
    EXPECT_EQ(load().deformed[0].weights, (std::vector<float>{1, 0}));
}

TEST_F(MorphingGltf, WeightsAreAnimatedInEveryInterpolation)
{
    animate("LINEAR", {0, 1, 4, 0});
    EXPECT_EQ(weightsAt(1.5), (std::vector<float>{1, 0.75f}));
    EXPECT_EQ(weightsAt(0.0), (std::vector<float>{0, 1}));
    animate("STEP", {0, 1, 4, 0});
    EXPECT_EQ(weightsAt(2.9), (std::vector<float>{0, 1}));
    // Cubics are reproduced exactly by their values and slopes (t^3 and -t^2).
    animate("CUBICSPLINE", {3, -2, 1, -1, 3, -2, 27, -6, 27, -9, 27, -6});
    for (const double t : {1.0, 1.4, 2.2, 2.999}) {
        EXPECT_NEAR(weightsAt(t)[0], t * t * t, 1e-4);
        EXPECT_NEAR(weightsAt(t)[1], -t * t, 1e-4);
    }
}

struct FlatMorphingGltf : MorphingGltf {
    FlatMorphingGltf() : MorphingGltf(false) {}
};

TEST_F(FlatMorphingGltf, NormalsThatTheFileLeavesOutFollowTheTarget)
{
    gltf.node()["weights"] = {1, 0.5};
    const Scene scene = load();
    const Mesh& mesh = scene.meshes[0];
    const auto v = deformedVertices(mesh, {}, scene.deformed[0].weights);
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const auto at = [&](size_t k) { return v[mesh.indices[i + k]]; };
        const glm::vec3 normal =
            glm::normalize(glm::cross(at(1).position - at(0).position, at(2).position - at(0).position));
        for (size_t k = 0; k < 3; ++k) {
            EXPECT_LT(glm::distance(at(k).normal, normal), 1e-5f);
            EXPECT_LT(std::abs(glm::dot(glm::vec3(at(k).tangent), normal)), 1e-4f);
        }
    }
}

TEST_F(MorphingGltf, BoundsHoldForWeightsOfEitherSign)
{
    const Scene scene = load();
    std::mt19937 random(3);
    std::uniform_real_distribution<float> any(-3.0f, 3.0f);
    for (int i = 0; i < 50; ++i) {
        const std::vector<float> weights{any(random), any(random)};
        const Bounds box = deformedBounds(scene.meshes[0].deformation.extents, {}, weights);
        for (const shared::Vertex& v : deformedVertices(scene.meshes[0], {}, weights)) {
            EXPECT_TRUE(glm::all(glm::lessThanEqual(box.lower, v.position + 1e-5f)));
            EXPECT_TRUE(glm::all(glm::greaterThanEqual(box.upper, v.position - 1e-5f)));
        }
    }
}

TEST_F(MorphingGltf, DamagedTargetsAreRefused)
{
    const auto refused = [&](const char* part) { expectRefused(gltf.writeGltf(folder), part); };
    const json good = gltf.root;
    gltf.node()["weights"] = {1, 2, 3};
    refused("3 weights for 2 morph targets");
    gltf.root = good;
    gltf.primitive()["targets"][1]["POSITION"] = gltf.floats({1, 0, 0}, "VEC3", 3);
    refused("1 elements for 4 vertices");
    gltf.primitive()["targets"][1]["POSITION"] = 400;
    refused("accessor 400");
    gltf.root = good;
    gltf.root["meshes"][0]["primitives"].push_back(gltf.primitive());
    gltf.primitive(1)["targets"].erase(1);
    refused("primitives of 2 and of 1 morph targets");
    gltf.root = good;
    animate("LINEAR", {0, 1, 4});
    refused("different number of values");
}

TEST_F(MorphingGltf, ThousandsOfTargetsLoadAndMillionsAreRefused)
{
    const json target = gltf.primitive()["targets"][0];
    json& targets = gltf.primitive()["targets"];
    targets = json::array();
    for (int i = 0; i < 5000; ++i)
        targets.push_back(target);
    const Scene scene = load();
    EXPECT_EQ(scene.meshes[0].deformation.extents.targets.size(), 5000u);
    EXPECT_EQ(scene.meshes[0].deformation.deltas.size(), 5000u * scene.meshes[0].vertices.size() / 4);
    // All zero vertices cost the file nothing: 2^16 of them for each of the targets.
    const size_t zeros = gltf.root["accessors"].size();
    gltf.root["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 65536}});
    gltf.primitive()["attributes"] = {{"POSITION", zeros}};
    gltf.root["accessors"].push_back({{"componentType", 5125}, {"type", "SCALAR"}, {"count", 65535}});
    gltf.primitive().erase("indices");
    targets = json::array();
    for (int i = 0; i < 5000; ++i)
        targets.push_back({{"POSITION", zeros}});
    gltf.primitive()["mode"] = 5;
    expectRefused(gltf.writeGltf(folder), "morph targets of more than");
}

} // namespace
} // namespace lumel::scene
