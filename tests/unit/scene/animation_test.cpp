#include "gltf_builder.h"
#include "scene/animation.h"
#include <numbers>

namespace lumel::scene {
namespace {

using nlohmann::json;

constexpr float kPi = float(std::numbers::pi);

void expectNear(glm::vec3 a, glm::vec3 b, float tolerance = 1e-5f)
{
    EXPECT_LT(glm::distance(a, b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

Track vectors(Interpolation interpolation, std::vector<glm::vec4> values)
{
    return {interpolation, {1.0f, 2.0f, 4.0f}, std::move(values)};
}

TEST(Track, LinearGoesStraightAndHoldsItsEnds)
{
    const Track track = vectors(Interpolation::linear, {{0, 0, 0, 0}, {2, 4, 6, 0}, {2, 4, -6, 0}});
    expectNear(sampleVector(track, 1.5), {1, 2, 3});
    expectNear(sampleVector(track, 3.5), {2, 4, -3});
    expectNear(sampleVector(track, 2.0), {2, 4, 6});
    expectNear(sampleVector(track, -7.0), {0, 0, 0});
    expectNear(sampleVector(track, 99.0), {2, 4, -6});
}

TEST(Track, StepKeepsTheKeyBefore)
{
    const Track track = vectors(Interpolation::step, {{1, 0, 0, 0}, {2, 0, 0, 0}, {3, 0, 0, 0}});
    EXPECT_EQ(sampleVector(track, 1.999).x, 1.0f);
    EXPECT_EQ(sampleVector(track, 2.0).x, 2.0f);
    EXPECT_EQ(sampleVector(track, 3.999).x, 2.0f);
    EXPECT_EQ(sampleVector(track, 4.0).x, 3.0f);
}

// A cubic is reproduced exactly from its values and slopes, whatever the distance of the keys.
TEST(Track, CubicSplineIsExactForCubics)
{
    const auto value = [](float t) { return t * t * t - 2.0f * t * t + 3.0f; };
    const auto slope = [](float t) { return 3.0f * t * t - 4.0f * t; };
    Track track{Interpolation::cubicSpline, {1.0f, 2.0f, 4.0f}, {}};
    for (const float t : track.seconds)
        track.values.insert(track.values.end(),
                            {glm::vec4(slope(t)), glm::vec4(value(t)), glm::vec4(slope(t))});
    for (const float t : {1.0f, 1.3f, 2.0f, 2.5f, 3.9f, 4.0f})
        EXPECT_NEAR(sampleVector(track, t).y, value(t), 1e-4f) << t;
    EXPECT_NEAR(sampleVector(track, 0.0).x, value(1.0f), 1e-5f);
    EXPECT_NEAR(sampleVector(track, 9.0).x, value(4.0f), 1e-4f);
}

TEST(Track, RotationsTakeTheShortWayAtConstantSpeed)
{
    const auto about = [](float angle) {
        return glm::vec4(0.0f, std::sin(angle / 2), 0.0f, std::cos(angle / 2));
    };
    // The second is stored with the other sign: the same rotation.
    const Track track{Interpolation::linear, {0.0f, 1.0f}, {about(0.0f), -about(kPi / 2)}};
    for (const float t : {0.0f, 0.25f, 0.5f, 0.75f, 1.0f}) {
        const glm::vec3 turned = sampleRotation(track, t) * glm::vec3(0, 0, 1);
        expectNear(turned, {std::sin(t * kPi / 2), 0.0f, std::cos(t * kPi / 2)});
    }
}

// A parent that moves and turns, a child that moves, and below it what only they move.
struct AnimatedGltf : testing::Test {
    TemporaryFolder folder;
    GltfBuilder gltf;

    AnimatedGltf()
    {
        gltf.quad();
        gltf.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}}};
        gltf.root["extensionsUsed"] = {"KHR_lights_punctual"};
        gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = {
            {{"type", "spot"}, {"spot", json::object()}}};
        gltf.root["nodes"] = {{{"mesh", 0}, {"translation", {5, 0, 0}}, {"children", {1, 2}}},
                              {{"camera", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 3, 1}}},
                              {{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}},
                              {{"mesh", 0}}};
        gltf.root["scenes"] = {{{"nodes", {0, 3}}}};
        const float half = std::sqrt(0.5f);
        sampler("LINEAR", {0, 2}, gltf.floats({0, 0, 0, 0, 8, 0}, "VEC3", 3));
        sampler("STEP", {0, 1}, gltf.floats({0, 0, 0, 1, 0, half, 0, half}, "VEC4", 4));
        channel(0, 0, "translation");
        channel(1, 0, "rotation");
    }
    void sampler(const char* interpolation, const std::vector<float>& seconds, size_t output)
    {
        gltf.root["animations"][0]["samplers"].push_back({{"input", gltf.floats(seconds, "SCALAR", 1)},
                                                          {"output", output},
                                                          {"interpolation", interpolation}});
    }
    void channel(int sampler, int node, const char* path)
    {
        gltf.root["animations"][0]["channels"].push_back(
            {{"sampler", sampler}, {"target", {{"node", node}, {"path", path}}}});
    }
    Scene load() { return loadGltf(gltf.writeGlb(folder)); }
    void expectAnimationRefused(const std::string& part) { expectRefused(gltf.writeGltf(folder), part); }
};

TEST_F(AnimatedGltf, MovesObjectsCamerasAndLightsThroughTheTree)
{
    const Scene scene = load();
    EXPECT_EQ(scene.animation.seconds, 2.0);
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[1].node, -1) << "stands still";
    expectNear(scene.objects[0].worldFromObject[3], {5, 0, 0});
    const Pose before = poseAt(scene.animation, 0.5), after = poseAt(scene.animation, 1.5);
    expectNear(before[size_t(scene.objects[0].node)][3], {0, 2, 0});
    expectNear(moved(scene.cameras[0], before).eye, {0, 2, 3});
    // Turned by a quarter about +y: +z goes to +x.
    const Camera camera = moved(scene.cameras[0], after);
    expectNear(camera.eye, {3, 6, 0});
    expectNear(glm::normalize(camera.target - camera.eye), {-1, 0, 0});
    EXPECT_NEAR(glm::distance(camera.target, camera.eye),
                glm::distance(scene.cameras[0].target, scene.cameras[0].eye), 1e-4f);
    const Light light = moved(scene.lights[0], after);
    expectNear(light.position, {0, 6, 0});
    expectNear(light.direction, {-1, 0, 0});
}

TEST_F(AnimatedGltf, InstancesKeepTheirPlacesUnderANodeThatMoves)
{
    gltf.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", gltf.floats({1, 0, 0, 0, 0, 3}, "VEC3", 3)}};
    const Scene scene = load();
    ASSERT_EQ(scene.objects.size(), 3u);
    const Pose pose = poseAt(scene.animation, 0.5);
    const auto placeOf = [&](const Object& o) {
        return glm::vec3((pose[size_t(o.node)] * o.nodeFromObject)[3]);
    };
    expectNear(placeOf(scene.objects[0]), {1, 2, 0});
    expectNear(placeOf(scene.objects[1]), {0, 2, 3});
}

TEST_F(AnimatedGltf, StartsAgainAfterItsEndAndBeforeItsStart)
{
    const Scene scene = load();
    for (const double t : {0.0, 0.3, 1.7})
        for (const double rounds : {-3.0, 1.0, 1000.0}) {
            const Pose once = poseAt(scene.animation, t);
            const Pose again = poseAt(scene.animation, t + rounds * scene.animation.seconds);
            expectNear(once[0][3], again[0][3], 1e-4f);
        }
}

TEST_F(AnimatedGltf, NormalizedIntegersAreRotations)
{
    const std::vector<int16_t> values{0, 0, 0, 32767, 0, 32767, 0, 0};
    const size_t accessor = gltf.accessor(values, "VEC4", 5122, 4);
    gltf.root["accessors"][accessor]["normalized"] = true;
    gltf.root["animations"][0]["samplers"][1]["output"] = accessor;
    const Scene scene = load();
    const Pose pose = poseAt(scene.animation, 1.0); // half a turn about +y
    expectNear(glm::vec3(pose[0][0]), {-1, 0, 0}, 1e-4f);
}

TEST_F(AnimatedGltf, WhatIsScaledToNothingCanStillBeInverted)
{
    sampler("LINEAR", {0, 2}, gltf.floats({1, 1, 1, 0, 0, 0}, "VEC3", 3));
    channel(2, 0, "scale");
    const Scene scene = load();
    const glm::mat4 world = poseAt(scene.animation, std::nextafter(2.0, 0.0))[0];
    EXPECT_NE(glm::determinant(glm::mat3(world)), 0.0f);
    EXPECT_TRUE(std::isfinite(glm::inverse(world)[0][0]));
}

TEST_F(AnimatedGltf, ChannelsWithoutANodeAndOfWeightsAreLeftOut)
{
    gltf.root["animations"][0]["channels"].push_back({{"sampler", 0}, {"target", {{"path", "translation"}}}});
    channel(0, 3, "weights");
    const Scene scene = load();
    EXPECT_EQ(scene.objects[1].node, -1);
}

TEST_F(AnimatedGltf, DamagedOnesAreRefused)
{
    json& animation = gltf.root["animations"][0];
    const json good = animation;
    const auto damage = [&](const char* where, size_t i, const char* key, const json& value,
                            const char* part) {
        animation = good;
        animation[where][i][key] = value;
        expectAnimationRefused(part);
    };
    animation["channels"] = "none";
    expectAnimationRefused("no channels");
    animation = 7;
    expectAnimationRefused("no channels");
    damage("channels", 0, "sampler", 7, "sampler 7 does not exist");
    damage("channels", 0, "target", {{"node", 44}, {"path", "translation"}}, "node 44");
    damage("channels", 0, "target", {{"node", 1}, {"path", "translation"}}, "has a matrix");
    damage("samplers", 0, "interpolation", "WOBBLE", "unknown interpolation");
    damage("samplers", 0, "interpolation", "CUBICSPLINE", "different number of values");
    damage("samplers", 0, "input", 99, "accessor 99");
    damage("samplers", 0, "output", good["samplers"][1]["output"], "wrong type");
    damage("samplers", 0, "input", gltf.floats({1, 1}, "SCALAR", 1), "do not increase");
    damage("samplers", 0, "input", gltf.floats({0, 1, 2}, "SCALAR", 1), "different number of values");
    damage("samplers", 0, "output", gltf.floats({0, 0, 0, NAN, 0, 0}, "VEC3", 3), "not finite");
}

} // namespace
} // namespace lumel::scene
