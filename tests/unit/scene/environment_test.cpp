// The environment's averages against plain numeric integrals of the BRDF that lights use.
#include "core/error.h"
#include "scene/environment.h"
#include "shared/environment.h"
#include "shared/shading.h"
#include <chrono>
#include <fstream>
#include <gtest/gtest.h>

namespace lumel::scene {
namespace {

using glm::vec3;

// Sums f(direction) over equal steps of elevation and azimuth, by solid angle.
template<class F>
vec3 integrate(int rows, F f)
{
    glm::dvec3 sum(0.0);
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < 2 * rows; ++x) {
            const glm::vec2 place((float(x) + 0.5f) / float(2 * rows), (float(y) + 0.5f) / float(rows));
            const double area =
                std::sin(double(shared::kPi) * double(place.y)) * std::pow(double(shared::kPi) / rows, 2.0);
            sum += area * glm::dvec3(f(latLongDirection(place)));
        }
    return vec3(sum);
}

shared::EnvironmentView viewOf(const Environment& environment)
{
    shared::EnvironmentView view{};
    view.intensity = 1.0f;
    view.turn = {1.0f, 0.0f};
    std::copy(environment.diffuse.begin(), environment.diffuse.end(), view.diffuse);
    return view;
}

const Environment& sky()
{
    static const Environment environment = skyEnvironment();
    return environment;
}

float luminanceOf(vec3 c)
{
    return glm::dot(c, vec3(0.2126f, 0.7152f, 0.0722f));
}

shared::SurfaceReflectance lobeAlongY(float variance, vec3 f0, vec3 v)
{
    const vec3 covariance(variance, 0, variance);
    return shared::reflectanceTowards({.lobe = shared::makeLobe(vec3(0, 1, 0), covariance),
                                       .macroNormal = vec3(0, 1, 0),
                                       .specular = shared::specularStrength(f0, covariance),
                                       .f0 = f0,
                                       .baseVariance = variance,
                                       .diffuse = vec3(0.0f)},
                                      v);
}

TEST(Environment, DirectionsGoToTheSquareAndBack)
{
    for (int i = 0; i < 2000; ++i) {
        const glm::vec2 place(std::fmod(0.5f + 0.7548777f * float(i), 1.0f), (float(i) + 0.5f) / 2000.0f);
        const vec3 d = latLongDirection(place);
        EXPECT_LT(glm::distance(shared::environmentDirection(shared::environmentPlace(d)), d), 1e-4f);
        EXPECT_LT(glm::distance(latLongDirection(latLongPlace(d)), d), 1e-3f);
    }
    EXPECT_FLOAT_EQ(shared::environmentLevel(shared::environmentVariance(3.0f)), 3.0f);
}

TEST(Environment, BordersOfTheSquareMeet)
{
    // On either side of the fold below the horizon, at every level.
    for (float level = 0.0f; level < float(shared::kEnvironmentLevels); level += 1.0f)
        for (float turn = 0.1f; turn < 6.2f; turn += 0.1f) {
            const vec3 d = glm::normalize(vec3(std::cos(turn), -0.8f, 1e-5f));
            const vec3 mirrored(d.x, d.y, -d.z);
            const vec3 a = lookUp(sky(), d, level), b = lookUp(sky(), mirrored, level);
            EXPECT_LT(glm::length(a - b), 1e-3f) << level;
        }
}

TEST(Environment, DiffuseIsTheIntegralOfTheSky)
{
    const shared::EnvironmentView view = viewOf(sky());
    for (const vec3 n : {vec3(0, 1, 0), vec3(0, -1, 0), vec3(1, 0, 0), vec3(0, 0, -1),
                         glm::normalize(vec3(1, 1, 1)), glm::normalize(vec3(-1, 0.3f, 0.5f))}) {
        const vec3 expected = integrate(256, [&](vec3 d) {
            return lookUp(sky(), d, 0.0f) * std::max(glm::dot(d, n), 0.0f) / shared::kPi;
        });
        // Nine coefficients leave 1 % on average and 9 % at most (Ramamoorthi and Hanrahan, section 3).
        EXPECT_LT(glm::length(shared::environmentDiffuse(view, n) - expected), 0.04f * glm::length(expected));
    }
}

TEST(Environment, ConstantMapsStayConstant)
{
    Image grey(64, 32, 3);
    std::fill(grey.pixels.begin(), grey.pixels.end(), 0.5f);
    const Environment environment = makeEnvironment(grey);
    for (const Image& level : environment.levels)
        for (const float value : level.pixels)
            ASSERT_NEAR(value, 0.5f, 1e-4f);
    EXPECT_NEAR(shared::environmentDiffuse(viewOf(environment), vec3(0.6f, -0.8f, 0.0f)).x, 0.5f, 2e-3f);
}

TEST(Environment, LevelsAreIntegralsOfTheLobe)
{
    for (uint32_t level = 1; level < shared::kEnvironmentLevels; ++level) {
        const float power = 1.0f / shared::environmentVariance(float(level));
        for (const vec3 n :
             {vec3(0, 1, 0), glm::normalize(vec3(0.8f, 0.5f, 0.9f)), glm::normalize(vec3(-1, 0.02f, 0.3f))}) {
            float total = 0.0f;
            vec3 sum = integrate(256, [&](vec3 l) {
                const float c = glm::dot(l, n), h = std::sqrt(std::max(0.5f + 0.5f * c, 1e-6f));
                return c > 0.0f ? lookUp(sky(), l, 0.0f) * std::pow(h, power) * c / (h * h) : vec3(0.0f);
            });
            total = integrate(256, [&](vec3 l) {
                        const float c = glm::dot(l, n), h = std::sqrt(std::max(0.5f + 0.5f * c, 1e-6f));
                        return vec3(c > 0.0f ? std::pow(h, power) * c / (h * h) : 0.0f);
                    }).x;
            sum /= total;
            EXPECT_LT(glm::length(lookUp(sky(), n, float(level)) - sum), 0.03f * glm::length(sum)) << level;
        }
    }
}

// The reflected share of the split sum, against the BRDF itself under constant light.
TEST(Environment, ReflectsAsMuchAsLightsFromEverywhereDo)
{
    for (const float power : {1.0f, 2.0f, 10.0f, 50.0f, 200.0f})
        for (const float cosine : {0.25f, 0.5f, 0.8f, 1.0f}) {
            const vec3 v(std::sqrt(1.0f - cosine * cosine), cosine, 0.0f);
            for (const float f0 : {1.0f, 0.5f, 0.04f}) {
                const shared::SurfaceReflectance surface = lobeAlongY(1.0f / power, vec3(f0), v);
                const float expected =
                    integrate(192, [&](vec3 l) { return shared::reflectLight(surface, l, v, vec3(1.0f)); }).x;
                const float share = shared::grazingShare(cosine, 1.0f / power);
                EXPECT_NEAR(shared::reflectedShare(surface, share).x, expected, 0.02f)
                    << power << " " << cosine << " " << f0;
            }
        }
}

// All of it: what a metal reflects of the sky, against its integral.
TEST(Environment, LobesReflectTheSky)
{
    double sumOfErrors = 0.0;
    int count = 0;
    for (const float power : {5.0f, 20.0f, 100.0f, 400.0f})
        for (const float cosine : {0.3f, 0.6f, 0.95f})
            for (const float turn : {0.0f, 1.5f, 4.0f}) {
                const float sine = std::sqrt(1.0f - cosine * cosine);
                const vec3 v(sine * std::cos(turn), cosine, sine * std::sin(turn)), n(0, 1, 0);
                const shared::SurfaceReflectance surface = lobeAlongY(1.0f / power, vec3(0.9f), v);
                const vec3 expected = integrate(192, [&](vec3 l) {
                    return lookUp(sky(), l, 0.0f) * shared::reflectLight(surface, l, v, vec3(1.0f));
                });
                const shared::EnvironmentLobe lobe = shared::environmentLobe(cosine, 1.0f / power);
                const vec3 mirrored = 2.0f * glm::dot(n, v) * n - v;
                const vec3 direction = glm::mix(mirrored, n, lobe.towardsNormal);
                const vec3 found =
                    lookUp(sky(), direction, shared::environmentLevel(lobe.narrowing / power)) *
                    shared::reflectedShare(surface, shared::grazingShare(cosine, 1.0f / power));
                const double error = std::abs(luminanceOf(found) / luminanceOf(expected) - 1.0f);
                EXPECT_LT(error, 0.2) << power << " " << cosine << " " << turn;
                sumOfErrors += error;
                ++count;
            }
    EXPECT_LT(sumOfErrors / count, 0.06);
}

TEST(Environment, IsMadeInWellUnderASecond)
{
    const auto start = std::chrono::steady_clock::now();
    const Environment again = skyEnvironment();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    RecordProperty("ms", int(1000.0 * seconds.count()));
    EXPECT_LT(seconds.count(), 2.0);                                   // 0.15 s on two idle cores
    EXPECT_EQ(again.levels.back().pixels, sky().levels.back().pixels); // on any number of threads
}

class EnvironmentFile : public testing::Test {
protected:
    std::filesystem::path write(const std::string& name, const Image& image)
    {
        const auto file = std::filesystem::path(testing::TempDir()) / name;
        writeImage(file, image);
        return file;
    }
    std::string messageOf(const std::filesystem::path& file)
    {
        try {
            loadEnvironment(file);
        } catch (const Error& e) {
            return e.what();
        }
        return "";
    }
};

TEST_F(EnvironmentFile, ComesBackAsItWasWritten)
{
    Image image(128, 64, 3);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] = 0.1f + 0.5f * float(c) + 0.01f * float(y);
    const Environment environment = loadEnvironment(write("lumel-environment.exr", image));
    EXPECT_NEAR(lookUp(environment, vec3(0, 1, 0), 0.0f).x, 0.1f, 0.02f);
    EXPECT_NEAR(lookUp(environment, vec3(0, -1, 0), 0.0f).z, 1.1f + 0.63f, 0.02f);
    EXPECT_TRUE(environment.lights.empty());
}

TEST_F(EnvironmentFile, ThatIsNoneIsRefused)
{
    Image image(16, 8, 3);
    const auto broken = [&](float value) {
        Image copy = image;
        copy.at(3, 2)[1] = value;
        return write("lumel-broken.exr", copy);
    };
    EXPECT_NE(messageOf(broken(NAN)).find("pixel 3, 2 is not a finite number"), std::string::npos);
    EXPECT_NE(messageOf(broken(INFINITY)).find("not a finite number"), std::string::npos);
    EXPECT_NE(messageOf(broken(-1.0f)).find("negative"), std::string::npos);
    EXPECT_NE(messageOf(write("lumel-one.exr", Image(1, 1, 3))).find("twice as wide as high"),
              std::string::npos);
    EXPECT_NE(messageOf("/nowhere/sky.hdr").find("no such file"), std::string::npos);
    EXPECT_NE(messageOf("sky.png").find("unknown environment format"), std::string::npos);
    const auto text = std::filesystem::path(testing::TempDir()) / "lumel-text.hdr";
    std::ofstream(text) << "not a picture\n";
    EXPECT_NE(messageOf(text).find("its content is not"), std::string::npos);
    // A header alone, of more than is read.
    const auto huge = std::filesystem::path(testing::TempDir()) / "lumel-huge.hdr";
    std::ofstream(huge) << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 16000 +X 32000\n";
    EXPECT_NE(messageOf(huge), "");
}

} // namespace
} // namespace lumel::scene
