// The built-in environment: a clear sky.
#include "environment.h"
#include "shared/limits.h"

namespace lumel::scene {
namespace {

// The rig's key light stands in the same place: scenes look alike with either.
const glm::vec3 kToSun = glm::normalize(glm::vec3(0.85f, 0.9f, 0.95f));
const glm::vec3 kSunColour(1.0f, 0.92f, 0.78f);
constexpr float kSunLux = 2.5f;
constexpr float kZenith = 0.15f; // radiance
constexpr float kGround = 0.12f;

// Darula and Kittler 2002, "CIE General Sky Standard Defining Luminance Distributions", type 12 (clear, low
// turbidity): gradation from horizon to zenith times the scattering around the sun, relative to the zenith.
float clearSky(float sinElevation, float cosToSun)
{
    const auto gradation = [](float z) { return 1.0f - std::exp(-0.32f / std::max(z, 0.01f)); };
    const auto indicatrix = [](float c) {
        const float angle = std::acos(std::clamp(c, -1.0f, 1.0f));
        return 1.0f + 10.0f * (std::exp(-3.0f * angle) - std::exp(-1.5f * shared::kPi)) + 0.45f * c * c;
    };
    return gradation(sinElevation) / gradation(1.0f) * indicatrix(cosToSun) / indicatrix(kToSun.y);
}

glm::vec3 skyRadiance(glm::vec3 d)
{
    const float cosToSun = glm::dot(d, kToSun);
    const float sky = kZenith * clearSky(d.y, cosToSun);
    // Deep blue overhead, pale towards the horizon and the sun.
    const glm::vec3 blue(0.6f, 0.82f, 1.22f), pale(1.0f, 1.0f, 1.02f);
    const float haze = std::exp(-3.0f * std::max(d.y, 0.0f)) + 0.6f * std::exp(4.0f * (cosToSun - 1.0f));
    const glm::vec3 above = sky * glm::mix(blue, pale, std::min(haze, 1.0f));
    const glm::vec3 below = kGround * glm::vec3(1.0f, 0.95f, 0.88f);
    // The horizon is a few degrees of haze, not a line: reflections of a line would flicker.
    return glm::mix(below, above, glm::smoothstep(-0.08f, 0.04f, d.y));
}

} // namespace

Environment skyEnvironment()
{
    constexpr int kWidth = 512;
    Image picture(kWidth, kWidth / 2, 3);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const glm::vec2 place((float(x) + 0.5f) / float(kWidth),
                                  (float(y) + 0.5f) / float(picture.height));
            const glm::vec3 radiance = skyRadiance(latLongDirection(place));
            std::copy_n(&radiance.x, 3, picture.at(x, y));
        }
    Environment environment = makeEnvironment(picture);
    Light sun;
    sun.name = "sun";
    sun.colour = kSunColour;
    sun.intensity = kSunLux;
    sun.direction = -kToSun;
    environment.lights = {sun};
    return environment;
}

} // namespace lumel::scene
