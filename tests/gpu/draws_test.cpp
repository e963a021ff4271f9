// Objects drawn by one call are drawn as each by its own.
#include "renderer/demands.h"
#include "test_scene.h"

namespace lumel::test {
namespace {

class DrawsTest : public GpuTest {};

// Several meshes, some mirrored or double-sided, so that calls end between them.
TestScene manyObjects()
{
    TestScene s = sphereScene(plainMaps());
    s.add(planeMesh(4), bumpyMaps(64, 0.3f, 50.0f), glm::translate(glm::mat4(1.0f), {0.0f, 0.0f, -1.0f}));
    s.scene.materials[1].doubleSided = true;
    for (int i = 0; i < 12; ++i) {
        scene::Object object = s.scene.objects[size_t(i % 3 == 0)];
        const glm::vec3 place(float(i % 4) - 1.5f, 0.8f * float(i / 4) - 0.8f, 0.5f);
        const glm::vec3 scale = 0.25f * glm::vec3(i % 4 == 3 ? -1.0f : 1.0f, 1.0f, 1.0f);
        object.worldFromObject = glm::scale(glm::translate(glm::mat4(1.0f), place), scale);
        s.scene.objects.push_back(object);
    }
    s.scene.lights = {sun({-0.4f, -0.5f, -1.0f})};
    return s;
}

Picture shootOn(const gpu::Device& device, const TestScene& s)
{
    Renderer renderer(device, s.scene, s.materials, settingsFor(Shading::tsl));
    Picture picture;
    picture.stats = renderer.render(cameraAt({0.0f, 0.0f, 4.0f}));
    picture.display = renderer.readDisplay();
    return picture;
}

TEST_F(DrawsTest, OneCallForManyObjectsShowsTheSame)
{
    const gpu::Device single(
        forRendering({.device = device().limits().device, .validation = true, .singleDraws = true}));
    EXPECT_EQ(single.limits().mostIndirectDraws, 0u);
    const TestScene s = manyObjects();
    const Picture a = shootOn(device(), s), b = shootOn(single, s);
    EXPECT_EQ(a.display.pixels, b.display.pixels);
    EXPECT_EQ(a.stats.lumelsLit, b.stats.lumelsLit);
    EXPECT_EQ(single.validationMessages(), std::vector<std::string>{});
}

TEST_F(DrawsTest, MeshesShareBuffersUpToASize)
{
    std::vector<scene::Mesh> meshes;
    for (const int cells : {1, 2, 1, 30, 1, 1})
        meshes.push_back(planeMesh(cells));
    meshes[1].indices.resize(21); // an odd number: what follows is aligned all the same
    MeshBuffers buffers;
    gpu::UploadBatch batch(device());
    buffers.upload(batch, meshes, 20 * sizeof(shared::Vertex));
    batch.finish();
    const auto& parts = buffers.parts();
    ASSERT_EQ(parts.size(), meshes.size());
    EXPECT_EQ(parts[0].vertices.buffer, parts[1].vertices.buffer);
    EXPECT_EQ(parts[1].vertices.first, 4u);
    EXPECT_EQ(parts[1].vertices.address(), parts[0].vertices.address() + 4 * sizeof(shared::Vertex));
    EXPECT_EQ(parts[1].indices.first, 6u);
    EXPECT_EQ(parts[2].indices.first, 28u);
    EXPECT_NE(parts[3].vertices.buffer, parts[2].vertices.buffer); // too large to share
    EXPECT_NE(parts[4].vertices.buffer, parts[3].vertices.buffer);
    EXPECT_EQ(parts[4].indices.buffer, parts[5].indices.buffer);
    for (const MeshParts& part : parts) {
        EXPECT_EQ(part.vertices.address() % 8, 0u);
        EXPECT_EQ(part.indices.address() % 8, 0u);
    }
}

} // namespace
} // namespace lumel::test
