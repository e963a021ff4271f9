#include "scene/camera_path.h"
#include <cmath>
#include <gtest/gtest.h>

namespace lumel::scene {
namespace {

Camera lookingDown()
{
    Camera camera;
    camera.name = "down";
    camera.eye = {1.0f, 2.0f, 3.0f};
    camera.target = {0.5f, 0.25f, -1.0f};
    camera.up = glm::normalize(glm::vec3(-0.05f, 0.9f, -0.4f));
    camera.yFov = 0.5f;
    return camera;
}

void expectSame(const Camera& a, const Camera& b, float tolerance)
{
    EXPECT_NEAR(glm::distance(a.eye, b.eye), 0.0f, tolerance);
    EXPECT_NEAR(glm::distance(a.target, b.target), 0.0f, tolerance);
    EXPECT_NEAR(glm::distance(a.up, b.up), 0.0f, tolerance);
    EXPECT_EQ(a.yFov, b.yFov);
}

TEST(CameraPath, StillAndFirstFramesAreTheStart)
{
    const Camera start = lookingDown();
    for (int i : {0, 1, 77})
        expectSame(cameraOnPath(start, Path::still, 5.0, i), start, 0.0f);
    expectSame(cameraOnPath(start, Path::orbit, 5.0, 0), start, 0.0f);
    expectSame(cameraOnPath(start, Path::dolly, 5.0, 0), start, 0.0f);
}

TEST(CameraPath, OrbitReturnsAfterFullTurns)
{
    const Camera start = lookingDown();
    expectSame(cameraOnPath(start, Path::orbit, 0.5, 720), start, 1e-5f);
    expectSame(cameraOnPath(start, Path::orbit, -0.1, 36000), start, 1e-4f);
    EXPECT_GT(glm::distance(cameraOnPath(start, Path::orbit, 0.5, 360).eye, start.eye), 1.0f);
}

TEST(CameraPath, OrbitKeepsTargetDistanceAndHeight)
{
    const Camera start = lookingDown();
    for (int i = 0; i < 360; i += 7) {
        const Camera camera = cameraOnPath(start, Path::orbit, 1.0, i);
        EXPECT_EQ(camera.target, start.target);
        EXPECT_NEAR(glm::distance(camera.eye, camera.target), glm::distance(start.eye, start.target), 1e-5f);
        EXPECT_NEAR(camera.eye.y, start.eye.y, 1e-6f);
        EXPECT_NEAR(camera.up.y, start.up.y, 1e-6f);
    }
}

TEST(CameraPath, PositiveOrbitMovesToTheRight)
{
    const Camera start = lookingDown();
    const glm::vec3 right = glm::cross(start.target - start.eye, glm::vec3(0, 1, 0));
    EXPECT_GT(glm::dot(cameraOnPath(start, Path::orbit, 1.0, 1).eye - start.eye, right), 0.0f);
}

TEST(CameraPath, DollyScalesTheDistanceByTheSameFactorEachFrame)
{
    const Camera start = lookingDown();
    const float distance = glm::distance(start.eye, start.target);
    for (double step : {1.0, -2.0, 50.0}) {
        float expected = distance;
        for (int i = 0; i < 10; ++i, expected *= float(1.0 - step / 100.0)) {
            const Camera camera = cameraOnPath(start, Path::dolly, step, i);
            EXPECT_EQ(camera.target, start.target);
            EXPECT_NEAR(glm::distance(camera.eye, camera.target), expected, 1e-5f * expected);
            EXPECT_LE(camera.nearMetres, start.nearMetres);
        }
    }
}

TEST(CameraPath, PanMovesEyeAndTargetSidewaysInStep)
{
    const Camera start = lookingDown();
    const glm::vec3 gaze = start.target - start.eye;
    const Camera camera = cameraOnPath(start, Path::pan, 2.0, 5);
    const glm::vec3 way = camera.eye - start.eye;
    EXPECT_NEAR(glm::length(way), 0.1f * glm::length(gaze), 1e-5f);
    EXPECT_NEAR(glm::dot(way, gaze), 0.0f, 1e-5f);
    EXPECT_NEAR(glm::dot(way, start.up), 0.0f, 1e-5f);
    EXPECT_GT(glm::dot(way, glm::cross(gaze, start.up)), 0.0f);
    EXPECT_NEAR(glm::distance(camera.target - camera.eye, gaze), 0.0f, 1e-5f);
    expectSame(cameraOnPath(start, Path::pan, -2.0, -5), camera, 1e-6f);
}

TEST(CameraPath, LongDolliesStayUsable)
{
    const Camera start = lookingDown();
    for (double step : {99.0, 1.0, -1.0, -900.0}) {
        const Camera camera = cameraOnPath(start, Path::dolly, step, 99999);
        EXPECT_TRUE(std::isfinite(camera.eye.x + camera.eye.y + camera.eye.z));
        EXPECT_GT(glm::distance(camera.eye, camera.target), 0.0f);
        EXPECT_GT(camera.nearMetres, 0.0f);
    }
}

} // namespace
} // namespace lumel::scene
