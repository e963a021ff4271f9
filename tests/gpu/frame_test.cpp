// The whole frame, rendered with validation on: every test ends by checking that validation said nothing.
#include "core/compare.h"
#include "shared/shading.h"
#include "shared/tonemap.h"
#include "test_scene.h"
#include <numeric>

using namespace lumel;
using namespace lumel::test;

using FrameTest = GpuTest;

TEST_F(FrameTest, ForwardPixelEqualsTheSharedFormulaInCpp)
{
    TestScene s;
    baker::Maps maps = plainMaps({0.3f, 0.2f, 0.1f}, 50.0f);
    maps.specularConstant = {0.5f, 0.4f, 0.3f};
    s.add(planeMesh(), maps);
    s.scene.lights = {sun({-0.3f, 0.2f, -1.0f})};
    const scene::Camera camera = cameraAt({0.0f, 0.0f, 4.0f});
    Settings settings = settingsFor(Shading::forward, {65, 65}); // odd: the centre pixel looks along -z
    settings.msaa = 1;
    const Picture picture = shoot(s, camera, settings);

    const auto texel = s.materials[0].reflectance.at(0, 0, 0);
    ASSERT_NE(texel[baker::kSxy], 0.0f) << "axes matter";
    const glm::vec3 covariance(texel[baker::kSxx], texel[baker::kSxy], texel[baker::kSyy]);
    const auto surface =
        shared::reflectanceTowards({.lobe = shared::makeLobe({0, 0, 1}, covariance),
                                    .macroNormal = {0, 0, 1},
                                    .specular = shared::specularStrength(maps.specularConstant, covariance),
                                    .f0 = maps.specularConstant,
                                    .baseVariance = shared::baseVariance(covariance),
                                    .diffuse = maps.diffuseConstant},
                                   {0, 0, 1});
    const glm::vec3 l = -s.scene.lights[0].direction;
    const glm::vec3 sky(0.04f * 3.0f);
    const glm::vec3 expected = shared::reflectLight(surface, l, {0, 0, 1}, glm::vec3(3.0f)) +
                               shared::reflectAmbient(surface, sky, sky / 3.0f);
    const float* pixel = picture.radiance.at(32, 32);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(pixel[c], expected[c], 0.003f * expected[c]) << "channel " << c;
    const glm::vec3 shown = shared::displayColour({pixel[0], pixel[1], pixel[2]}, 1.0f);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(picture.display.at(32, 32)[c], shown[c], 0.6f / 255.0f) << "channel " << c;
}

TEST_F(FrameTest, TextureSpaceAndForwardAgreeWithTheReferenceOnSmoothSurfaces)
{
    const TestScene s = sphereScene(plainMaps());
    const scene::Camera camera = cameraAt({0.5f, 0.5f, 3.5f});
    const Picture reference = shoot(s, camera, settingsFor(Shading::reference));
    const Picture tsl = shoot(s, camera, settingsFor(Shading::tsl));
    const Picture forward = shoot(s, camera, settingsFor(Shading::forward));
    EXPECT_GT(tsl.stats.objectsTsl, 0u);
    EXPECT_EQ(forward.stats.objectsTsl, 0u);
    EXPECT_GT(psnr(tsl.display, reference.display), 36.0);
    EXPECT_GT(psnr(forward.display, reference.display), 36.0);
}

TEST_F(FrameTest, FarRoughSurfacesKeepTheReferencesBrightness)
{
    const TestScene s = sphereScene(bumpyMaps(512, 0.7f, 200.0f));
    const scene::Camera camera = cameraAt({0.0f, 0.0f, 18.0f});
    const auto mean = [](const Image& image) {
        double sum = 0.0;
        for (const float v : image.pixels)
            sum += v;
        return sum / double(image.pixels.size());
    };
    const Picture reference = shoot(s, camera, settingsFor(Shading::reference));
    const Picture tsl = shoot(s, camera, settingsFor(Shading::tsl));
    EXPECT_NEAR(mean(tsl.radiance) / mean(reference.radiance), 1.0, 0.05);
    EXPECT_GT(psnr(tsl.display, reference.display), 35.0);
}

TEST_F(FrameTest, TheSameSceneGivesTheSameBits)
{
    const TestScene s = sphereScene(bumpyMaps(256, 1.0f, 100.0f));
    const scene::Camera camera = cameraAt({1.0f, 0.5f, 3.0f});
    for (const Shading shading : {Shading::tsl, Shading::forward}) {
        const Picture first = shoot(s, camera, settingsFor(shading));
        const Picture second = shoot(s, camera, settingsFor(shading));
        EXPECT_EQ(first.radiance.pixels, second.radiance.pixels);
    }
}

TEST_F(FrameTest, EverySurfacePixelIsLit)
{
    // White in a bright world: a hole, an unlit lumel or a black gutter would be far darker.
    baker::Maps maps = plainMaps(glm::vec3(0.9f));
    maps.specularConstant = glm::vec3(0.0f);
    TestScene s = sphereScene(maps);
    s.scene.lights = {sun({0, 0, -1}), sun({0, 0, 1}),  sun({1, 0, 0}),
                      sun({-1, 0, 0}), sun({0, -1, 0}), sun({0, 1, 0})};
    for (const float distance : {1.5f, 3.0f, 10.0f, 60.0f}) {
        const auto shown = [&](Shading shading) {
            return shoot(s, cameraAt({0.0f, 0.3f * distance, distance}), multisampled(shading));
        };
        const Picture tsl = shown(Shading::tsl), forward = shown(Shading::forward);
        for (size_t i = 0; i < tsl.radiance.pixels.size(); ++i)
            ASSERT_NEAR(tsl.radiance.pixels[i], forward.radiance.pixels[i], 0.2f) << "distance " << distance;
    }
}

TEST_F(FrameTest, AFacingQuadGetsTheAnalyticLevel)
{
    // 1024 lumels (512 texels) across two metres; at distance d the picture's 256 pixels span 2 d tan(fov /
    // 2) metres.
    TestScene s;
    s.add(planeMesh(), bumpyMaps(512, 1.0f, 100.0f));
    s.scene.lights = {sun({0, 0, -1})};
    for (int i = 0; i < 20; ++i) {
        const float distance = 3.0f * std::pow(1.25f, float(i)); // from 2.8 on the whole quad is in view
        const float metresPerPixel = 2.0f * distance * std::tan(0.35f) / 256.0f;
        const float level = std::max(0.0f, std::log2(512.0f * metresPerPixel));
        // The whole quad is in view at one level: all its tiles are lit, and whole coarser MIPs derived.
        Settings settings = settingsFor(Shading::tsl, {256, 256});
        settings.levelOffset = 0.0f;
        settings.lumelsPerPixel = 64.0f;
        Renderer renderer(device(), s.scene, s.materials, settings);
        const FrameStats stats = renderer.render(cameraAt({0.0f, 0.0f, distance}));
        const auto side = size_t(1024) >> size_t(level);
        if (1024.0f * std::exp2(-level) < tsl::kLeave) {
            EXPECT_EQ(stats.objectsTsl, 0u) << "so small that it has left texture space";
            continue;
        }
        // Three MIPs coarser there is something to fall back on: a 64th, at least a tile; and the tail.
        EXPECT_GE(stats.lumelsLit, side * side) << "distance " << distance << ", level " << level;
        EXPECT_LE(stats.lumelsLit, side * side + std::max<size_t>(side * side / 64, 64) + 64)
            << "distance " << distance << ", level " << level;
    }
}

TEST_F(FrameTest, NoFinerMipThanIsDrawnIsLit)
{
    TestScene s;
    s.add(planeMesh(), bumpyMaps(512, 1.0f, 100.0f));
    s.scene.lights = {sun({0, 0, -1})};
    Settings settings = settingsFor(Shading::tsl, {256, 256});
    settings.levelOffset = 0.0f;
    // As in the test before: levels a little above whole ones, whose finer neighbour has four times the
    // lumels.
    for (const float level : {1.03f, 1.06f, 1.09f}) {
        const float distance = std::exp2(level) / 512.0f * 256.0f / (2.0f * std::tan(0.35f));
        Renderer renderer(device(), s.scene, s.materials, settings);
        EXPECT_LE(renderer.render(cameraAt({0.0f, 0.0f, distance})).lumelsLit, 512u * 512u * 65u / 64u + 64u)
            << "level " << level;
    }
}

TEST_F(FrameTest, AFloorMarksSeveralLevelsAndOnlyWhatIsSeen)
{
    TestScene s;
    s.add(planeMesh(8), bumpyMaps(512, 1.0f, 100.0f),
          glm::rotate(glm::mat4(1.0f), -shared::kPi / 2, glm::vec3(1, 0, 0)) *
              glm::scale(glm::mat4(1.0f), glm::vec3(8)));
    s.scene.lights = {sun({0, -1, -1})};
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl, {160, 90}));
    const FrameStats stats = renderer.render(cameraAt({0.0f, 0.4f, 7.0f}, {0.0f, 0.0f, 0.0f}));
    EXPECT_GT(stats.lumelsLit, 0u);
    EXPECT_LT(stats.lumelsLit, size_t(1024) * 1024 / 4); // the finest level whole would be a million
}

TEST_F(FrameTest, AStillViewLightsNothingTwice)
{
    const TestScene s = sphereScene(bumpyMaps(256, 1.0f, 100.0f));
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    const scene::Camera camera = cameraAt({1.0f, 0.5f, 3.0f});
    EXPECT_GT(renderer.render(camera).lumelsLit, 0u);
    const Image first = renderer.readRadiance();
    for (int i = 0; i < 20; ++i) {
        const FrameStats stats = renderer.render(camera);
        EXPECT_EQ(stats.lumelsLit, 0u) << "frame " << i;
        EXPECT_EQ(stats.lumelsKept, stats.lumelsMarked);
    }
    EXPECT_EQ(renderer.readRadiance().pixels, first.pixels);
}

TEST_F(FrameTest, AnOrbitLightsAPartAndStaysNearTheReference)
{
    const TestScene s = sphereScene(bumpyMaps(256, 1.0f, 100.0f));
    Renderer reusing(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    Settings every = settingsFor(Shading::tsl);
    every.refreshShare = 1.0f;
    every.tolerance = 0.0f;
    Renderer lightingAll(device(), s.scene, s.materials, every);
    scene::Camera camera;
    FrameStats stats;
    size_t lit = 0, marked = 0;
    for (int i = 0; i < 24; ++i) {
        const float angle = glm::radians(0.5f * float(i));
        camera = cameraAt({3.0f * std::sin(angle), 0.5f, 3.0f * std::cos(angle)});
        stats = reusing.render(camera);
        lightingAll.render(camera);
        if (i > 0) {
            lit += stats.lumelsLit;
            marked += stats.lumelsMarked;
        }
    }
    EXPECT_GT(lit, 0u);
    EXPECT_LT(lit, marked / 2);
    const Picture reference = shoot(s, camera, settingsFor(Shading::reference));
    EXPECT_LT(compareImages(reusing.readDisplay(), reference.display).rmse,
              1.1 * compareImages(lightingAll.readDisplay(), reference.display).rmse);
}

TEST_F(FrameTest, AfterACameraCutNothingOfThePreviousViewIsLeft)
{
    const TestScene s = sphereScene(bumpyMaps(256, 1.0f, 100.0f));
    const scene::Camera before = cameraAt({2.6f, 0.5f, 1.5f}), after = cameraAt({0.0f, 0.5f, 3.0f});
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    renderer.render(before);
    renderer.render(after);
    const Picture reference = shoot(s, after, settingsFor(Shading::reference));
    const Picture alone = shoot(s, after, settingsFor(Shading::tsl));
    EXPECT_LT(compareImages(renderer.readDisplay(), reference.display).rmse,
              1.1 * compareImages(alone.display, reference.display).rmse);
}

TEST_F(FrameTest, StatisticsNameEveryObjectsModeAndThePriceOfLargerTiles)
{
    TestScene s;
    s.add(planeMesh(), plainMaps());
    scene::Mesh overlapping = planeMesh();
    overlapping.uvProblem = "UVs overlap by 50 %";
    s.add(overlapping, plainMaps(), glm::translate(glm::mat4(1.0f), glm::vec3(2.2f, 0, 0)));
    s.add(planeMesh(), plainMaps(), glm::translate(glm::mat4(1.0f), glm::vec3(500, 0, 0)));
    s.scene.lights = {sun({0, 0, -1})};
    Settings settings = settingsFor(Shading::tsl, {256, 256});
    settings.levelOffset = 0.0f;
    settings.lumelsPerPixel = 64.0f;
    Renderer renderer(device(), s.scene, s.materials, settings);
    const FrameStats stats = renderer.render(cameraAt({0.0f, 0.0f, 6.0f}));
    const std::vector<ObjectStats> objects = renderer.objectStats();
    ASSERT_EQ(objects.size(), 3u);
    EXPECT_EQ(objects[0].mode, "tsl");
    EXPECT_EQ(objects[1].mode, "forward");
    EXPECT_EQ(objects[2].mode, "culled");
    const float metresPerPixel = 2.0f * 6.0f * std::tan(0.35f) / 256.0f;
    EXPECT_NEAR(objects[0].level.value_or(-1.0f), std::log2(512.0f * metresPerPixel), 0.05f);
    EXPECT_GT(objects[0].pixels, 0u);
    EXPECT_FALSE(objects[2].level);
    const auto lumels = renderer.lumelsByTileSize();
    EXPECT_EQ(lumels.at(8), stats.tilesLit * 64);
    EXPECT_GE(lumels.at(16), lumels.at(8));
    EXPECT_GE(lumels.at(32), lumels.at(16));
}

TEST_F(FrameTest, AMovedLightOrObjectIsRelit)
{
    TestScene s = sphereScene(plainMaps());
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    const scene::Camera camera = cameraAt({0.0f, 0.3f, 3.5f});
    renderer.render(camera);
    EXPECT_EQ(renderer.render(camera).lumelsLit, 0u);
    s.scene.lights[0] = sun({1, -1, -1});
    renderer.setLights(s.scene.lights);
    EXPECT_GT(renderer.render(camera).lumelsLit, 0u);
    for (uint32_t i = 0; i < FeedbackPass::kCycle; ++i)
        renderer.render(camera); // until the sub-pixel offsets have met every pixel
    EXPECT_GT(psnr(renderer.readDisplay(), shoot(s, camera, settingsFor(Shading::tsl)).display), 45.0);
    s.scene.objects[0].worldFromObject = glm::rotate(glm::mat4(1.0f), 0.5f, glm::vec3(0, 1, 0));
    renderer.moveObject(0, s.scene.objects[0].worldFromObject);
    for (uint32_t i = 0; i < FeedbackPass::kCycle; ++i)
        renderer.render(camera);
    EXPECT_GT(psnr(renderer.readDisplay(), shoot(s, camera, settingsFor(Shading::tsl)).display), 45.0);
}

TEST_F(FrameTest, ALightOutOfRangeRelightsNothing)
{
    TestScene s = sphereScene(plainMaps());
    scene::Light lamp;
    lamp.type = scene::LightType::point;
    lamp.range = 2.0f;
    lamp.position = {50.0f, 0.0f, 0.0f};
    for (int i = 0; i < 200; ++i)
        s.scene.lights.push_back(lamp);
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    const scene::Camera camera = cameraAt({0.0f, 0.3f, 3.5f});
    EXPECT_GT(renderer.render(camera).lumelsLit, 0u);
    const Image dark = renderer.readRadiance();
    EXPECT_EQ(dark.pixels,
              shoot(sphereScene(plainMaps()), camera, settingsFor(Shading::tsl)).radiance.pixels);
    for (uint32_t i = 0; i <= FeedbackPass::kCycle; ++i) { // later samples see more at edges, once
        s.scene.lights.back().position = {60.0f + float(i), 0.0f, 0.0f};
        renderer.setLights(s.scene.lights);
        renderer.render(camera);
    }
    s.scene.lights.back().position = {55.0f, 0.0f, 0.0f};
    renderer.setLights(s.scene.lights);
    EXPECT_EQ(renderer.render(camera).lumelsLit, 0u);
    s.scene.lights.back().position = {0.0f, 0.0f, 2.0f};
    s.scene.lights.back().intensity = 5.0f;
    renderer.setLights(s.scene.lights);
    EXPECT_GT(renderer.render(camera).lumelsLit, 0u);
    EXPECT_NE(renderer.readRadiance().pixels, dark.pixels);
}

TEST_F(FrameTest, ASmallBudgetLightsOverManyFramesAndEndsAtTheSamePicture)
{
    const TestScene s = sphereScene(bumpyMaps(256, 1.0f, 100.0f));
    const scene::Camera camera = cameraAt({1.0f, 0.5f, 3.0f});
    const Picture whole = shoot(s, camera, settingsFor(Shading::tsl));
    Settings settings = settingsFor(Shading::tsl);
    settings.lumelBudget = uint32_t(whole.stats.lumelsLit / 8);
    Renderer renderer(device(), s.scene, s.materials, settings);
    FrameStats stats = renderer.render(camera);
    EXPECT_LT(stats.lumelsLit, 2u * settings.lumelBudget);
    const Image coarse = renderer.readRadiance();
    const auto mean = [](const Image& image) {
        return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) / double(image.pixels.size());
    };
    EXPECT_NEAR(mean(coarse) / mean(whole.radiance), 1.0, 0.4); // blurred, not black
    for (int i = 0; i < 60; ++i)
        stats = renderer.render(camera);
    EXPECT_EQ(stats.lumelsPending, 0u);
    EXPECT_GT(psnr(renderer.readDisplay(), whole.display), 38.0);
}

TEST_F(FrameTest, HiddenAndOffScreenObjectsAreNotLit)
{
    TestScene s;
    s.add(planeMesh(), plainMaps());
    s.add(planeMesh(), plainMaps(), glm::translate(glm::mat4(1.0f), glm::vec3(0, 0, -1)));  // hidden
    s.add(planeMesh(), plainMaps(), glm::translate(glm::mat4(1.0f), glm::vec3(100, 0, 0))); // off screen
    s.add(planeMesh(), plainMaps(),
          glm::rotate(glm::mat4(1.0f), shared::kPi, glm::vec3(0, 1, 0)) *
              glm::translate(glm::mat4(1.0f), glm::vec3(0, 0, -0.5f)) *
              glm::scale(glm::mat4(1.0f), glm::vec3(0.2f)));
    s.scene.lights = {sun({0, 0, -1})};
    const Picture picture = shoot(s, cameraAt({0.0f, 0.0f, 5.0f}), settingsFor(Shading::tsl));
    EXPECT_EQ(picture.stats.objectsTsl, 1u);
    EXPECT_EQ(picture.stats.objectsCulled, 1u);
}

TEST_F(FrameTest, ASmallPoolLowersQualityAndNothingElse)
{
    TestScene s;
    for (int i = 0; i < 60; ++i)
        s.add(planeMesh(), plainMaps(glm::vec3(0.8f)),
              glm::translate(glm::mat4(1.0f),
                             glm::vec3(2.2f * float(i % 10) - 10.0f, 2.2f * float(i / 10) - 5.5f, 0)));
    s.scene.lights = {sun({0, 0, -1})};
    Settings settings = settingsFor(Shading::tsl, {320, 180});
    const scene::Camera camera = cameraAt({0.0f, 0.0f, 18.0f});
    const Picture rich = shoot(s, camera, settings);
    settings.poolBytes = size_t(1) << 18;
    const Picture poor = shoot(s, camera, settings);
    EXPECT_EQ(rich.stats.levelBias, 0.0f);
    EXPECT_GT(poor.stats.levelBias, 0.0f);
    EXPECT_LE(poor.stats.poolUsedBytes, settings.poolBytes);
    EXPECT_EQ(poor.stats.objectsTsl, rich.stats.objectsTsl);
    EXPECT_GT(psnr(poor.display, rich.display), 35.0);
}

TEST_F(FrameTest, OverlappingUvsAreDrawnForward)
{
    TestScene s;
    scene::Mesh mesh = planeMesh();
    mesh.uvProblem = "UVs overlap by 50 %";
    s.add(mesh, plainMaps());
    s.scene.lights = {sun({0, 0, -1})};
    const Picture picture = shoot(s, cameraAt({0.0f, 0.0f, 4.0f}), settingsFor(Shading::tsl));
    EXPECT_EQ(picture.stats.objectsTsl, 0u);
    EXPECT_EQ(picture.stats.objectsForward, 1u);
    EXPECT_GT(picture.radiance.at(80, 45)[0], 0.05f);
}

TEST_F(FrameTest, ManyFramesReuseTheSameTextures)
{
    const TestScene s = sphereScene(plainMaps());
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    size_t textures = 0;
    for (int i = 0; i < 20; ++i) {
        const float angle = 0.1f * float(i);
        const FrameStats stats =
            renderer.render(cameraAt({4.0f * std::sin(angle), 0.0f, 4.0f * std::cos(angle)}));
        EXPECT_LE(stats.poolUsedBytes, stats.poolCapBytes);
        textures = std::max(textures, stats.poolTextures);
    }
    EXPECT_LE(textures, 2u); // the level may flip once between two size classes
}
