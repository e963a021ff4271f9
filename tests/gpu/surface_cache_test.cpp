// Lighting from cached surfaces shows the same picture as finding them again.
#include "test_scene.h"

namespace lumel::test {
namespace {

class SurfaceCacheTest : public GpuTest {};

scene::Camera orbit(int frame)
{
    const float angle = 0.02f * float(frame);
    return cameraAt({3.0f * std::sin(angle), 0.5f, 3.0f * std::cos(angle)});
}

struct Orbit {
    std::vector<Image> pictures;
    size_t textureBytes = 0, surfaceBytes = 0; // at most
};

// What happens in each frame, after `frames` of an orbit.
Orbit orbitOf(const TestScene& s, const Settings& settings, const std::function<void(Renderer&, int)>& change)
{
    Renderer renderer(device(), s.scene, s.materials, settings);
    Orbit result;
    for (int frame = 0; frame < 24; ++frame) {
        change(renderer, frame);
        const FrameStats stats = renderer.render(orbit(frame));
        EXPECT_LE(stats.poolUsedBytes + stats.surfaceBytes, stats.poolCapBytes);
        result.textureBytes = std::max(result.textureBytes, stats.poolUsedBytes);
        result.surfaceBytes = std::max(result.surfaceBytes, stats.surfaceBytes);
        result.pictures.push_back(renderer.readRadiance());
    }
    return result;
}

float largestDifference(const Image& a, const Image& b)
{
    float most = 0.0f;
    for (size_t i = 0; i < a.pixels.size(); ++i)
        most = std::max(most, std::abs(a.pixels[i] - b.pixels[i]));
    return most;
}

void expectSameWithout(const TestScene& s, Settings settings,
                       const std::function<void(Renderer&, int)>& change)
{
    settings.refreshShare = 1.0f; // many tiles are lit again
    settings.tolerance = 1e-4f;
    settings.poolBytes = size_t(64) << 20;
    const Orbit with = orbitOf(s, settings, change);
    EXPECT_GT(with.surfaceBytes, 0u);
    // Too little room for surfaces, and some, whose ring goes round.
    for (const size_t tiles : {32, 160}) {
        Orbit less = with;
        // Textures take less where there is less room for them.
        for (int i = 0; i < 3 && less.surfaceBytes == with.surfaceBytes; ++i) {
            settings.poolBytes = less.textureBytes + tiles * shared::kSurfaceWords * SurfaceCache::kPageBytes;
            less = orbitOf(s, settings, change);
        }
        EXPECT_LT(less.surfaceBytes, with.surfaceBytes);
        for (size_t i = 0; i < with.pictures.size(); ++i)
            EXPECT_EQ(largestDifference(with.pictures[i], less.pictures[i]), 0.0f)
                << tiles << " tiles, frame " << i;
    }
}

// lobes: of the sphere; the plane has one.
TestScene shadowedScene(baker::LobeCount lobes = baker::LobeCount::one)
{
    TestScene s;
    s.add(sphereMesh(), bumpyMaps(64, 0.3f, 50.0f), glm::mat4(1.0f), {.lobes = lobes});
    s.add(planeMesh(4), bumpyMaps(64, 0.3f, 200.0f),
          glm::scale(glm::translate(glm::mat4(1.0f), {0.0f, 0.0f, -1.2f}), glm::vec3(2.0f)));
    s.scene.lights = {sun({-0.3f, -0.4f, -1.0f}), sun({0.6f, -0.2f, -1.0f}, 1.5f)};
    return s;
}

TEST_F(SurfaceCacheTest, AnOrbitShowsTheSame)
{
    expectSameWithout(shadowedScene(), settingsFor(Shading::tsl), [](Renderer&, int) {});
}

TEST_F(SurfaceCacheTest, AnOrbitShowsTheSameOfTwoLobesBesideOne)
{
    const TestScene s = shadowedScene(baker::LobeCount::two);
    ASSERT_TRUE(s.materials[0].reflectance.hasSecond());
    ASSERT_FALSE(s.materials[1].reflectance.hasSecond());
    expectSameWithout(s, settingsFor(Shading::tsl), [](Renderer&, int) {});
}

TEST_F(SurfaceCacheTest, OnlySecondLobesTakeMore)
{
    TestScene s;
    s.add(sphereMesh(), bumpyMaps(64, 0.3f, 50.0f));
    TestScene two = s;
    two.materials[0].reflectance = baker::bake(bumpyMaps(64, 0.3f, 50.0f), {.lobes = baker::LobeCount::two});
    const auto still = [](Renderer&, int) {};
    const size_t one = orbitOf(s, settingsFor(Shading::tsl), still).surfaceBytes;
    const size_t more = orbitOf(two, settingsFor(Shading::tsl), still).surfaceBytes;
    constexpr size_t kPage = SurfaceCache::kPageBytes, kBehind = shared::kSurfaceWords * kPage;
    EXPECT_EQ((one - kBehind) % (shared::kSurfaceWords * kPage), 0u);
    EXPECT_EQ((more - kBehind) * shared::kSurfaceWords, (one - kBehind) * (shared::kSurfaceWords + 1));
}

TEST_F(SurfaceCacheTest, LightsThatMoveShowTheSame)
{
    expectSameWithout(shadowedScene(), settingsFor(Shading::tsl), [](Renderer& renderer, int frame) {
        if (frame >= 12)
            renderer.setLights(
                {sun({-0.3f + 0.05f * float(frame - 12), -0.4f, -1.0f}), sun({0.6f, -0.2f, -1.0f}, 1.5f)});
        if (frame == 20) // and the layers of the shadow maps
            renderer.setLights({sun({0.6f, -0.2f, -1.0f}, 1.5f)});
    });
}

TEST_F(SurfaceCacheTest, ObjectsThatMoveAndComeToRestShowTheSame)
{
    expectSameWithout(shadowedScene(), settingsFor(Shading::tsl), [](Renderer& renderer, int frame) {
        if (frame >= 8 && frame < 14)
            renderer.moveObject(0, glm::rotate(glm::mat4(1.0f), 0.1f * float(frame - 8), glm::vec3(0, 1, 0)));
    });
}

} // namespace
} // namespace lumel::test
