// Frames within a budget: validation on; what is shown while lumels wait, and where it ends.
#include "core/compare.h"
#include "test_scene.h"
#include <algorithm>
#include <numeric>

using namespace lumel;
using namespace lumel::test;

using BudgetTest = GpuTest;

namespace {

Settings budgetOf(double budgetMs, glm::uvec2 size = {160, 90})
{
    Settings settings;
    settings.size = size;
    settings.msaa = 4; // silhouettes in part of the pixels
    settings.budgetMs = budgetMs;
    return settings;
}

double mean(const Image& image)
{
    return std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0) / double(image.pixels.size());
}

// The Catmull-Rom spline through the pixels' centres, border pixels repeated, from its kernel (Keys 1981, a =
// -1/2).
float splineAt(const Image& image, float x, float y, int channel)
{
    const auto kernel = [](float t) {
        t = std::abs(t);
        return t < 1.0f   ? (1.5f * t - 2.5f) * t * t + 1.0f
               : t < 2.0f ? ((-0.5f * t + 2.5f) * t - 4.0f) * t + 2.0f
                          : 0.0f;
    };
    float sum = 0.0f;
    for (int j = int(y) - 3; j <= int(y) + 3; ++j)
        for (int i = int(x) - 3; i <= int(x) + 3; ++i)
            sum += kernel(x - float(i) - 0.5f) * kernel(y - float(j) - 0.5f) *
                   image.at(std::clamp(i, 0, image.width - 1), std::clamp(j, 0, image.height - 1))[channel];
    return sum;
}

// A wall of facing plates, each with all of its lumels in view.
TestScene plates(int across, const baker::Maps& maps)
{
    TestScene s;
    const float step = 2.0f / float(across);
    for (int i = 0; i < across * across; ++i)
        s.add(planeMesh(), maps,
              glm::translate(glm::mat4(1.0f), glm::vec3((float(i % across) + 0.5f) * step - 1.0f,
                                                        (float(i / across) + 0.5f) * step - 1.0f, 0.0f)) *
                  glm::scale(glm::mat4(1.0f), glm::vec3(0.5f * step)));
    s.scene.lights = {sun({0, 0, -1}), sun({1, -0.3f, -1}, 1.0f)};
    return s;
}

} // namespace

TEST_F(BudgetTest, FarTooLittleTimeRendersAPartAndShowsAWholePicture)
{
    const TestScene s = plates(2, bumpyMaps(64, 0.5f, 60.0f));
    const scene::Camera camera = cameraAt({0.0f, 0.0f, 3.5f});
    Renderer whole(device(), s.scene, s.materials, budgetOf(0.0));
    whole.render(camera);
    Renderer renderer(device(), s.scene, s.materials, budgetOf(0.1)); // out of reach of any machine
    FrameStats stats;
    for (int i = 0; i < 120; ++i)
        stats = renderer.render(camera);
    EXPECT_EQ(stats.renderScale, tsl::kLeastRenderScale);
    EXPECT_EQ(stats.lumelsPending, 0u);
    const Image display = renderer.readDisplay(), radiance = renderer.readRadiance();
    EXPECT_EQ(display.width, 160);
    EXPECT_EQ(radiance.height, 90);
    EXPECT_GT(psnr(display, whole.readDisplay()), 24.0); // softer, in place
    EXPECT_NEAR(mean(radiance) / mean(whole.readRadiance()), 1.0, 0.02);
}

TEST_F(BudgetTest, AStillViewEndsAtThePictureWithoutABudget)
{
    const TestScene s = plates(2, bumpyMaps(256, 1.0f, 100.0f));
    const scene::Camera camera = cameraAt({0.3f, 0.2f, 3.0f});
    Renderer whole(device(), s.scene, s.materials, budgetOf(0.0));
    const FrameStats all = whole.render(camera);
    // Time is not what this test is about: lumels are rationed, and the budget is met however slow the
    // machine.
    Settings settings = budgetOf(5000.0);
    settings.lumelBudget = uint32_t(all.lumelsLit / 40);
    Renderer renderer(device(), s.scene, s.materials, settings);
    FrameStats stats = renderer.render(camera);
    EXPECT_LT(stats.lumelsLit, 3u * settings.lumelBudget);
    double before = psnr(renderer.readDisplay(), whole.readDisplay());
    EXPECT_GT(before, 12.0);
    for (int i = 0; i < 100; ++i)
        stats = renderer.render(camera);
    EXPECT_EQ(stats.lumelsPending, 0u);
    EXPECT_EQ(stats.renderScale, 1.0f);
    EXPECT_EQ(stats.budgetBias, 0.0f);
    EXPECT_GT(psnr(renderer.readDisplay(), whole.readDisplay()), 45.0);
}

TEST_F(BudgetTest, NothingIsBlackHoweverFewLumelsAFrameLights)
{
    // White under a bright light; all of each plate's tiles are in view, so that coarse ones could be
    // derived.
    const TestScene s = plates(6, plainMaps(glm::vec3(0.9f)));
    const scene::Camera camera = cameraAt({0.0f, 0.0f, 2.9f});
    Renderer whole(device(), s.scene, s.materials, budgetOf(0.0));
    whole.render(camera);
    const Image expected = whole.readRadiance();
    Settings settings = budgetOf(5000.0);
    settings.lumelBudget = 64;
    Renderer renderer(device(), s.scene, s.materials, settings);
    for (int frame = 0; frame < 3; ++frame) {
        renderer.render(camera);
        const Image radiance = renderer.readRadiance();
        for (size_t i = 0; i < radiance.pixels.size(); ++i)
            ASSERT_GT(radiance.pixels[i], 0.5f * expected.pixels[i]) << "frame " << frame << ", value " << i;
    }
}

TEST_F(BudgetTest, ForwardShadingScalesToo)
{
    const TestScene s = plates(2, plainMaps());
    Settings settings = budgetOf(0.1);
    settings.shading = Shading::forward;
    Renderer renderer(device(), s.scene, s.materials, settings);
    FrameStats stats;
    for (int i = 0; i < 12; ++i)
        stats = renderer.render(cameraAt({0.0f, 0.0f, 3.5f}));
    EXPECT_EQ(stats.renderScale, tsl::kLeastRenderScale);
    EXPECT_GT(renderer.readDisplay().at(80, 45)[0], 0.2f);
}

TEST_F(BudgetTest, AScaledFrameIsTheSmallFramesPictureUpscaled)
{
    const TestScene s = plates(2, bumpyMaps(64, 0.5f, 60.0f));
    const scene::Camera camera = cameraAt({0.2f, 0.1f, 3.5f});
    const auto pictureAt = [&](double budgetMs, glm::uvec2 size) {
        Settings settings = budgetOf(budgetMs, size);
        settings.shading = Shading::forward;
        Renderer renderer(device(), s.scene, s.materials, settings);
        for (int i = 0; i < 12; ++i)
            renderer.render(camera);
        return renderer.readDisplay();
    };
    for (const glm::ivec2 size :
         {glm::ivec2(160, 96), glm::ivec2(157, 91)}) { // four pixels at a time, and a rest
        const glm::ivec2 smallSize = glm::round(glm::vec2(size) * tsl::kLeastRenderScale);
        const glm::vec2 scale = glm::vec2(smallSize) / glm::vec2(size);
        const Image scaled = pictureAt(0.1, size), small = pictureAt(0.0, smallSize);
        for (int y = 0; y < size.y; ++y)
            for (int x = 0; x < size.x; ++x)
                for (int c = 0; c < 3; ++c) {
                    const float expected =
                        splineAt(small, scale.x * (float(x) + 0.5f), scale.y * (float(y) + 0.5f), c);
                    ASSERT_NEAR(scaled.at(x, y)[c], std::clamp(expected, 0.0f, 1.0f), 1.5f / 255.0f)
                        << size.x << " wide, at " << x << " " << y;
                }
    }
}

TEST_F(BudgetTest, LightThatLumelsCannotFollowIsShadedPerPixelWhileItMoves)
{
    TestScene s = plates(2, bumpyMaps(256, 1.0f, 100.0f));
    const scene::Camera camera = cameraAt({0.3f, 0.2f, 3.0f});
    Settings settings = budgetOf(5000.0); // time is not what this test is about: lumels are rationed
    settings.lumelBudget = 512;
    Renderer renderer(device(), s.scene, s.materials, settings);
    const auto moveSun = [&](Renderer& r, int frame) {
        std::vector<scene::Light> lights = s.scene.lights;
        lights[0].direction = glm::normalize(glm::vec3(0.02f * float(frame) - 0.5f, 0.1f, -1.0f));
        r.setLights(lights);
    };
    FrameStats stats;
    for (int frame = 0; frame < 90; ++frame) {
        moveSun(renderer, frame);
        stats = renderer.render(camera);
    }
    EXPECT_EQ(stats.objectsForward, 4u);
    EXPECT_EQ(stats.lumelsPending, 0u);
    settings.budgetMs = 0.0;
    settings.shading = Shading::forward;
    Renderer forward(device(), s.scene, s.materials, settings);
    moveSun(forward, 89);
    forward.render(camera);
    EXPECT_GT(psnr(renderer.readDisplay(), forward.readDisplay()), 60.0);
    for (int frame = 0; frame < 60; ++frame)
        stats = renderer.render(camera);
    EXPECT_EQ(stats.objectsTsl, 4u); // all is quiet again
}

TEST_F(BudgetTest, AnAmpleBudgetIsNoOtherPicture)
{
    const TestScene s = plates(2, bumpyMaps(64, 0.5f, 60.0f));
    const scene::Camera camera = cameraAt({0.0f, 0.0f, 3.5f});
    Image pictures[2];
    for (int i = 0; i < 2; ++i) {
        Renderer renderer(device(), s.scene, s.materials, budgetOf(i == 0 ? 0.0 : 10000.0));
        for (int frame = 0; frame < 20; ++frame)
            renderer.render(camera);
        pictures[i] = renderer.readDisplay();
    }
    EXPECT_GT(psnr(pictures[0], pictures[1]), 50.0);
}
