// Lights, shadows, and what moves.
#include "subject.h"

namespace lumel::test {
namespace {

// Two balls on a floor.
void ballsOnAFloor(Subject& subject)
{
    subject.camera({1.5f, 2.2f, 4.0f}, {0, 0.1f, 0});
    const json floor = subject.material(patches(16, 8, 1));
    subject.place(sheet(8), floor,
                  {{"rotation", {-0.70710678, 0, 0, 0.70710678}}, {"scale", {2.2, 2.2, 2.2}}});
    subject.place(ball(48, 96), subject.material(patches(16, 8, 2)),
                  {{"translation", {-0.6, 0.6, 0.2}}, {"scale", {0.5, 0.5, 0.5}}});
    subject.place(ball(48, 96), subject.material(patches(16, 8, 3)),
                  {{"translation", {0.8, 0.7, -0.3}}, {"scale", {0.4, 0.6, 0.3}}});
}

const json kSun = {{"type", "directional"}, {"intensity", 3.0}, {"color", {1.0, 0.85, 0.7}}};

TEST_F(Judge, Sun)
{
    Subject subject(false);
    subject.light(kSun, {2, 3, 1.5f}, {0, 0, 0});
    ballsOnAFloor(subject);
    expectAgreement("sun", subject, {.shadows = true});
}

TEST_F(Judge, PointLights)
{
    Subject subject(false);
    subject.light({{"type", "point"}, {"intensity", 9.0}, {"color", {1.0, 0.6, 0.4}}, {"range", 3.5}},
                  {-1, 2.0f, 1.2f}, {0, 0, 0});
    subject.light({{"type", "point"}, {"intensity", 3.0}, {"color", {0.4, 0.6, 1.0}}}, {1.6f, 1.5f, 1.0f},
                  {0, 0, 0});
    ballsOnAFloor(subject);
    expectAgreement("point-lights", subject);
}

TEST_F(Judge, SpotLights)
{
    Subject subject(false);
    subject.light({{"type", "spot"},
                   {"intensity", 40.0},
                   {"color", {1.0, 0.8, 0.5}},
                   {"range", 8.0},
                   {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.45}}}},
                  {1.5f, 3.2f, 1.5f}, {-0.2f, 0, 0});
    subject.light(
        {{"type", "spot"}, {"intensity", 12.0}, {"color", {0.4, 0.6, 1.0}}, {"spot", json::object()}},
        {-2, 2.5f, 1.0f}, {0, 0, 0});
    ballsOnAFloor(subject);
    expectAgreement("spot-lights", subject, {.shadows = true});
}

// The holes of a cut-out let light through, and a blended sheet stops none.
TEST_F(Judge, ShadowsOfCutOuts)
{
    Subject subject(false);
    subject.camera({1.5f, 2.2f, 4.0f}, {0, 0.1f, 0});
    subject.light(kSun, {1.0f, 3, 0.5f}, {0, 0, 0});
    subject.place(sheet(8), subject.material(patches(16, 8, 1)),
                  {{"rotation", {-0.70710678, 0, 0, 0.70710678}}, {"scale", {2.2, 2.2, 2.2}}});
    json leaf = subject.material(holes(64, 8, 3));
    leaf["doubleSided"] = true;
    leaf["alphaMode"] = "MASK";
    subject.place(
        sheet(), leaf,
        {{"rotation", {-0.6, 0.1, 0, 0.79}}, {"translation", {-0.8, 1.0, 0}}, {"scale", {0.8, 0.8, 0.8}}});
    leaf["alphaMode"] = "BLEND";
    subject.place(
        sheet(), leaf,
        {{"rotation", {-0.6, -0.1, 0, 0.79}}, {"translation", {1.0, 1.0, 0}}, {"scale", {0.8, 0.8, 0.8}}});
    expectAgreement("cut-out-shadows", subject, {.shadows = true});
}

// A channel of an animation with one key per second.
void animate(Subject& subject, int node, const char* path, const std::vector<float>& values, const char* type,
             size_t components, const char* interpolation = "LINEAR")
{
    auto& gltf = subject.gltf;
    json& animation = gltf.root["animations"][0];
    const size_t elements = values.size() / components;
    size_t keys = std::string(path) == "weights" ? 2 : elements; // two targets' weights, two keys
    if (std::string(interpolation) == "CUBICSPLINE")
        keys = elements / 3;
    std::vector<float> times;
    for (size_t i = 0; i < keys; ++i)
        times.push_back(float(i));
    animation["samplers"].push_back({{"input", gltf.floats(times, "SCALAR", 1)},
                                     {"output", gltf.floats(values, type, components)},
                                     {"interpolation", interpolation}});
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", path}}}});
}

TEST_F(Judge, MovingNodes)
{
    Subject subject;
    json material = subject.material(patches(64, 8, 1));
    material["normalTexture"] = {{"index", subject.texture(bumps(64, 2))}};
    const int node = subject.place(ball(), material, {{"scale", {0.8, 0.8, 0.8}}});
    animate(subject, node, "rotation", {0, 0, 0, 1, 0.5f, 0.5f, 0.5f, 0.5f}, "VEC4", 4);
    animate(subject, node, "translation", {0, 0, 0, 0, 0, 0, 0, 0.5f, 0, 1, 0, 0, 0.4f, 0.3f, 0.5f, 0, 0, 0},
            "VEC3", 3, "CUBICSPLINE");
    animate(subject, node, "scale", {0.7f, 0.9f, 0.8f, 1, 1, 1}, "VEC3", 3, "STEP");
    expectAgreement("moving-nodes", subject, {.seconds = 0.6});
}

// A ball on two joints, of which the lower one moves and the upper one turns. across: scale of both along x.
void skin(const char* name, float across)
{
    Subject subject;
    auto& gltf = subject.gltf;
    json material = subject.material(patches(64, 16, 1));
    material["normalTexture"] = {{"index", subject.texture(bumps(64, 2))}};
    Shape shape = ball(32, 64);
    std::vector<uint8_t> joints;
    std::vector<float> weights;
    for (const glm::vec3 p : shape.positions) {
        const float upper = glm::smoothstep(-0.7f, 0.7f, p.y);
        for (const int i : {0, 1, 0, 0})
            joints.push_back(uint8_t(i));
        for (const float w : {1.0f - upper, upper, 0.0f, 0.0f})
            weights.push_back(w);
    }
    const int mesh = subject.mesh(shape, subject.add(material));
    json& attributes = gltf.root["meshes"][size_t(mesh)]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = gltf.accessor(joints, "VEC4", 5121, 4);
    attributes["WEIGHTS_0"] = gltf.floats(weights, "VEC4", 4);
    const int skinned = subject.place(mesh, {{"skin", 0}, {"translation", {50, 0, 0}}}); // to be ignored
    const int lower = skinned + 1, upper = skinned + 2;
    gltf.root["nodes"].push_back(
        {{"children", {upper}}, {"translation", {0, -0.5, 0}}, {"scale", {across, 1.0, 0.7}}});
    gltf.root["nodes"].push_back({{"translation", {0, 0.5, 0}}});
    gltf.root["scenes"][0]["nodes"].push_back(lower);
    // Joints stand at y = -0.5 and 0.
    gltf.root["skins"] = {
        {{"joints", {lower, upper}},
         {"inverseBindMatrices", gltf.floats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.5f, 0, 1,
                                              1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,    0, 1},
                                             "MAT4", 16)}}};
    animate(subject, lower, "translation", {0, -0.5f, 0, 0.3f, -0.6f, -0.2f}, "VEC3", 3);
    animate(subject, upper, "rotation", {0, 0, 0, 1, 0, 0, 0.70710678f, 0.70710678f}, "VEC4", 4);
    expectAgreement(name, subject, {.seconds = 0.7});
}

TEST_F(Judge, Skin)
{
    skin("skin", 0.9f);
}

TEST_F(Judge, SkinThatMirrors)
{
    skin("skin-mirrored", -0.9f);
}

TEST_F(Judge, Morph)
{
    Subject subject;
    auto& gltf = subject.gltf;
    json material = subject.material(patches(64, 16, 1));
    material["normalTexture"] = {{"index", subject.texture(bumps(64, 2))}};
    const Shape shape = ball(32, 64);
    const int mesh = subject.mesh(shape, subject.add(material));
    json& primitive = gltf.root["meshes"][size_t(mesh)]["primitives"][0];
    // Flattened, with the normals and tangents that go with it, and moved aside.
    std::vector<float> positions, normals, tangents, aside;
    for (size_t i = 0; i < shape.positions.size(); ++i) {
        const glm::vec3 n = shape.normals[i];
        const glm::vec3 flatNormal = glm::normalize(n / glm::vec3(1.0f, 0.5f, 1.0f));
        const glm::vec3 dp(0.0f, -0.5f * n.y, 0.0f), dn = flatNormal - n, dt(0.0f);
        for (int c = 0; c < 3; ++c) {
            positions.push_back(dp[c]);
            normals.push_back(dn[c]);
            tangents.push_back(dt[c]);
            aside.push_back(c == 0 ? 0.4f : 0.0f);
        }
    }
    const std::vector<float> zero(aside.size(), 0.0f);
    primitive["targets"] = {{{"POSITION", gltf.floats(positions, "VEC3", 3)},
                             {"NORMAL", gltf.floats(normals, "VEC3", 3)},
                             {"TANGENT", gltf.floats(tangents, "VEC3", 3)}},
                            {{"POSITION", gltf.floats(aside, "VEC3", 3)},
                             {"NORMAL", gltf.floats(zero, "VEC3", 3)},
                             {"TANGENT", gltf.floats(zero, "VEC3", 3)}}};
    const int node = subject.place(mesh);
    animate(subject, node, "weights", {0.0f, 0.0f, 1.0f, 0.8f}, "SCALAR", 1);
    expectAgreement("morph", subject, {.seconds = 0.8});
}

} // namespace
} // namespace lumel::test
