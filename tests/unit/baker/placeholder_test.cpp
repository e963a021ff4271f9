// What stands in for a chain, against the chain of the same closed form.
#include "baker/bake.h"
#include "core/error.h"
#include "maps.h"
#include <gtest/gtest.h>

namespace lumel::baker {
namespace {

Maps mapsOf(int width, int height)
{
    Maps maps;
    maps.normal = Image(width, height, 3);
    maps.roughness = Image(width, height, 1);
    maps.specular = Image(width, height, 3);
    maps.diffuse = Image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float values[3] = {0.3f + 0.4f * float((7 * x + 3 * y) % 11) / 11.0f,
                                     0.3f + 0.4f * float((5 * x + 9 * y) % 13) / 13.0f, 0.95f};
            std::copy(values, values + 3, maps.normal.at(x, y));
            *maps.roughness.at(x, y) = 0.2f + 0.05f * float((x + 2 * y) % 9);
            for (int c = 0; c < 3; ++c) {
                maps.specular.at(x, y)[c] = 0.1f * float(1 + (x + c) % 5);
                maps.diffuse.at(x, y)[c] = 0.1f * float(1 + (y + c) % 6);
            }
        }
    return maps;
}

void expectNear(const ReflectanceMips& placeholder, const ReflectanceMips& chain, float tolerance)
{
    ASSERT_EQ(placeholder.levels.size(), chain.levels.size());
    for (size_t i = 0; i < chain.levels.size(); ++i) {
        const Level &a = placeholder.levels[i], &b = chain.levels[i];
        ASSERT_EQ(a.width, b.width);
        ASSERT_EQ(a.height, b.height);
        for (size_t t = 0; t < b.texels.size(); ++t)
            if (t % kChannels != kError) {
                ASSERT_NEAR(a.texels[t], b.texels[t], i == 0 ? 0.0f : tolerance)
                    << "level " << i << ", channel " << t % kChannels;
            }
    }
}

TEST(Placeholder, IsTheClosedForm)
{
    const Maps maps = mapsOf(64, 32);
    for (const Method method : {Method::average, Method::flat, Method::toksvig, Method::lean})
        expectNear(placeholder(maps, {.method = method}), bake(maps, {.method = method}), 1e-4f);
    Maps heights = mapsOf(64, 32);
    heights.height = heights.normal;
    heights.normal = {};
    heights.heightScale = 0.05f;
    expectNear(placeholder(heights, {.method = Method::height}), bake(heights, {.method = Method::height}),
               1e-4f);
}

TEST(Placeholder, OfAFitIsLean)
{
    const Maps maps = mapsOf(64, 32);
    for (const Method method : {Method::fit, Method::fitPower})
        expectNear(placeholder(maps, {.method = method}), bake(maps, {.method = Method::lean}), 1e-4f);
    const ReflectanceMips isotropic = placeholder(maps, {.model = Model::blinnPhong});
    for (size_t i = 1; i < isotropic.levels.size(); ++i) {
        const float* texel = isotropic.levels[i].at(0, 0);
        EXPECT_EQ(texel[kSxx], texel[kSyy]);
        EXPECT_EQ(texel[kSxy], 0.0f);
        EXPECT_EQ(texel[kError], 0.0f);
    }
}

// Texels of such levels cover parts of finer ones, whose averages stand in for those of their parts.
TEST(Placeholder, OfAnySizeIsNearTheClosedForm)
{
    const Maps maps = mapsOf(37, 21);
    expectNear(placeholder(maps, {}), bake(maps, {.method = Method::lean}), 0.05f);
}

TEST(Placeholder, ComplainsAsTheBakerDoes)
{
    EXPECT_THROW(placeholder({}, {}), Error);
}

} // namespace
} // namespace lumel::baker
