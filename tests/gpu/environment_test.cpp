// Shadows and the environment, in every way of shading.
#include "scene/environment.h"
#include "test_scene.h"

namespace lumel::test {
namespace {

const Shading kWays[] = {Shading::tsl, Shading::forward, Shading::reference};

std::shared_ptr<const scene::Environment> greyEnvironment(float radiance)
{
    Image grey(32, 16, 3);
    std::fill(grey.pixels.begin(), grey.pixels.end(), radiance);
    return std::make_shared<const scene::Environment>(scene::makeEnvironment(grey));
}

std::shared_ptr<const scene::Environment> sky()
{
    static const auto environment = std::make_shared<const scene::Environment>(scene::skyEnvironment());
    return environment;
}

// A ball over the middle of a plane, lit from straight above the plane.
TestScene ballOverPlane(const scene::Light& light)
{
    TestScene s;
    s.add(planeMesh(8), plainMaps());
    s.add(sphereMesh(), plainMaps(),
          glm::translate(glm::mat4(1.0f), {0, 0, 0.6f}) * glm::scale(glm::mat4(1.0f), glm::vec3(0.25f)));
    s.scene.lights = {light};
    return s;
}

scene::Light spotAbove()
{
    scene::Light light;
    light.type = scene::LightType::spot;
    light.position = {0, 0, 3};
    light.direction = {0, 0, -1};
    light.intensity = 30.0f;
    light.innerCone = 0.5f;
    light.outerCone = 0.6f;
    return light;
}

// Red where the camera sees the point.
float radianceAt(const Image& image, const scene::Camera& camera, glm::vec3 point)
{
    const float aspect = float(image.width) / float(image.height);
    const glm::vec4 clip = reversedPerspective(camera.yFov, aspect, camera.nearMetres) *
                           glm::lookAt(camera.eye, camera.target, camera.up) * glm::vec4(point, 1.0f);
    const glm::vec2 place = glm::vec2(clip) / clip.w * 0.5f + 0.5f;
    return *image.at(int(place.x * float(image.width)), int(place.y * float(image.height)));
}

class Environment : public GpuTest {};

TEST_F(Environment, WhatIsUnderABallIsDark)
{
    const scene::Camera camera = cameraAt({0, -3, 0.9f});
    for (const scene::Light& light : {sun({0, 0, -1}), spotAbove()})
        for (const Shading way : kWays) {
            Settings settings = settingsFor(way, {320, 180});
            settings.samples = 8;
            const TestScene s = ballOverPlane(light);
            const Image shaded = shoot(s, camera, settings).radiance;
            settings.shadows = false;
            const Image unshaded = shoot(s, camera, settings).radiance;
            // Within and beyond the ball's radius of the middle; a spot light's shadow is a little larger.
            for (const glm::vec3 inside :
                 {glm::vec3(0, 0, 0), glm::vec3(0.15f, 0, 0), glm::vec3(0, -0.15f, 0)})
                EXPECT_LT(radianceAt(shaded, camera, inside), 0.25f * radianceAt(unshaded, camera, inside));
            for (const glm::vec3 outside :
                 {glm::vec3(0.45f, 0, 0), glm::vec3(-0.6f, 0, 0), glm::vec3(0, -0.5f, 0)})
                EXPECT_NEAR(radianceAt(shaded, camera, outside), radianceAt(unshaded, camera, outside),
                            0.01f * radianceAt(unshaded, camera, outside));
        }
}

TEST_F(Environment, BallsDoNotShadeThemselves)
{
    TestScene s = sphereScene(plainMaps());
    s.scene.lights = {sun({-1, -0.6f, -0.5f})};
    const scene::Camera camera = cameraAt({0.5f, 0.8f, 3});
    for (const uint32_t size : {256u, 2048u}) {
        Settings settings = settingsFor(Shading::forward, {320, 180});
        settings.shadowSize = size;
        const Image on = shoot(s, camera, settings).radiance;
        settings.shadows = false;
        const Image off = shoot(s, camera, settings).radiance;
        const float brightest = *std::max_element(off.pixels.begin(), off.pixels.end());
        int wrong = 0;
        for (size_t i = 0; i < on.pixels.size(); ++i)
            wrong += off.pixels[i] > 0.3f * brightest && on.pixels[i] < 0.98f * off.pixels[i];
        EXPECT_EQ(wrong, 0) << size;
    }
}

TEST_F(Environment, StillViewsLightNothing)
{
    TestScene s = ballOverPlane(sun({0.3f, 0, -1}));
    s.scene.environment = sky();
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    const scene::Camera camera = cameraAt({0, -3, 0.9f});
    EXPECT_GT(renderer.render(camera).lumelsLit, 0u);
    const FrameStats second = renderer.render(camera);
    EXPECT_EQ(second.lumelsLit, 0u);
    EXPECT_FALSE(second.passMs.contains("shadow"));
}

TEST_F(Environment, AShadowFollowsWhatCastsIt)
{
    TestScene s = ballOverPlane(sun({0.3f, 0, -1}));
    s.scene.environment = sky();
    const scene::Camera camera = cameraAt({0, -3, 0.9f});
    const Settings settings = settingsFor(Shading::tsl);
    Renderer renderer(device(), s.scene, s.materials, settings);
    renderer.render(camera);
    const glm::mat4 place =
        glm::translate(glm::mat4(1.0f), {0.3f, 0.1f, 0}) * s.scene.objects[1].worldFromObject;
    renderer.moveObject(1, place);
    EXPECT_GT(renderer.render(camera).lumelsLit, 0u);
    s.scene.objects[1].worldFromObject = place;
    EXPECT_GT(psnr(renderer.readDisplay(), shoot(s, camera, settings).display), 50.0);
    // A changed environment makes everything be lit again.
    Settings brighter = settings;
    brighter.environmentIntensity = 2.0f;
    brighter.environmentRotation = 90.0f;
    renderer.setSettings(brighter);
    EXPECT_GT(renderer.render(camera).lumelsLit, 0u);
    for (uint32_t i = 0; i < FeedbackPass::kCycle; ++i)
        renderer.render(camera); // until the sub-pixel offsets have met every pixel
    EXPECT_GT(psnr(renderer.readDisplay(), shoot(s, camera, brighter).display), 50.0);
    renderer.setEnvironment(std::make_shared<const EnvironmentMap>(device(), nullptr));
    for (uint32_t i = 0; i <= FeedbackPass::kCycle; ++i)
        renderer.render(camera);
    s.scene.environment = nullptr;
    EXPECT_GT(psnr(renderer.readDisplay(), shoot(s, camera, brighter).display), 50.0);
}

TEST_F(Environment, TextureSpaceIsCloseToTheReference)
{
    TestScene s;
    baker::Maps metal = bumpyMaps(64, 0.4f, 300.0f);
    metal.diffuseConstant = glm::vec3(0.0f);
    metal.specularConstant = glm::vec3(0.9f, 0.6f, 0.3f);
    s.add(planeMesh(8), plainMaps(),
          glm::translate(glm::mat4(1.0f), {0, 0, -1}) * glm::scale(glm::mat4(1.0f), glm::vec3(3)));
    s.add(sphereMesh(), metal);
    s.scene.lights = {sun({-1, -1, -1})};
    s.scene.environment = sky();
    const scene::Camera camera = cameraAt({0.5f, 0.8f, 4});
    const Picture reference = shoot(s, camera, settingsFor(Shading::reference));
    EXPECT_GT(psnr(shoot(s, camera, settingsFor(Shading::tsl)).display, reference.display), 33.0);
    EXPECT_GT(psnr(shoot(s, camera, settingsFor(Shading::forward)).display, reference.display), 33.0);
}

// A lobe fitted to sharp ones that point apart is weaker than they are together. What grooves of metal
// reflect of a uniform environment is the same near, where each flank is visible, and far.
TEST_F(Environment, RoughMetalsKeepTheirEnergy)
{
    baker::Maps metal;
    metal.normal = Image(64, 64, 3);
    for (int i = 0; i < 64 * 64; ++i) {
        const float normal[3] = {i % 8 < 4 ? 0.8f : 0.2f, 0.5f, 0.9f};
        std::copy_n(normal, 3, metal.normal.at(i % 64, i / 64));
    }
    metal.powerConstant = 2000.0f;
    metal.specularConstant = glm::vec3(0.9f);
    TestScene s;
    s.add(planeMesh(4), metal);
    s.scene.environment = greyEnvironment(0.5f);
    const float scaleKs = [&] { // how much the fit loses here
        const scene::Reflectance& reflectance = s.materials[0].reflectance;
        return reflectance.at(reflectance.levels() - 1, 0, 0)[baker::kKsR] / 0.9f;
    }();
    EXPECT_LT(scaleKs, 0.7f);
    for (const float distance : {3.0f, 40.0f})
        for (const Shading way : kWays) {
            Settings settings = settingsFor(way, {64, 36});
            const scene::Camera camera = cameraAt({0, 0, distance}, glm::vec3(0), 1.0f / distance);
            const Image picture = shoot(s, camera, settings).radiance;
            const float* middle = picture.at(32, 18);
            EXPECT_NEAR(middle[0], 0.45f, 0.04f) << distance << " " << int(way);
        }
}

} // namespace
} // namespace lumel::test
