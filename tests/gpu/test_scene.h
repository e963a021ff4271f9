// Small scenes made in code, and one device with validation on for all GPU tests.
#pragma once
#include "renderer/frame.h"
#include "shared/limits.h"
#include <functional>
#include <gtest/gtest.h>

namespace lumel::test {

// Shared by all tests: a device costs a second on software Vulkan.
const gpu::Device& device();

// Every test ends by checking that validation said nothing.
class GpuTest : public testing::Test {
protected:
    void TearDown() override { EXPECT_EQ(device().validationMessages(), std::vector<std::string>{}); }
};

// Grid of quads in the plane z = 0, [-1, 1]^2, facing +z; uv (0, 0) at the upper left.
scene::Mesh planeMesh(int cells = 1);
// The same plane, each quad a chart of its own somewhere else in texture space, `gutter` from its neighbours.
scene::Mesh patchworkMesh(int cells, float gutter);
// Unit sphere of rings and segments, unique UVs.
scene::Mesh sphereMesh(int rows = 24, int columns = 48);

struct TestScene {
    scene::Scene scene;
    std::vector<scene::BakedMaterial> materials;

    // Bakes `maps` with the default model and adds the mesh as an object of that material.
    void add(scene::Mesh mesh, const baker::Maps& maps, const glm::mat4& worldFromObject = glm::mat4(1.0f),
             const baker::Options& options = {});
};

// Matte with a broad highlight, no maps. All lobes of these scenes are anisotropic and turned, so that
// mistakes in their axes show.
baker::Maps plainMaps(glm::vec3 diffuse = glm::vec3(0.5f), float power = 20.0f);
// Random bumps, `size` texels square.
baker::Maps bumpyMaps(int size, float scale, float power);

scene::Camera cameraAt(glm::vec3 eye, glm::vec3 target = glm::vec3(0.0f), float yFov = 0.7f);
scene::Light sun(glm::vec3 direction, float lux = 3.0f);

// Unit sphere under two suns.
TestScene sphereScene(const baker::Maps& maps);

Settings settingsFor(Shading shading, glm::uvec2 size = {160, 90});
Settings multisampled(Shading shading); // where silhouettes would outweigh what is tested

struct Picture {
    Image display, radiance;
    FrameStats stats;
};
// One frame of a new renderer.
Picture shoot(const TestScene& s, const scene::Camera& camera, const Settings& settings);

double psnr(const Image& a, const Image& b);

} // namespace lumel::test
