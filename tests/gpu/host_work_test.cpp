// What frames make the CPU do: no pipeline is created in any, and each counts its waits and uploads.
#include "test_scene.h"
#include <algorithm>

namespace lumel::test {
namespace {

constexpr glm::uvec2 kSize{64, 36};

scene::Light spotAt(glm::vec3 position)
{
    scene::Light light;
    light.type = scene::LightType::spot;
    light.position = position;
    light.direction = glm::normalize(-position);
    light.intensity = 20.0f;
    light.outerCone = 0.5f;
    return light;
}

scene::Light pointAt(glm::vec3 position)
{
    scene::Light light;
    light.type = scene::LightType::point;
    light.position = position;
    return light;
}

// An opaque ball, one with vertex colours, and a masked and a blended sheet, with a sun, a spot and a point
// light.
TestScene mixedScene()
{
    TestScene s;
    s.add(sphereMesh(), bumpyMaps(64, 0.5f, 60.0f));
    scene::Mesh coloured = sphereMesh();
    coloured.colours.resize(coloured.vertices.size(), glm::vec4(0.8f, 0.4f, 0.2f, 1.0f));
    s.add(std::move(coloured), plainMaps(), glm::translate(glm::mat4(1.0f), {2.0f, 0.0f, 0.0f}));
    s.add(planeMesh(), plainMaps(), glm::translate(glm::mat4(1.0f), {-2.0f, 0.0f, 0.0f}));
    s.scene.materials.back().alphaMode = scene::AlphaMode::mask;
    s.add(planeMesh(), plainMaps(), glm::translate(glm::mat4(1.0f), {0.0f, 0.0f, 1.5f}));
    s.scene.materials.back().alphaMode = scene::AlphaMode::blend;
    s.scene.lights = {sun({0.3f, -0.6f, -1.0f}), spotAt({0, 2, 3}), pointAt({-1, 1, 2})};
    return s;
}

scene::Camera orbitAt(int frame)
{
    const float angle = glm::radians(3.0f * float(frame));
    return cameraAt({5.0f * std::sin(angle), 1.0f, 5.0f * std::cos(angle)});
}

class HostWorkTest : public GpuTest {};

TEST_F(HostWorkTest, FramesWithMovingLightsAndABudgetCreateNoPipeline)
{
    const TestScene s = mixedScene();
    Settings settings = settingsFor(Shading::tsl, kSize);
    settings.budgetMs = 40.0;
    Renderer renderer(device(), s.scene, s.materials, settings);
    for (int i = 0; i < 100; ++i) {
        const float turn = 0.1f * float(i);
        renderer.setLights({sun({0.5f * std::sin(turn), -0.6f, -1.0f}), spotAt({2.0f * std::sin(turn), 2, 3}),
                            pointAt({std::cos(turn), 1, 2})});
        renderer.moveObject(0, glm::translate(glm::mat4(1.0f), {0.0f, 0.1f * std::sin(turn), 0.0f}));
        EXPECT_EQ(renderer.render(orbitAt(i)).hostWork.pipelinesCreated, 0u) << "frame " << i;
    }
}

TEST_F(HostWorkTest, FramesAfterChangesCreateNoPipeline)
{
    const TestScene s = mixedScene();
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl, kSize));
    std::vector<Settings> changes(10, settingsFor(Shading::tsl, kSize));
    changes[1].shading = Shading::forward;
    changes[2].shading = Shading::reference;
    changes[2].samples = 2;
    changes[3].msaa = 4;
    changes[4].filter = DrawFilter::bilinear;
    changes[5].view = View::normal;
    changes[6].view = View::pool;
    changes[7].shadows = false;
    changes[8].toneMap = ToneMap::aces;
    changes[8].lumelBudget = 1000;
    changes[9].shading = Shading::forward;
    changes[9].forwardAnisotropy = 4;
    const std::vector<std::vector<scene::Light>> lights = {
        s.scene.lights, {}, {pointAt({1, 1, 2})}, {sun({0, -1, -1})}, std::vector(40, pointAt({1, 1, 2}))};
    for (size_t i = 0; i < changes.size(); ++i) {
        renderer.setSettings(changes[i]);
        for (size_t k = 0; k < lights.size(); ++k) {
            renderer.setLights(lights[k]);
            EXPECT_EQ(renderer.render(orbitAt(int(i))).hostWork.pipelinesCreated, 0u)
                << "settings " << i << ", lights " << k;
        }
    }
}

TEST_F(HostWorkTest, AStillViewWaitsOnceAndUploadsTheViewOnly)
{
    const TestScene s = sphereScene(plainMaps());
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    const FrameStats first = renderer.render(orbitAt(0));
    EXPECT_GE(first.hostWork.waits, 2u) << "for the feedback, then for the frame";
    EXPECT_GT(first.hostWork.uploadedBytes, sizeof(shared::View));
    FrameStats still;
    for (int i = 0; i < 40; ++i)
        still = renderer.render(orbitAt(0));
    ASSERT_TRUE(renderer.settled());
    EXPECT_EQ(still.hostWork.waits, 1u);
    EXPECT_LT(still.hostWork.uploadedBytes, first.hostWork.uploadedBytes);
}

TEST_F(HostWorkTest, AReferenceOfManySamplesWaitsLessThanOnceASample)
{
    const TestScene s = sphereScene(plainMaps());
    Settings settings = settingsFor(Shading::reference, kSize);
    settings.samples = 256;
    Renderer renderer(device(), s.scene, s.materials, settings);
    renderer.render(orbitAt(0)); // compiles
    EXPECT_LT(renderer.render(orbitAt(0)).hostWork.waits, 128u);
}

// Timestamps that a device takes too early or too late leave out most of the frame.
TEST_F(HostWorkTest, PassTimesMakeUpTheFrame)
{
    const TestScene s = sphereScene(bumpyMaps(256, 1.0f, 100.0f));
    Settings settings = settingsFor(Shading::tsl, {640, 360});
    settings.refreshShare = 1.0f; // light in every frame
    settings.tolerance = 0.0f;
    Renderer renderer(device(), s.scene, s.materials, settings);
    std::vector<double> shares;
    for (int i = 0; i < 15; ++i) {
        const FrameStats stats = renderer.render(orbitAt(i));
        double sum = 0.0;
        for (const auto& [name, ms] : stats.passMs)
            sum += ms;
        EXPECT_LE(sum, stats.ms);
        shares.push_back(sum / stats.ms);
    }
    std::ranges::nth_element(shares, shares.begin() + 7);
    // A GPU is done with so small a frame before the CPU has described it.
    if (device().properties().deviceType == vk::PhysicalDeviceType::eCpu) {
        EXPECT_GT(shares[7], 0.5);
    }
}

} // namespace
} // namespace lumel::test
