// The shading that the GPU runs, as C++ (shaders/shared/shading.h).
#include "shared/shading.h"
#include "shared/tonemap.h"
#include <gtest/gtest.h>
#include <random>

using namespace lumel::shared;

namespace {

SurfaceReflectance surfaceOf(float power, vec3 specular, vec3 diffuse)
{
    SurfaceReflectance s;
    s.lobe = makeLobe({0, 0, 1}, vec3(1.0f / power, 0.0f, 1.0f / power));
    s.macroNormal = {0, 0, 1};
    s.specular = specular;
    s.diffuse = diffuse;
    return s;
}

vec3 onHemisphere(std::mt19937& random)
{
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    const float z = unit(random), phi = 2.0f * kPi * unit(random), r = std::sqrt(1.0f - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

// Share of light from l that leaves over the whole hemisphere: uniform directions have density 1 / (2 pi).
float albedo(const SurfaceReflectance& surface, vec3 l, int count)
{
    std::mt19937 random(3);
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
        const vec3 v = onHemisphere(random);
        sum += reflectLight(surface, l, v, vec3(1.0f)).x * v.z * 2.0f * kPi;
    }
    return float(sum / count);
}

} // namespace

TEST(Shading, DiffuseAlbedoIsKdCosine)
{
    const vec3 l = glm::normalize(vec3(0.5f, 0.2f, 0.8f));
    // Irradiance on the surface is N.l of that on a plane facing the light.
    EXPECT_NEAR(albedo(surfaceOf(50.0f, vec3(0.0f), vec3(0.6f)), l, 200000), 0.6f * l.z, 0.005f);
}

TEST(Shading, SpecularReflectsAboutKsNearNormalIncidence)
{
    // The talk's scale p normalises the lobe without the cosine: with it, p / (p + 2) remains, less what the
    // horizon cuts off.
    for (const float power : {20.0f, 100.0f, 500.0f}) {
        const vec3 l = glm::normalize(vec3(0.1f, 0.0f, 1.0f));
        const float share = albedo(surfaceOf(power, vec3(0.5f), vec3(0.0f)), l, 2000000) / l.z;
        EXPECT_NEAR(share, 0.5f * power / (power + 2.0f), 0.05f) << "power " << power;
    }
}

TEST(Shading, SpecularIsReciprocalButForTheCosine)
{
    // F, Fresnel and visibility are symmetric in l and v; the rendering equation's cosine is the light's.
    const SurfaceReflectance s = surfaceOf(80.0f, vec3(0.3f), vec3(0.0f));
    std::mt19937 random(5);
    for (int i = 0; i < 1000; ++i) {
        const vec3 l = onHemisphere(random), v = onHemisphere(random);
        const float forth = reflectLight(s, l, v, vec3(1.0f)).x / l.z;
        const float back = reflectLight(s, v, l, vec3(1.0f)).x / v.z;
        EXPECT_NEAR(forth, back, 1e-4f * (forth + back) + 1e-7f);
    }
}

TEST(Shading, FresnelRunsFromKsToOneAndVanishesWithKs)
{
    EXPECT_NEAR(fresnelSchlick(vec3(0.04f), 1.0f).x, 0.04f, 1e-6f);
    EXPECT_NEAR(fresnelSchlick(vec3(0.04f), 0.0f).x, 1.0f, 1e-6f);
    EXPECT_EQ(fresnelSchlick(vec3(0.0f), 0.0f).x, 0.0f);
    // Fitted Ks may pass 1: never darker than Ks, never negative headroom.
    EXPECT_NEAR(fresnelSchlick(vec3(1.4f), 0.0f).x, 1.4f, 1e-6f);
}

TEST(Shading, LightBelowTheHorizonGivesNothing)
{
    const SurfaceReflectance s = surfaceOf(10.0f, vec3(0.5f), vec3(0.5f));
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
