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

GgxShape tiltedShape(float alphaT, float alphaB)
{
    GgxShape shape;
    shape.normal = glm::normalize(glm::vec3(0.3f, -0.2f, 0.9f));
    shape.tangent = glm::normalize(glm::cross(shape.normal, glm::vec3(0.0f, 1.0f, 0.0f)));
    shape.alphaT = alphaT;
    shape.alphaB = alphaB;
    return shape;
}

GgxNodes nodesOf(const GgxShape& shape)
{
    GgxNodes nodes;
    GgxNodes::Lobes lobes;
    lobes.fill(&shape);
    nodes.place(lobes, shape);
    return nodes;
}

TEST(Ggx, QuadraticFormIsTheDistribution)
{
    const GgxShape shape = tiltedShape(0.3f, 0.3f);
    const GgxNodes nodes = nodesOf(shape);
    const GgxTerm terms[] = {ggxTerm(shape, 0.25f), ggxTerm(shape, 0.5f)};
    GgxNodes::Values values{}, densities{};
    nodes.add(terms, values, densities);
    for (size_t i = 0; i < GgxNodes::kCount; ++i) {
        const glm::vec3 h = nodes.half(i);
        const double expected = 0.75 * distribution(shape, h);
        EXPECT_NEAR(glm::length(h), 1.0, 1e-6);
        EXPECT_NEAR(values[i], expected, 1e-4 * expected);
        if (h.z > 0.1f) { // d(h.xy) = h.z dh
            const double density = expected * glm::dot(shape.normal, h) / h.z;
            EXPECT_NEAR(densities[i], density, 1e-4 * density);
        }
    }
}

// Slopes in units of alpha: slope^2 = u / (1 - u) for the share u of the energy (Walter et al. 2007, eq. 35),
// evenly around the normal.
TEST(Ggx, HalfVectorsLieInProportionToTheLobe)
{
    const GgxShape shape = tiltedShape(0.5f, 0.1f);
    const GgxNodes nodes = nodesOf(shape);
    const glm::vec3 b = glm::cross(shape.normal, shape.tangent);
    for (const size_t first : {size_t(0), GgxNodes::kPart}) {
        std::vector<float> shares;
        glm::vec2 mean(0.0f);
        for (size_t i = first; i < first + GgxNodes::kPart; ++i) {
            const glm::vec3 h = nodes.half(i) / glm::dot(nodes.half(i), shape.normal);
            const glm::vec2 slope(glm::dot(h, shape.tangent) / 0.5f, glm::dot(h, b) / 0.1f);
            const float squared = glm::dot(slope, slope);
            shares.push_back(squared / (1.0f + squared));
            mean += glm::normalize(slope) / float(GgxNodes::kPart);
        }
        std::ranges::sort(shares);
        for (size_t k = 0; k < shares.size(); ++k)
            EXPECT_NEAR(shares[k], (float(k) + 0.5f) / float(GgxNodes::kPart), 1e-4f);
        EXPECT_LT(glm::length(mean), 0.05f);
    }
}

// What is exported does not depend on the processor.
TEST(Ggx, AllInstructionSetsGiveTheSameBits)
{
    const GgxNodes nodes = nodesOf(tiltedShape(0.4f, 0.2f));
    const GgxShape other = tiltedShape(0.15f, 0.1f);
    const auto all = [&](const GgxKernels& kernels) {
        GgxNodeArrays arrays{};
        GgxDraws draws{};
        for (size_t k = 0; k < 2 * GgxNodes::kPart; ++k) {
            for (int c = 0; c < 3; ++c) {
                draws.normal[c][k] = other.normal[c];
                draws.tangent[c][k] = other.tangent[c];
            }
            draws.alphaT[k] = draws.alphaB[k] = 0.01f * float(k + 1);
            draws.slopeT[k] = 0.1f * float(k);
            draws.slopeB[k] = 3.0f - draws.slopeT[k];
        }
        kernels.place(draws, arrays);
        for (size_t i = 0; i < GgxNodes::kCount; ++i)
            for (int c = 0; c < 3; ++c)
                arrays.light[c][i] = nodes.half(i)[c];
        const GgxTerm terms[] = {ggxTerm(other, 0.3f), ggxTerm(tiltedShape(0.7f, 0.3f), 2.0f)};
        const float diffuse[] = {0.1f, -0.2f, 0.3f};
        std::array<GgxNodes::Values, 4> v{};
        kernels.add(arrays, terms, 2, v[0].data(), v[1].data());
        for (float& density : v[1])
            density += 0.25f; // evenly, too
        kernels.display(arrays, v[0].data(), diffuse, v[2].data());
        const float square = kernels.weigh(arrays, v[1].data(), v[2].data(), v[3].data());
        const float error = kernels.error(arrays, terms[0], diffuse, v[2].data(), v[3].data());
        EXPECT_GT(square, 0.0f);
        EXPECT_GT(error, 0.0f);
        return std::tuple(v, square, error);
    };
    const auto expected = all(kGgxScalar);
    EXPECT_EQ(all(kGgxBaseline), expected);
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2")) {
        EXPECT_EQ(all(kGgxAvx2), expected);
    }
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq")) {
        EXPECT_EQ(all(kGgxAvx512), expected);
    }
#endif
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
    const GgxShape shape = fitGgx(bake(maps, {}), {}).back().texels[0].shape;
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

// The moments of two lobes are between them, where a single GGX lobe is a poor stand-in for the stronger
// one's peak.
TEST(Ggx, LevelsOfTwoLobesAreNoFartherFromTheAverageThanOfOne)
{
    Maps maps;
    maps.normal = constantImage(16, 16, {0.5f, 0.5f, 1.0f});
    maps.powerConstant = 500.0f;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; x += 4) { // a quarter of the texels leans
            float* n = maps.normal.at(x, y);
            n[0] = 0.75f;
            n[2] = 0.5f + 0.5f * std::sqrt(0.75f);
        }
    Options options;
    options.lobes = LobeCount::one;
    const auto one = fitGgx(bake(maps, options), {});
    options.lobes = LobeCount::two;
    const ReflectanceMips mips = bake(maps, options);
    ASSERT_FALSE(mips.levels[2].second.empty());
    const auto two = fitGgx(mips, {});
    ASSERT_EQ(one.size(), two.size());
    for (const size_t level : {2, 3}) {
        const auto error = [&](const std::vector<GgxLevel>& levels) {
            const GgxTexel& t = levels[level].at(0, 0);
            return bruteForceError(levels[0], 1 << level, 0, 0, t.shape, luminanceOf(t.f0));
        };
        EXPECT_LE(error(two), 1.02 * error(one)) << level;
    }
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
