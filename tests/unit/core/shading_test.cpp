// The shading that the GPU runs, as C++ (shaders/shared/shading.h).
#include "shared/shading.h"
#include "shared/tonemap.h"
#include <gtest/gtest.h>
#include <random>

using namespace lumel::shared;

namespace {

SurfaceReflectance surfaceOf(float power, vec3 specular, vec3 diffuse, vec3 v)
{
    const vec3 covariance(1.0f / power, 0.0f, 1.0f / power);
    return reflectanceTowards({.lobe = makeLobe({0, 0, 1}, covariance),
                               .macroNormal = {0, 0, 1},
                               .specular = specularStrength(specular, covariance),
                               .f0 = specular,
                               .baseVariance = 1.0f / power,
                               .diffuse = diffuse},
                              v);
}

vec3 onHemisphere(std::mt19937& random)
{
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const float z = unit(random), phi = 2.0f * kPi * unit(random), r = std::sqrt(1.0f - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

} // namespace

TEST(Shading, DiffuseIsLambertsWithoutSpecular)
{
    const vec3 l = glm::normalize(vec3(0.5f, 0.2f, 0.8f));
    const SurfaceReflectance s = surfaceOf(50.0f, vec3(0.0f), vec3(0.6f), vec3(0, 0.6f, 0.8f));
    EXPECT_NEAR(reflectLight(s, l, vec3(0, 0.6f, 0.8f), vec3(1.0f)).x, 0.6f * l.z / kPi, 1e-6f);
}

TEST(Shading, SpecularIsReciprocalButForTheCosineAndTheResidual)
{
    // F, Fresnel and visibility are symmetric in l and v; the rendering equation's cosine is the light's. The
    // residual of energy.h is the view's: it makes up for what leaves towards other views.
    std::mt19937 random(5);
    for (int i = 0; i < 1000; ++i) {
        const vec3 l = onHemisphere(random), v = onHemisphere(random);
        const auto reflected = [](vec3 from, vec3 to) {
            const SurfaceReflectance s = surfaceOf(8.0f, vec3(0.3f), vec3(0.0f), to);
            return reflectLight(s, from, to, vec3(1.0f)).x / (from.z * energyResidual(to.z, 1.0f / 8.0f));
        };
        const float forth = reflected(l, v), back = reflected(v, l);
        EXPECT_NEAR(forth, back, 1e-4f * (forth + back) + 1e-7f);
    }
}

TEST(Shading, FresnelRunsFromF0ToOneAndVanishesWithF0)
{
    EXPECT_NEAR(fresnelSchlick(vec3(0.04f), 1.0f).x, 0.04f, 1e-6f);
    EXPECT_NEAR(fresnelSchlick(vec3(0.04f), 0.0f).x, 1.0f, 1e-6f);
    EXPECT_EQ(fresnelSchlick(vec3(0.0f), 0.0f).x, 0.0f);
    // Beyond 1 there is no negative headroom.
    EXPECT_NEAR(fresnelSchlick(vec3(1.4f), 0.0f).x, 1.4f, 1e-6f);
}

TEST(Shading, LightBelowTheHorizonGivesNothing)
{
    const SurfaceReflectance s = surfaceOf(10.0f, vec3(0.5f), vec3(0.5f), {0, 0, 1});
    EXPECT_EQ(reflectLight(s, glm::normalize(vec3(0.3f, 0, -0.4f)), {0, 0, 1}, vec3(1.0f)), vec3(0.0f));
}

TEST(Lights, PointLightsFallWithTheSquareAndEndAtTheirRange)
{
    Light light{};
    light.type = kLightPoint;
    light.intensity = vec3(8.0f);
    EXPECT_NEAR(incidentLight(light, {0, 0, 2}).irradiance.x, 2.0f, 1e-5f);
    EXPECT_NEAR(incidentLight(light, {0, 0, 2}).direction.z, -1.0f, 1e-6f);
    light.inverseRange = 1.0f / 4.0f;
    EXPECT_LT(incidentLight(light, {0, 0, 2}).irradiance.x, 2.0f);
    EXPECT_EQ(incidentLight(light, {0, 0, 4}).irradiance.x, 0.0f);
    EXPECT_EQ(incidentLight(light, {0, 0, 5}).irradiance.x, 0.0f);
}

TEST(Lights, SpotLightsAreFullInsideAndDarkOutside)
{
    const float inner = std::cos(0.2f), outer = std::cos(0.5f);
    Light light{};
    light.type = kLightSpot;
    light.direction = {0, 0, -1};
    light.intensity = vec3(1.0f);
    light.coneScale = 1.0f / (inner - outer);
    light.coneOffset = -outer * light.coneScale;
    const auto at = [&](float angle) {
        return incidentLight(light, {std::sin(angle), 0, -std::cos(angle)}).irradiance.x;
    };
    EXPECT_NEAR(at(0.1f), 1.0f, 1e-5f);
    EXPECT_GT(at(0.3f), at(0.4f));
    EXPECT_EQ(at(0.6f), 0.0f);
}

TEST(ToneMap, EncodesForDisplayWithinAFractionOfAStep)
{
    for (int i = 0; i <= 100000; ++i) {
        const float linear = float(i) / 100000.0f;
        EXPECT_NEAR(encodeForDisplay(linear), encodeSrgb(linear), 0.05f / 255.0f) << linear;
    }
}

TEST(ToneMap, KeepsOrderStaysInRangeAndMapsBlackToBlack)
{
    EXPECT_EQ(displayColour(vec3(0.0f), 1.0f), vec3(0.0f));
    float last = -1.0f;
    for (float radiance = 0.0f; radiance < 100.0f; radiance += 0.01f + 0.05f * radiance) {
        const float shown = displayColour(vec3(radiance), 1.0f).x;
        EXPECT_GE(shown, last);
        EXPECT_LE(shown, 1.0f);
        last = shown;
    }
    EXPECT_EQ(displayColour(vec3(-1.0f), 1.0f), vec3(0.0f));
    EXPECT_EQ(displayColour(vec3(0.2f), 2.0f), displayColour(vec3(0.4f), 1.0f));
}
