#include "scene/scene.h"
#include <cmath>
#include <gtest/gtest.h>

namespace lumel::scene {
namespace {

TEST(FrameBounds, WholeBoxIsSeenAndFillsThePicture)
{
    for (float aspect : {0.4f, 1.0f, 16.0f / 9.0f, 4.0f})
        for (glm::vec3 size :
             {glm::vec3(1, 1, 1), glm::vec3(10, 0, 10), glm::vec3(0.01f, 3, 0.02f), glm::vec3(0, 0, 5)}) {
            Bounds bounds;
            bounds.add(glm::vec3(7, -3, 2));
            bounds.add(glm::vec3(7, -3, 2) + size);
            const Camera camera = frameBounds(bounds, aspect);
            const glm::mat4 clipFromWorld = reversedPerspective(camera.yFov, aspect, camera.nearMetres) *
                                            glm::lookAt(camera.eye, camera.target, camera.up);
            float furthest = 0.0f;
            for (int corner = 0; corner < 8; ++corner) {
                const glm::vec4 clip =
                    clipFromWorld * glm::vec4(corner & 1 ? bounds.upper.x : bounds.lower.x,
                                              corner & 2 ? bounds.upper.y : bounds.lower.y,
                                              corner & 4 ? bounds.upper.z : bounds.lower.z, 1.0f);
                ASSERT_GT(clip.w, camera.nearMetres) << "in front of the near plane";
                furthest = std::max({furthest, std::abs(clip.x / clip.w), std::abs(clip.y / clip.w)});
            }
            EXPECT_LE(furthest, 1.0f);
            EXPECT_GE(furthest, 0.5f);
        }
}

TEST(FrameBounds, LooksFromTheFrontAboveAndTheRight)
{
    Bounds bounds;
    bounds.add({-1, -1, -1});
    bounds.add({1, 1, 1});
    const Camera camera = frameBounds(bounds, 1.5f);
    EXPECT_GT(camera.eye.z, camera.eye.x);
    EXPECT_GT(camera.eye.x, 0.0f);
    EXPECT_GT(camera.eye.y, 0.0f);
}

TEST(FrameBounds, SinglePointsAndNothingGiveAUsableCamera)
{
    Bounds point;
    point.add({1, 2, 3});
    for (const Bounds& bounds : {Bounds{}, point}) {
        const Camera camera = frameBounds(bounds, 1.0f);
        EXPECT_GT(glm::length(camera.target - camera.eye), 0.0f);
        EXPECT_GT(camera.nearMetres, 0.0f);
    }
}

TEST(ThreeLightRig, WhiteDiffuseReachesAboutFourFifths)
{
    const auto lights = threeLightRig();
    ASSERT_EQ(lights.size(), 3u);
    float brightest = 0.0f, brightestInFront = 0.0f;
    glm::vec3 brightestNormal(0.0f);
    for (int i = 0; i < 20000; ++i) { // a spiral over the sphere of normals
        const float z = 1.0f - 2.0f * (float(i) + 0.5f) / 20000.0f, angle = 2.399963f * float(i);
        const float r = std::sqrt(1.0f - z * z);
        const glm::vec3 normal(r * std::cos(angle), r * std::sin(angle), z);
        float radiance = 0.0f;
        for (const Light& light : lights) {
            EXPECT_EQ(light.type, LightType::directional);
            const float luminance = glm::dot(light.colour, glm::vec3(0.2126f, 0.7152f, 0.0722f));
            radiance += light.intensity * luminance / 3.14159265f *
                        std::max(0.0f, -glm::dot(light.direction, normal));
        }
        brightest = std::max(brightest, radiance);
        if (normal.z > 0.3f && radiance > brightestInFront) {
            brightestInFront = radiance;
            brightestNormal = normal;
        }
    }
    EXPECT_NEAR(brightestInFront, 0.8f, 0.08f);
    EXPECT_LT(brightest, 1.05f) << "nothing white burns out";
    EXPECT_GT(brightestNormal.x, 0.2f) << "the key comes from the right";
    EXPECT_GT(brightestNormal.y, 0.2f) << "and from above";
}

TEST(LightRing, StandsAboveTheSceneAndReachesItsCentre)
{
    Bounds bounds;
    bounds.add({-1, 0, -2});
    bounds.add({3, 2, 2});
    for (int count : {1, 4, 16, 64, 257}) {
        const auto lights = lightRing(count, bounds);
        ASSERT_EQ(lights.size(), size_t(count));
        float sum = 0.0f;
        glm::vec3 mean(0.0f);
        for (const Light& light : lights) {
            const float distance = glm::distance(light.position, bounds.centre());
            EXPECT_GT(light.position.y, bounds.centre().y);
            EXPECT_NEAR(distance, bounds.radius(), 1e-4f);
            EXPECT_GT(light.range, distance);
            EXPECT_NEAR(glm::length(light.direction), 1.0f, 1e-5f);
            EXPECT_GT(glm::dot(light.direction, bounds.centre() - light.position), 0.0f);
            sum += light.intensity / (distance * distance);
            mean += (light.position - bounds.centre()) / float(count);
        }
        EXPECT_NEAR(sum, 12.0f, 1e-3f) << "as bright with any count";
        EXPECT_EQ(lights.front().type, LightType::point);
        if (count > 1) {
            EXPECT_EQ(lights[1].type, LightType::spot);
        }
        if (count >= 16) {
            EXPECT_LT(glm::length(glm::vec2(mean.x, mean.z)), 0.2f * bounds.radius()) << "evenly around";
        }
    }
}

TEST(LightRing, NothingGivesUsableLights)
{
    for (const Light& light : lightRing(3, Bounds{})) {
        EXPECT_GT(light.range, 0.0f);
        EXPECT_GT(light.intensity, 0.0f);
    }
}

} // namespace
} // namespace lumel::scene
