// Meshes lit at other UVs than their material's: tiled, mirrored, clamped, unwrapped.
#include "charts/lit_uvs.h"
#include "test_scene.h"

using namespace lumel;
using namespace lumel::test;

using LitUvsTest = GpuTest;

namespace {

// Bumps, with a different colour in each quarter of the map.
baker::Maps patchedMaps(int size)
{
    baker::Maps maps = bumpyMaps(size, 0.4f, 60.0f);
    maps.diffuseConstant = glm::vec3(1.0f);
    maps.diffuse = Image(size, size, 3);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            float* c = maps.diffuse.at(x, y);
            c[0] = 2 * x < size ? 0.7f : 0.1f;
            c[1] = 2 * y < size ? 0.6f : 0.1f;
            c[2] = 4 * x < size ? 0.5f : 0.2f;
        }
    return maps;
}

TestScene sceneOf(const scene::Mesh& mesh, const scene::UvMapping& uv = {})
{
    TestScene s;
    s.add(mesh, patchedMaps(64));
    s.scene.materials[0].uv = uv;
    s.scene.lights = {sun({-0.4f, -0.3f, -1.0f}), sun({0.6f, 0.5f, -0.7f}, 1.0f)};
    return s;
}

// Texture space must stay this close to the reference, and not much behind forward shading, which reads the
// same material MIPs per pixel.
void expectClose(const TestScene& s, const scene::Camera& camera, double least, const char* name,
                 size_t inTextureSpace = 1)
{
    SCOPED_TRACE(name);
    const Picture reference = shoot(s, camera, settingsFor(Shading::reference));
    const Picture tsl = shoot(s, camera, multisampled(Shading::tsl));
    const Picture forward = shoot(s, camera, multisampled(Shading::forward));
    EXPECT_EQ(tsl.stats.objectsTsl, inTextureSpace);
    const double lit = psnr(tsl.display, reference.display),
                 direct = psnr(forward.display, reference.display);
    EXPECT_GT(lit, least) << "forward: " << direct;
    EXPECT_GT(lit, std::min(direct, 40.0) - 4.0);
}

scene::Mesh tiledPlane(float tiles)
{
    scene::Mesh mesh = planeMesh(4);
    for (shared::Vertex& v : mesh.vertices)
        v.emissionUv = v.materialUv = tiles * v.uv;
    return mesh;
}

// The right half repeats the left one's UVs from right to left.
scene::Mesh mirroredPlane()
{
    scene::Mesh mesh = planeMesh(4);
    std::vector<shared::Vertex> vertices;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        float centre = 0.0f;
        for (size_t c = 0; c < 3; ++c)
            centre += mesh.vertices[mesh.indices[i + c]].uv.x / 3.0f;
        for (size_t c = 0; c < 3; ++c) {
            shared::Vertex v = mesh.vertices[mesh.indices[i + c]];
            v.uv.x = 2.0f * (centre < 0.5f ? v.uv.x : 1.0f - v.uv.x);
            v.materialUv = v.emissionUv = v.uv;
            if (centre > 0.5f)
                v.tangent = {-1, 0, 0, -1};
            mesh.indices[i + c] = uint32_t(vertices.size());
            vertices.push_back(v);
        }
    }
    mesh.vertices = std::move(vertices);
    mesh.uvProblem = "UVs overlap by 100 %";
    return mesh;
}

} // namespace

TEST_F(LitUvsTest, ATiledPlaneIsLitInTextureSpaceAsTheReferenceShowsIt)
{
    expectClose(sceneOf(tiledPlane(4.0f)), cameraAt({0.3f, -0.8f, 2.0f}), 32.0, "near");
    expectClose(sceneOf(tiledPlane(4.0f)), cameraAt({0.0f, -6.0f, 8.0f}), 42.0, "far");
    // Unwrapped, because these are the UVs of the file.
    scene::Mesh mesh = tiledPlane(4.0f);
    for (shared::Vertex& v : mesh.vertices)
        v.uv = v.materialUv;
    mesh.uvProblem = "UVs leave [0, 1]";
    TestScene s = sceneOf(mesh);
    scene::unwrapMeshes(s.scene);
    ASSERT_TRUE(s.scene.meshes[0].unwrapped);
    expectClose(s, cameraAt({0.3f, -0.8f, 2.0f}), 32.0, "unwrapped");
}

TEST_F(LitUvsTest, AMirroredMeshIsUnwrappedAndLitOnBothSides)
{
    TestScene s = sceneOf(mirroredPlane());
    scene::unwrapMeshes(s.scene);
    ASSERT_TRUE(s.scene.meshes[0].unwrapped);
    expectClose(s, cameraAt({0.3f, -0.8f, 2.0f}), 33.0, "mirrored");
}

TEST_F(LitUvsTest, ASphereInChartsHasNoSeams)
{
    scene::Mesh mesh = sphereMesh();
    mesh.uvProblem = "no UVs";
    TestScene s;
    s.add(mesh, plainMaps());
    s.scene.lights = {sun({-1, -1, -1}), sun({1, -0.3f, -1}, 1.0f)};
    scene::unwrapMeshes(s.scene);
    ASSERT_TRUE(s.scene.meshes[0].unwrapped);
    EXPECT_GT(s.scene.meshes[0].unwrapped->charts, 4u);
    const auto camera = [](float distance) {
        return cameraAt({0.14f * distance, 0.14f * distance, distance});
    };
    expectClose(s, camera(3.5f), 45.0, "near");
    expectClose(s, camera(20.0f), 45.0, "its charts have run into each other", 0);
}

TEST_F(LitUvsTest, WrapModesHoldInTextureSpace)
{
    Image repeated;
    for (const scene::Wrap wrap : {scene::Wrap::repeat, scene::Wrap::mirror, scene::Wrap::clamp}) {
        const scene::UvMapping uv{.wrapU = wrap, .wrapV = wrap};
        const TestScene s = sceneOf(tiledPlane(2.0f), uv);
        const scene::Camera camera = cameraAt({0.0f, 0.0f, 3.2f});
        expectClose(s, camera, 31.5, "wrap");
        const Image shown = shoot(s, camera, settingsFor(Shading::tsl)).display;
        if (wrap == scene::Wrap::repeat)
            repeated = shown;
        else
            EXPECT_LT(psnr(shown, repeated), 25.0); // another picture
    }
}

// Both ways to find a lumel's material, by its own place and through its triangle's material UVs, show the
// same.
TEST_F(LitUvsTest, EqualAndShiftedSetsShowTheSame)
{
    const scene::Camera camera = cameraAt({0.3f, -0.8f, 2.0f});
    const Image same = shoot(sceneOf(planeMesh(4)), camera, settingsFor(Shading::tsl)).display;
    scene::Mesh shifted = planeMesh(4);
    for (shared::Vertex& v : shifted.vertices)
        v.materialUv.x += 1.0f; // a whole tile: the same texels, found through the material's UVs
    const Image other = shoot(sceneOf(shifted), camera, settingsFor(Shading::tsl)).display;
    EXPECT_GT(psnr(same, other), 38.0);
}
