// The luminance histogram of automatic exposure, and that metering changes no picture.
#include "core/exposure.h"
#include "scene/environment.h"
#include "test_scene.h"
#include <cmath>
#include <numeric>

namespace lumel::test {
namespace {

constexpr glm::uvec2 kMeteredSize{240, 135}; // as large as a view is metered
const scene::Camera kMetered = cameraAt({0.5f, 0.8f, 3.0f});

TestScene bumpySphere(float lux)
{
    TestScene s;
    s.add(sphereMesh(), bumpyMaps(64, 0.4f, 100.0f));
    s.scene.lights = {sun({-1, -0.6f, -0.5f}, lux)};
    return s;
}

class Exposure : public GpuTest {};

TEST_F(Exposure, TheHistogramIsThatOfThePicture)
{
    for (const float lux : {3.0f, 100000.0f}) {
        const TestScene s = bumpySphere(lux);
        Settings settings = settingsFor(Shading::forward, kMeteredSize);
        settings.msaa = 1;
        settings.edgeFilter = false;
        settings.ambient = 0.0f; // black is not lit, or nothing
        Renderer renderer(device(), s.scene, s.materials, settings);
        const LuminanceHistogram histogram = renderer.meter(kMetered);
        renderer.render(kMetered);
        const Image radiance = renderer.readRadiance();
        LuminanceHistogram oracle{};
        for (int y = 0; y < radiance.height; ++y)
            for (int x = 0; x < radiance.width; ++x) {
                const float* p = radiance.at(x, y);
                ++oracle[shared::meterBin(shared::luminanceOf({p[0], p[1], p[2]}))];
            }
        uint32_t lit = 0, different = 0;
        for (size_t bin = 1; bin < histogram.size(); ++bin) {
            lit += oracle[bin];
            different += uint32_t(std::abs(int(histogram[bin]) - int(oracle[bin])));
        }
        EXPECT_GT(lit, 2000u);
        EXPECT_LE(different, 4u) << lux; // fused multiply-adds may move values across a bin's border
        EXPECT_EQ(automaticExposure(histogram), automaticExposure(oracle));
        EXPECT_EQ(needsExposure(histogram), lux > 10.0f);
    }
}

TEST_F(Exposure, EveryWayOfShadingMetersTheSame)
{
    const TestScene s = bumpySphere(100000.0f);
    std::optional<LuminanceHistogram> first;
    for (const Shading way : {Shading::tsl, Shading::forward, Shading::reference}) {
        Renderer renderer(device(), s.scene, s.materials, settingsFor(way, {700, 400}));
        for (int i = 0; i < 2; ++i) { // before and after a frame
            const LuminanceHistogram histogram = renderer.meter(kMetered);
            EXPECT_EQ(histogram, first.value_or(histogram)) << int(way);
            first = histogram;
            renderer.render(kMetered);
        }
    }
}

TEST_F(Exposure, TheEnvironmentCountsWhereItIsSeen)
{
    TestScene s = bumpySphere(3.0f);
    s.scene.environment = std::make_shared<const scene::Environment>(scene::skyEnvironment());
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl, {320, 180}));
    const LuminanceHistogram histogram = renderer.meter(kMetered);
    EXPECT_EQ(std::accumulate(histogram.begin(), histogram.end(), 0u), 256u * 144u);
}

TEST_F(Exposure, MeteringChangesNoPicture)
{
    const TestScene s = bumpySphere(3.0f);
    for (const Shading way : {Shading::tsl, Shading::reference}) {
        Settings settings = settingsFor(way);
        settings.samples = 4;
        const Image plain = shoot(s, kMetered, settings).display;
        Renderer renderer(device(), s.scene, s.materials, settings);
        renderer.meter(kMetered);
        renderer.render(kMetered);
        EXPECT_EQ(renderer.readDisplay().pixels, plain.pixels);
        renderer.meter(cameraAt({-0.5f, 0.2f, 2.0f}));
        const FrameStats second = renderer.render(kMetered);
        EXPECT_EQ(second.lumelsLit, 0u);
        EXPECT_FALSE(second.passMs.contains("meter"));
        EXPECT_EQ(renderer.readDisplay().pixels, plain.pixels);
    }
}

} // namespace
} // namespace lumel::test
