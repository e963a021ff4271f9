// Materials whose texels have two lobes (bake --lobes).
#include "scene/environment.h"
#include "test_scene.h"

namespace lumel::test {
namespace {

enum class Split { none, halves, pruned };

// Bumps on a plane, with each texel's lobe above level 0 in two halves, or beside a second one that is none.
TestScene plane(Split split)
{
    const baker::Maps maps = bumpyMaps(64, 0.05f, 200.0f);
    baker::ReflectanceMips mips = baker::bake(maps, {});
    for (size_t l = 1; l < mips.levels.size() && split != Split::none; ++l) {
        baker::Level& level = mips.levels[l];
        for (size_t i = 0; i < level.texels.size(); i += baker::kChannels) {
            float* t = level.texels.data() + i;
            if (split == Split::halves)
                for (const auto channel : {baker::kKsR, baker::kKsG, baker::kKsB})
                    t[channel] *= 0.5f;
            const float* second = split == Split::halves ? t : baker::kNoSecondLobe;
            level.second.insert(level.second.end(), second, second + baker::kSecondChannels);
        }
        if (split == Split::pruned) // one texel makes them count
            level.second[baker::kKs2R] = 1e-3f;
    }
    TestScene s;
    s.add(planeMesh(4), maps);
    s.materials.back().reflectance = mips;
    s.scene.lights = {sun({-0.4f, -0.5f, -1.0f}), sun({0.5f, 0.2f, -1.0f})};
    return s;
}

using Lobes = GpuTest;

TEST_F(Lobes, HalvesOfALobeLookAsTheWholeDoes)
{
    for (const Split split : {Split::halves, Split::pruned}) {
        const TestScene one = plane(Split::none), two = plane(split);
        ASSERT_FALSE(one.materials[0].reflectance.hasSecond());
        ASSERT_TRUE(two.materials[0].reflectance.hasSecond());
        // From level 1 on: level 0 mixes with it in the first lobe alone.
        for (const float distance : {6.0f, 20.0f})
            for (const Shading shading : {Shading::tsl, Shading::forward})
                for (const int anisotropy : {1, 8}) {
                    Settings settings = settingsFor(shading, {120, 80});
                    settings.forwardAnisotropy = anisotropy;
                    const scene::Camera camera = cameraAt({0.0f, -0.7f * distance, 0.7f * distance});
                    EXPECT_GT(
                        psnr(shoot(one, camera, settings).display, shoot(two, camera, settings).display),
                        50.0)
                        << "split " << int(split) << " at " << distance << ", shading " << int(shading)
                        << ", " << anisotropy << " taps";
                }
    }
}

TEST_F(Lobes, SurroundingsAreReflectedByBoth)
{
    TestScene one = plane(Split::none), two = plane(Split::halves);
    for (TestScene* s : {&one, &two})
        s->scene.environment = std::make_shared<scene::Environment>(scene::skyEnvironment());
    const scene::Camera camera = cameraAt({0.0f, -5.0f, 4.0f});
    for (const Shading shading : {Shading::tsl, Shading::forward})
        EXPECT_GT(psnr(shoot(one, camera, settingsFor(shading, {120, 80})).display,
                       shoot(two, camera, settingsFor(shading, {120, 80})).display),
                  50.0);
}

TEST_F(Lobes, ViewShowsTheShareOfTheSecond)
{
    Settings settings = settingsFor(Shading::tsl, {60, 40});
    settings.view = View::lobes;
    const scene::Camera camera = cameraAt({0.0f, -5.0f, 4.0f});
    const Image one = shoot(plane(Split::none), camera, settings).display;
    const Image two = shoot(plane(Split::halves), camera, settings).display;
    const auto middle = [](const Image& image) { return image.at(image.width / 2, image.height / 2); };
    EXPECT_LT(middle(one)[0], 0.3f);
    EXPECT_GT(middle(two)[0], middle(two)[2] + 0.2f) << "a half is red";
}

} // namespace
} // namespace lumel::test
