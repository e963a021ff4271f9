// Which cameras see nothing.
#include "scene/visibility.h"
#include "shapes.h"
#include <gtest/gtest.h>

using namespace lumel;
using namespace lumel::scene;

namespace {

// A unit square in the plane z = 0 that faces +z.
Scene square()
{
    Scene scene;
    Mesh mesh;
    for (const glm::vec2 p : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
        Vertex vertex{};
        vertex.position = {p, 0.0f};
        mesh.vertices.push_back(vertex);
        mesh.bounds.add(vertex.position);
    }
    mesh.indices = {0, 1, 2, 0, 2, 3};
    scene.bounds = mesh.bounds;
    scene.meshes = {mesh};
    scene.materials.resize(1);
    scene.objects.resize(1);
    return scene;
}

Camera cameraAt(glm::vec3 eye, glm::vec3 target)
{
    Camera camera;
    camera.eye = eye;
    camera.target = target;
    return camera;
}

bool sees(const Scene& scene, glm::vec3 eye, glm::vec3 target)
{
    return seesAnything(scene, cameraAt(eye, target), 16.0f / 9.0f);
}

TEST(Visibility, WhatIsInViewIsSeenFromItsFrontOnly)
{
    Scene scene = square();
    EXPECT_TRUE(sees(scene, {0, 0, 3}, {0, 0, 0}));
    EXPECT_TRUE(sees(scene, {0, 0, 0.02f}, {0, 0, 0})); // larger than the picture
    EXPECT_FALSE(sees(scene, {0, 0, 3}, {0, 0, 6}));    // behind the camera
    EXPECT_FALSE(sees(scene, {0, 0, 3}, {5, 0, 0}));    // beside the picture
    EXPECT_FALSE(sees(scene, {0, 0, -3}, {0, 0, 0}));   // its back
    EXPECT_FALSE(sees(scene, {0, 0, 3000}, {0, 0, 0})); // much smaller than a pixel
    scene.materials[0].doubleSided = true;
    EXPECT_TRUE(sees(scene, {0, 0, -3}, {0, 0, 0}));
}

TEST(Visibility, MirroredObjectsHaveTheirFrontWhereItIsDrawn)
{
    Scene scene = square();
    scene.objects[0].worldFromObject = glm::scale(glm::mat4(1.0f), {-1, 1, 1});
    EXPECT_TRUE(sees(scene, {0, 0, 3}, {0, 0, 0}));
    EXPECT_FALSE(sees(scene, {0, 0, -3}, {0, 0, 0}));
}

TEST(Visibility, WhatAlphaTakesAwayIsNotSeen)
{
    Scene scene = square();
    scene.materials[0].baseColor.a = 0.4f;
    scene.materials[0].alphaMode = AlphaMode::mask;
    EXPECT_FALSE(sees(scene, {0, 0, 3}, {0, 0, 0}));
    scene.materials[0].alphaMode = AlphaMode::blend;
    EXPECT_TRUE(sees(scene, {0, 0, 3}, {0, 0, 0}));
    scene.materials[0].baseColor.a = 0.0f;
    EXPECT_FALSE(sees(scene, {0, 0, 3}, {0, 0, 0}));
}

TEST(Visibility, ASquareAroundTheCameraIsCutByTheNearPlane)
{
    Scene scene = square();
    scene.objects[0].worldFromObject = glm::scale(glm::mat4(1.0f), glm::vec3(1e4f));
    EXPECT_TRUE(sees(scene, {0, 0, 1}, {1, 0, 0.9f})); // to the horizon
    EXPECT_FALSE(sees(scene, {0, 0, 1}, {0, 0, 2}));
}

} // namespace
