#include "export/ggx.h"
#include "export/ggx_average.h"
#include "sample.h"
#include "shared/energy.h"

namespace lumel::baker {
namespace {
using namespace test;

// Walter et al. 2007, eq. 33, without the quadratic form; isotropic.
double distribution(const GgxShape& shape, glm::dvec3 h)
{
    const double cosine = glm::dot(glm::dvec3(shape.normal), h);
    if (cosine <= 0.0)
        return 0.0;
    const double a2 = double(shape.alphaT) * shape.alphaB, t = 1.0 + (a2 - 1.0) * cosine * cosine;
    return a2 / (3.14159265358979 * t * t);
}

// What a display shows, as GgxNodes::display() has it. Under a light from above; no material here is diffuse.
double shown(double specular)
{
    const double radiance = 0.3 * specular;
    return std::sqrt(radiance / (1.0 + radiance));
}

// Relative error of `shape` for the average over the level-0 texels under (x, y), on a dense grid; half
// vectors weighted by how often pictures have them.
double bruteForceError(const GgxLevel& base, int factor, int x, int y, const GgxShape& shape, double f0)
{
    constexpr int kSide = 500;
    double error = 0.0, square = 0.0;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const double hx = (i + 0.5) / kSide * 2.0 - 1.0, hy = (j + 0.5) / kSide * 2.0 - 1.0;
            const double rest = 1.0 - hx * hx - hy * hy;
            if (rest <= 0.0)
                continue;
            const glm::dvec3 h(hx, hy, std::sqrt(rest));
            double average = 0.0;
            for (int v = 0; v < factor; ++v)
                for (int u = 0; u < factor; ++u) {
                    const GgxTexel& t = base.at(x * factor + u, y * factor + v);
                    average += luminanceOf(t.f0) * distribution(t.shape, h) / (factor * factor);
                }
            const double frequency = std::pow(h.z, 4.0);
            error += frequency * std::pow(shown(average) - shown(f0 * distribution(shape, h)), 2.0);
            square += frequency * std::pow(shown(average), 2.0);
        }
    return error / square;
}

TEST(Ggx, RoughnessThatWasBakedComesBack)
{
    for (float r = 0.1f; r < 0.84f; r += 0.02f)
        EXPECT_NEAR(std::sqrt(alphaOfVariance(1.0f / shared::powerFromRoughness(r))), r, 1e-3f) << r;
}

TEST(Ggx, QuadraticFormIsTheDistribution)
{
    GgxShape shape;
    shape.normal = glm::normalize(glm::vec3(0.3f, -0.2f, 0.9f));
    shape.tangent = glm::normalize(glm::cross(shape.normal, glm::vec3(0.0f, 1.0f, 0.0f)));
    shape.alphaT = shape.alphaB = 0.3f;
    GgxNodes nodes;
    std::vector<glm::vec3> halves;
    for (size_t i = 0; i < GgxNodes::kCount; ++i) {
        halves.push_back(ggxHalfVector(shape, (float(i) + 0.5f) / GgxNodes::kCount, float(i)));
        nodes.set(i, halves.back());
    }
    GgxNodes::Values values;
    nodes.evaluate(GgxLobe(shape), values);
    for (size_t i = 0; i < GgxNodes::kCount; ++i) {
        const double expected = distribution(shape, halves[i]);
        EXPECT_NEAR(values[i], expected, 1e-4 * expected);
    }
}

TEST(Ggx, HalfVectorsLieInProportionToTheLobe)
{
    GgxShape shape;
    shape.alphaT = 0.5f;
    shape.alphaB = 0.1f;
    // Half of the energy has slopes, in units of alpha, below 1 (Walter et al. 2007, eq. 35).
    for (int i = 0; i < 8; ++i) {
        const glm::vec3 h = ggxHalfVector(shape, 0.5f, float(i));
        EXPECT_NEAR(glm::length(glm::vec2(h.x / h.z / 0.5f, h.y / h.z / 0.1f)), 1.0f, 1e-4f);
    }
}

TEST(Ggx, UniformMapsStayAsTheyAreOnEveryLevel)
{
    Maps maps;
    maps.normal = constantImage(16, 16, {0.6f, 0.45f, 0.95f});
    maps.powerConstant = shared::powerFromRoughness(0.35f);
    for (const GgxLevel& level : fitGgx(bake(maps, {}), {})) {
        for (const GgxTexel& t : level.texels) {
            EXPECT_NEAR(std::sqrt(std::sqrt(t.shape.alphaT * t.shape.alphaB)), 0.35f, 1e-3f);
            EXPECT_NEAR(t.f0.x, 0.04f, 1e-4f);
        }
        EXPECT_LT(level.errors.worst, 1e-5);
    }
}

// unevenMaps() that only mirror.
Maps unevenMetal(int w, int h)
{
    Maps maps = unevenMaps(w, h);
    maps.diffuse = {};
    return maps;
}

TEST(Ggx, ErrorsAsStatedEqualBruteForce)
{
    const ReflectanceMips mips = bake(unevenMetal(16, 16), {});
    const std::vector<GgxLevel> levels = fitGgx(mips, {});
    for (const size_t l : {1u, 2u, 3u}) {
        const GgxLevel& level = levels[l];
        double sum = 0.0;
        int count = 0;
        const int step = l == 1 ? 2 : 1;
        for (int y = 0; y < level.height; y += step)
            for (int x = 0; x < level.width; x += step, ++count) {
                const GgxTexel& t = level.at(x, y);
                sum += bruteForceError(levels[0], 1 << l, x, y, t.shape, luminanceOf(t.f0));
            }
        EXPECT_NEAR(level.errors.mean / (sum / count), 1.0, 0.25) << "level " << l;
    }
}

TEST(Ggx, NoOtherRoughnessIsNearerToTheAverage)
{
    const ReflectanceMips mips = bake(unevenMetal(8, 8), {});
    const std::vector<GgxLevel> levels = fitGgx(mips, {});
    const GgxTexel& t = levels[3].at(0, 0); // 1 x 1
    double least = 1e30, best = 0.0;
    for (double factor = 0.7; factor < 1.4; factor *= 1.02) {
        GgxShape shape = t.shape;
        shape.alphaT = shape.alphaB = std::sqrt(t.shape.alphaT * t.shape.alphaB) * float(factor);
        if (const double e = bruteForceError(levels[0], 8, 0, 0, shape, luminanceOf(t.f0)); e < least) {
            least = e;
            best = factor;
        }
    }
    EXPECT_NEAR(best, 1.0, 0.06);
    EXPECT_LT(bruteForceError(levels[0], 8, 0, 0, t.shape, luminanceOf(t.f0)), 1.03 * least);
}

TEST(Ggx, NeitherConvertedLobesNorAveragedMapsAreNearer)
{
    for (const float slope : {0.05f, 0.2f, 0.6f}) {
        const ReflectanceMips mips = bake(unevenMaps(32, 32, slope), {});
        for (const GgxLevel& level : fitGgx(mips, {})) {
            EXPECT_LE(level.errors.mean, level.errors.averaged + 1e-6);
            EXPECT_LE(level.errors.mean, level.errors.converted + 1e-6);
        }
    }
}

TEST(Ggx, ReflectanceAtNormalIncidenceIsTheMean)
{
    Maps maps = unevenMaps(16, 16);
    maps.specular = Image(16, 16, 1);
    double mean = 0.0;
    for (size_t i = 0; i < maps.specular.pixels.size(); ++i)
        mean += (maps.specular.pixels[i] = i % 3 ? 0.04f : 0.9f) / double(maps.specular.pixels.size());
    EXPECT_NEAR(fitGgx(bake(maps, {}), {}).back().texels[0].f0.x, mean, 2e-3 * mean);
}

// A matt surface is lit by its mean normal, whatever its highlights do.
TEST(Ggx, DiffuseSurfacesKeepTheMeanNormalAndWhatItReflects)
{
    Maps maps = unevenMaps(16, 16, 0.6f);
    maps.specularConstant = glm::vec3(1e-4f);
    const auto levels = fitGgx(bake(maps, {}), {});
    glm::vec3 normal(0.0f), diffuse(0.0f);
    for (const GgxTexel& t : levels[0].texels) {
        normal += t.shape.normal / 256.0f;
        diffuse += t.shape.normal * t.diffuse.g / 256.0f;
    }
    const GgxTexel& top = levels.back().texels[0];
    EXPECT_GT(glm::dot(top.shape.normal, glm::normalize(normal)), 0.999f);
    EXPECT_NEAR(top.diffuse.g, glm::dot(diffuse, top.shape.normal), 1e-4f);
}

// Where a display clips, the width of a highlight counts, not its height.
TEST(Ggx, AFewSmoothTexelsDoNotMakeAllSmooth)
{
    Maps maps;
    maps.normal = constantImage(8, 8, {0.5f, 0.5f, 1.0f});
    maps.specularConstant = glm::vec3(0.5f);
    maps.roughness = Image(8, 8, 1);
    for (size_t i = 0; i < 64; ++i)
        maps.roughness.pixels[i] = i % 8 ? 0.5f : 0.15f;
    const GgxShape& shape = fitGgx(bake(maps, {}), {}).back().texels[0].shape;
    EXPECT_GT(std::sqrt(shape.alphaT), 0.4f);
}

TEST(Ggx, GroovesAreRoughAcross)
{
    const ReflectanceMips mips = bake(heightMaps(grooves(32, 32, 8), 0.02f, 400.0f), {});
    const auto isotropic = fitGgx(mips, {}), anisotropic = fitGgx(mips, {.anisotropic = true});
    const GgxShape& shape = anisotropic[3].at(1, 1).shape;
    EXPECT_GT(shape.alphaT, 1.5f * shape.alphaB);
    EXPECT_GT(std::abs(shape.tangent.x), 0.98f); // grooves along y
    EXPECT_LT(anisotropic[3].errors.mean, 0.7 * isotropic[3].errors.mean);
}

TEST(Ggx, AnisotropicLevelsGetTheNearestIsotropicLobe)
{
    Maps maps;
    maps.normal = constantImage(8, 8, {0.5f, 0.5f, 1.0f});
    maps.anisotropicPower = {400.0f, 20.0f};
    const auto levels = fitGgx(bake(maps, {}), {});
    const GgxShape& shape = levels[0].at(3, 3).shape;
    EXPECT_FLOAT_EQ(shape.alphaT, shape.alphaB);
    EXPECT_GT(shape.alphaT, alphaOfVariance(1.0f / 400.0f));
    EXPECT_LT(shape.alphaT, alphaOfVariance(1.0f / 20.0f));
    EXPECT_GT(levels[0].errors.mean, 0.01);
}

TEST(Ggx, SecondLobesAndBlackMapsAreTaken)
{
    Options options;
    options.lobes = LobeCount::two;
    const ReflectanceMips two = bake(heightMaps(grooves(32, 32, 8), 0.05f, 400.0f), options);
    for (const GgxLevel& level : fitGgx(two, {}))
        EXPECT_LE(level.errors.mean, level.errors.averaged + 1e-6);
    Maps black = unevenMaps(8, 8);
    black.specularConstant = glm::vec3(0.0f);
    for (const GgxLevel& level : fitGgx(bake(black, {}), {}))
        for (const GgxTexel& t : level.texels) {
            EXPECT_TRUE(std::isfinite(t.shape.alphaT) && t.shape.alphaT > 0.0f);
            EXPECT_EQ(t.f0, glm::vec3(0.0f));
        }
}

} // namespace
} // namespace lumel::baker
