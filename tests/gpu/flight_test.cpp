// Frames in flight: they wait for none but the one whose place in the rings they take, go by the same earlier
// frame however the device keeps pace, and show nearly what frames show that wait for their own feedback.
#include "test_scene.h"
#include <algorithm>

namespace lumel::test {
namespace {

constexpr glm::uvec2 kSize{96, 54};

class FlightTest : public GpuTest {};

Settings lateSettings(uint32_t framesInFlight, glm::uvec2 size = kSize)
{
    Settings settings = settingsFor(Shading::tsl, size);
    settings.residency = ResidencyFrom::latest;
    settings.framesInFlight = framesInFlight;
    return settings;
}

// Rows of balls that hide each other, on a floor.
TestScene ballsScene()
{
    TestScene s;
    for (int i = 0; i < 15; ++i) {
        const glm::vec3 at(2.2f * float(i % 5) - 4.4f, 0.0f, -2.2f * float(i / 5));
        s.add(sphereMesh(), bumpyMaps(32, 0.3f, 40.0f), glm::translate(glm::mat4(1.0f), at));
    }
    const glm::mat4 lying = glm::rotate(glm::mat4(1.0f), glm::radians(-90.0f), {1.0f, 0.0f, 0.0f});
    s.add(planeMesh(), plainMaps(),
          glm::translate(glm::mat4(1.0f), {0.0f, -1.0f, 0.0f}) * glm::scale(lying, glm::vec3(8.0f)));
    s.scene.lights = {sun({0.3f, -0.6f, -1.0f}), sun({-0.7f, -0.5f, -0.4f}, 1.0f)};
    return s;
}

scene::Camera orbitAt(int frame, float degreesPerFrame = 1.0f)
{
    const float angle = glm::radians(degreesPerFrame * float(frame));
    return cameraAt({9.0f * std::sin(angle), 2.0f, -2.2f + 9.0f * std::cos(angle)}, {0.0f, 0.0f, -2.2f});
}

ptrdiff_t framesWithFeedback(const std::vector<FrameStats>& frames)
{
    return std::ranges::count_if(frames, [](const FrameStats& f) { return f.passMs.contains("feedback"); });
}

TEST_F(FlightTest, SteadyFramesWaitForNoneButTheRings)
{
    const TestScene s = ballsScene();
    for (const uint32_t count : {1u, 2u, 3u}) {
        Renderer renderer(device(), s.scene, s.materials, lateSettings(count));
        for (int i = 0; i < 40; ++i)
            renderer.render(orbitAt(i, 0.2f));
        renderer.finish();
        renderer.takeFinished();
        gpu::HostWork work;
        std::vector<FrameStats> frames;
        for (int i = 40; i < 140; ++i) {
            const gpu::HostWork before = gpu::hostWork();
            renderer.render(orbitAt(i, 0.2f));
            work.waits += (gpu::hostWork() - before).waits;
            work.ringWaits += (gpu::hostWork() - before).ringWaits;
            std::ranges::move(renderer.takeFinished(), std::back_inserter(frames));
        }
        renderer.finish();
        std::ranges::move(renderer.takeFinished(), std::back_inserter(frames));
        EXPECT_EQ(work.waits, 0u);
        EXPECT_EQ(work.ringWaits, 100u - count);
        ASSERT_EQ(frames.size(), 100u);
        EXPECT_EQ(framesWithFeedback(frames), 25) << "samples of a moving view serve four frames";
        for (const FrameStats& frame : frames) {
            EXPECT_GT(frame.lumelsMarked, 0u);
            EXPECT_GT(frame.ms, 0.0);
            EXPECT_TRUE(frame.passMs.contains("draw"));
            EXPECT_EQ(frame.hostWork.waits, 0u);
            EXPECT_EQ(frame.hostWork.pipelinesCreated, 0u);
        }
    }
}

TEST_F(FlightTest, FastMotionIsLookedAtInEverySecondFrame)
{
    const TestScene s = ballsScene();
    Renderer renderer(device(), s.scene, s.materials, lateSettings(2));
    std::vector<FrameStats> frames;
    for (int i = 0; i < 20; ++i) {
        renderer.render(orbitAt(i, 4.0f));
        std::ranges::move(renderer.takeFinished(), std::back_inserter(frames));
    }
    renderer.finish();
    std::ranges::move(renderer.takeFinished(), std::back_inserter(frames));
    ASSERT_EQ(frames.size(), 20u);
    EXPECT_EQ(framesWithFeedback(frames), 11); // the first by itself
}

TEST_F(FlightTest, TheFirstFrameAndCutsShowWhatExactFramesShow)
{
    const TestScene s = ballsScene();
    Renderer renderer(device(), s.scene, s.materials, lateSettings(3));
    const scene::Camera near = cameraAt({0.0f, 1.0f, 3.0f});
    EXPECT_GE(renderer.render(near).hostWork.waits, 2u) << "for the feedback, then for the frame";
    EXPECT_EQ(renderer.readRadiance().pixels,
              shoot(s, near, settingsFor(Shading::tsl, kSize)).radiance.pixels);
    Renderer exact(device(), s.scene, s.materials, settingsFor(Shading::tsl, kSize));
    exact.render(near);
    for (int i = 0; i < 5; ++i) {
        renderer.render(near);
        exact.render(near);
    }
    const scene::Camera far = cameraAt({-7.0f, 1.0f, 2.0f});
    const gpu::HostWork before = gpu::hostWork();
    renderer.render(far);
    EXPECT_GE((gpu::hostWork() - before).waits, 2u);
    exact.render(far);
    EXPECT_GT(psnr(renderer.readDisplay(), exact.readDisplay()), 45.0);
}

TEST_F(FlightTest, TheSameFramesShowTheSameHoweverTheDeviceKeepsPace)
{
    const TestScene s = ballsScene();
    for (const uint32_t count : {1u, 2u, 3u}) {
        Renderer free(device(), s.scene, s.materials, lateSettings(count)),
            waited(device(), s.scene, s.materials, lateSettings(count));
        for (int i = 0; i < 24; ++i) {
            free.render(orbitAt(i, 3.0f));
            waited.render(orbitAt(i, 3.0f));
            waited.finish();
        }
        EXPECT_EQ(free.readRadiance().pixels, waited.readRadiance().pixels) << count << " in flight";
    }
}

TEST_F(FlightTest, AStillViewSettlesAtThePictureOfAnExactOne)
{
    const TestScene s = sphereScene(bumpyMaps(32, 0.3f, 40.0f));
    Renderer late(device(), s.scene, s.materials, lateSettings(3)),
        exact(device(), s.scene, s.materials, settingsFor(Shading::tsl, kSize));
    for (int i = 0; i < 12; ++i) {
        late.render(orbitAt(i, 2.0f));
        exact.render(orbitAt(i, 2.0f));
    }
    const auto settle = [](Renderer& renderer) {
        for (int i = 0; i < 300; ++i) {
            renderer.render(orbitAt(11, 2.0f));
            if (renderer.settled())
                return i;
        }
        return 300;
    };
    const int exactFrames = settle(exact);
    EXPECT_LT(exactFrames, 300);
    EXPECT_LE(settle(late), exactFrames + 20);
    late.finish();
    EXPECT_EQ(late.takeFinished().back().lumelsLit, 0u);
    EXPECT_GT(psnr(late.readDisplay(), exact.readDisplay()), 40.0);
}

double rmse(const Image& a, const Image& b)
{
    double sum = 0.0;
    for (size_t i = 0; i < a.pixels.size(); ++i)
        sum += double(a.pixels[i] - b.pixels[i]) * double(a.pixels[i] - b.pixels[i]);
    return std::sqrt(sum / double(a.pixels.size()));
}

TEST_F(FlightTest, AnOrbitIsAsNearToTheReferenceAsWithExactFrames)
{
    const TestScene s = ballsScene();
    Settings truth = settingsFor(Shading::reference, kSize);
    truth.samples = 16;
    Renderer reference(device(), s.scene, s.materials, truth),
        exact(device(), s.scene, s.materials, settingsFor(Shading::tsl, kSize));
    std::vector<std::unique_ptr<Renderer>> late;
    for (const uint32_t count : {1u, 2u, 3u})
        late.push_back(std::make_unique<Renderer>(device(), s.scene, s.materials, lateSettings(count)));
    double exactError = 0.0;
    std::array<double, 3> errors{};
    for (int i = 0; i < 48; ++i) {
        exact.render(orbitAt(i, 2.0f));
        for (const auto& renderer : late)
            renderer->render(orbitAt(i, 2.0f));
        if (i % 6 != 5)
            continue;
        reference.render(orbitAt(i, 2.0f));
        const Image picture = reference.readDisplay();
        exactError += rmse(exact.readDisplay(), picture);
        for (size_t k = 0; k < late.size(); ++k)
            errors[k] += rmse(late[k]->readDisplay(), picture);
    }
    for (const double error : errors)
        EXPECT_LE(error, 1.03 * exactError);
}

// The way to the balls and sideways past them: they come into view, come to light and grow.
TEST_F(FlightTest, NoObjectPopsOnADollyAndAPan)
{
    const TestScene s = ballsScene();
    const auto cameraOf = [](int i) {
        const float forward = std::min(float(i), 150.0f), sideways = std::max(float(i) - 150.0f, 0.0f);
        const glm::vec3 eye(0.03f * sideways - 2.0f, 1.5f, 10.0f - 0.04f * forward);
        return cameraAt(eye, eye + glm::vec3(0.2f, -0.3f, -3.0f));
    };
    Renderer renderer(device(), s.scene, s.materials, lateSettings(3, {160, 90}));
    std::vector<double> jumps;
    Image before;
    for (int i = 0; i < 300; ++i) {
        renderer.render(cameraOf(i));
        Image now = renderer.readDisplay();
        if (i > 0 && i != 151) // where the way turns
            jumps.push_back(rmse(now, before));
        before = std::move(now);
    }
    const auto check = [](std::span<double> part) {
        std::ranges::sort(part);
        EXPECT_LE(part.back(), 2.0 * part[part.size() / 2]);
    };
    check(std::span(jumps).first(150));
    check(std::span(jumps).subspan(150));
}

TEST_F(FlightTest, SettingsLightsAndShapesMayChangeWithFramesInFlight)
{
    TestScene s = ballsScene();
    Renderer renderer(device(), s.scene, s.materials, lateSettings(3));
    for (int i = 0; i < 48; ++i) {
        Settings settings = lateSettings(1 + uint32_t(i / 3) % 3, i / 12 % 2 ? glm::uvec2(64, 36) : kSize);
        settings.poolBytes = size_t(i / 16 % 2 ? 1 : 64) << 20;
        settings.residency = i / 24 % 2 ? ResidencyFrom::exact : ResidencyFrom::latest;
        settings.shading = i % 8 == 7 ? Shading::forward : Shading::tsl;
        settings.shadows = i % 10 < 5;
        renderer.setSettings(settings);
        s.scene.lights.resize(1 + size_t(i % 4), sun({1.0f, -1.0f, 0.1f * float(i)}));
        renderer.setLights(s.scene.lights);
        renderer.moveObject(2, glm::translate(glm::mat4(1.0f), {0.0f, 0.1f * float(i), 0.0f}));
        renderer.render(orbitAt(i, 4.0f));
        if (i % 9 == 8)
            renderer.meter(orbitAt(i, 4.0f));
        if (i % 11 == 10)
            renderer.restart();
    }
    renderer.finish();
}

} // namespace
} // namespace lumel::test
