#include "scene/pick.h"
#include "scene/view_camera.h"
#include <gtest/gtest.h>

namespace lumel::scene {
namespace {

Bounds unitBounds()
{
    Bounds bounds;
    bounds.add(glm::vec3(-1.0f));
    bounds.add(glm::vec3(1.0f));
    return bounds;
}

ViewCamera cameraAt(glm::vec3 eye)
{
    Camera camera;
    camera.eye = eye;
    camera.target = glm::vec3(0.0f);
    ViewCamera view;
    view.reset(camera, unitBounds());
    return view;
}

TEST(ViewCamera, OrbitKeepsTheDistanceAndStaysOffThePoles)
{
    ViewCamera view = cameraAt({0.0f, 0.0f, 4.0f});
    EXPECT_FALSE(view.moved());
    view.orbit({0.5f, 0.0f});
    EXPECT_TRUE(view.moved());
    EXPECT_NEAR(view.camera().eye.x, 4.0f, 1e-4f);
    for (int i = 0; i < 50; ++i)
        view.orbit({0.03f, 0.1f});
    EXPECT_NEAR(glm::length(view.camera().eye), 4.0f, 1e-3f);
    EXPECT_LT(view.camera().eye.y, 3.9999f);
    EXPECT_GT(view.camera().eye.y, 3.9f);
}

TEST(ViewCamera, DollyNeverReachesTheTarget)
{
    ViewCamera view = cameraAt({0.0f, 0.0f, 4.0f});
    view.dolly(1.0f);
    EXPECT_NEAR(view.camera().eye.z, 3.6f, 1e-5f);
    view.dolly(1000.0f);
    EXPECT_GT(view.camera().eye.z, 0.0f);
    view.dolly(-10000.0f);
    EXPECT_LT(view.camera().eye.z, 1000.0f);
}

TEST(ViewCamera, PanMovesThePictureByThatShareOfItsHeight)
{
    ViewCamera view = cameraAt({0.0f, 0.0f, 4.0f});
    view.pan({0.0f, 0.5f});
    EXPECT_NEAR(view.camera().target.y, 4.0f * std::tan(0.5f * view.camera().yFov), 1e-4f);
    EXPECT_NEAR(view.camera().eye.y, view.camera().target.y, 1e-5f);
}

TEST(ViewCamera, FocusPutsAnObjectInTheMiddle)
{
    ViewCamera view = cameraAt({0.0f, 0.0f, 4.0f});
    Bounds object;
    object.add({0.5f, 0.5f, 0.5f});
    object.add({0.7f, 0.7f, 0.7f});
    view.focus(object);
    EXPECT_NEAR(glm::distance(view.camera().target, glm::vec3(0.6f)), 0.0f, 1e-5f);
    const float across = glm::distance(view.camera().eye, view.camera().target);
    EXPECT_GT(across * std::sin(0.5f * view.camera().yFov), object.radius());
}

// A square facing +z at z = 0, and a smaller one behind it.
Scene twoSquares()
{
    Scene scene;
    Mesh mesh;
    for (const glm::vec2 p : {glm::vec2(-1, -1), glm::vec2(1, -1), glm::vec2(1, 1), glm::vec2(-1, 1)}) {
        Vertex vertex{};
        vertex.position = glm::vec3(p, 0.0f);
        vertex.materialUv = 0.5f + 0.25f * p;
        mesh.vertices.push_back(vertex);
        mesh.bounds.add(vertex.position);
    }
    mesh.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes = {mesh};
    scene.materials.resize(1);
    scene.objects.resize(2);
    scene.objects[0].worldFromObject = glm::translate(glm::mat4(1.0f), {0.0f, 0.0f, -1.0f});
    scene.objects[1].worldFromObject = glm::scale(glm::mat4(1.0f), glm::vec3(0.5f));
    return scene;
}

TEST(Pick, TakesTheNearestFrontAndItsTextureCoordinates)
{
    const Scene scene = twoSquares();
    Camera camera;
    camera.eye = {0.0f, 0.0f, 4.0f};
    camera.target = glm::vec3(0.0f);
    const auto middle = pick(scene, rayThrough(camera, {0.5f, 0.5f}, 1.0f));
    ASSERT_TRUE(middle);
    EXPECT_EQ(middle->object, 1u);
    EXPECT_NEAR(middle->distance, 4.0f, 1e-5f);
    EXPECT_NEAR(middle->uv.x, 0.5f, 1e-5f);
    EXPECT_NEAR(middle->uvPerMetre, 0.5f, 1e-5f); // 0.5 of the map over 1 m
    // To the right of the near one, through the far one, whose texture runs to the right too.
    const float right = 0.5f + 0.5f * 0.8f / 5.0f / std::tan(0.5f * camera.yFov);
    const auto beside = pick(scene, rayThrough(camera, {right, 0.5f}, 1.0f));
    ASSERT_TRUE(beside);
    EXPECT_EQ(beside->object, 0u);
    EXPECT_NEAR(beside->uv.x, 0.7f, 1e-4f);
    EXPECT_FALSE(pick(scene, rayThrough(camera, {0.0f, 0.0f}, 3.0f)));
}

TEST(Pick, BackFacesLetItPassUnlessBothSidesAreSeen)
{
    Scene scene = twoSquares();
    Camera camera;
    camera.eye = {0.0f, 0.0f, -4.0f};
    camera.target = glm::vec3(0.0f);
    const Ray ray = rayThrough(camera, {0.5f, 0.5f}, 1.0f);
    EXPECT_FALSE(pick(scene, ray));
    scene.materials[0].doubleSided = true;
    const auto hit = pick(scene, ray);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->object, 0u);
}

} // namespace
} // namespace lumel::scene
