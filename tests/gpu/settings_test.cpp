// A renderer whose settings change renders the same as a new one with these settings.
#include "test_scene.h"

namespace lumel::test {
namespace {

TestScene bumpyPlane()
{
    TestScene s;
    s.add(planeMesh(), bumpyMaps(64, 0.02f, 60.0f));
    s.scene.lights = {sun({-0.4f, -0.5f, -1.0f})};
    return s;
}

Settings smallSettings(Shading shading)
{
    Settings settings;
    settings.size = {48, 32};
    settings.shading = shading;
    settings.samples = 6;
    return settings;
}

const scene::Camera kCamera = cameraAt({0.5f, 0.4f, 2.2f});

Image rendered(const TestScene& s, const Settings& settings)
{
    Renderer renderer(device(), s.scene, s.materials, settings);
    renderer.render(kCamera);
    return renderer.readDisplay();
}

TEST(SettingsChange, ShowsWhatANewRendererShows)
{
    const TestScene s = bumpyPlane();
    Renderer renderer(device(), s.scene, s.materials, smallSettings(Shading::forward));
    renderer.render(cameraAt({-0.5f, 0.2f, 3.0f}));
    std::vector<Settings> changes(7, smallSettings(Shading::tsl));
    changes[1].msaa = 1; // alone: else the size would bring new targets too
    changes[2].size = {71, 53};
    changes[3] = smallSettings(Shading::reference);
    changes[4].filter = DrawFilter::bilinear;
    changes[5].view = View::normal;
    changes[6].toneMap = ToneMap::aces;
    changes[6].poolBytes = size_t(8) << 20;
    for (size_t i = 0; i < changes.size(); ++i) {
        renderer.setSettings(changes[i]);
        renderer.restart();
        renderer.render(kCamera);
        EXPECT_EQ(renderer.readDisplay().pixels, rendered(s, changes[i]).pixels) << "change " << i;
    }
}

TEST(SettingsChange, ToneMappersDiffer)
{
    const TestScene s = bumpyPlane();
    Settings settings = smallSettings(Shading::forward);
    settings.exposure = 4.0f;
    const Image neutral = rendered(s, settings);
    settings.toneMap = ToneMap::aces;
    const Image aces = rendered(s, settings);
    settings.toneMap = ToneMap::clamp;
    const Image clamped = rendered(s, settings);
    EXPECT_NE(neutral.pixels, aces.pixels);
    EXPECT_NE(neutral.pixels, clamped.pixels);
    Renderer renderer(device(), s.scene, s.materials, settings);
    renderer.render(kCamera);
    const Image radiance = renderer.readRadiance(), shown = renderer.readDisplay();
    for (size_t i = 0; i < radiance.pixels.size(); ++i)
        EXPECT_NEAR(shown.pixels[i], linearToSrgb(std::min(4.0f * radiance.pixels[i], 1.0f)), 0.003f);
}

TEST(Reference, AccumulatedOverFramesIsTheSameAsAtOnce)
{
    const TestScene s = bumpyPlane();
    Settings settings = smallSettings(Shading::reference);
    const Image atOnce = rendered(s, settings);
    settings.samples = 1;
    Renderer renderer(device(), s.scene, s.materials, settings);
    renderer.accumulate(cameraAt({-0.5f, 0.2f, 3.0f})); // another view: not to be mixed in
    for (int i = 1; i <= 6; ++i) {
        renderer.accumulate(kCamera);
        EXPECT_EQ(renderer.samples(), i);
    }
    EXPECT_EQ(renderer.readDisplay().pixels, atOnce.pixels);
    renderer.setLights({sun({0.4f, -0.5f, -1.0f})});
    renderer.accumulate(kCamera);
    EXPECT_EQ(renderer.samples(), 1);
}

TEST(Lights, ChangedOnesGiveTheSkyOfASceneThatHasThem)
{
    TestScene s = bumpyPlane();
    Renderer renderer(device(), s.scene, s.materials, smallSettings(Shading::tsl));
    renderer.render(kCamera);
    s.scene.lights = {sun({0.3f, -0.6f, -1.0f}, 1.0f)};
    renderer.setLights(s.scene.lights);
    for (int i = 0; i < 2; ++i)
        renderer.render(kCamera);
    EXPECT_GT(psnr(renderer.readDisplay(), rendered(s, smallSettings(Shading::tsl))), 60.0);
}

} // namespace
} // namespace lumel::test
