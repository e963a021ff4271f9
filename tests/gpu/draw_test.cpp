// Drawing the lit texture: its filters, chart borders, levels, and the debug views; many objects a call.
#include "core/compare.h"
#include "renderer/demands.h"
#include "test_scene.h"
#include <algorithm>

using namespace lumel;
using namespace lumel::test;

using DrawTest = GpuTest;

TEST_F(DrawTest, MultisamplingMovesNothing)
{
    // A plane of fine detail: lookups shifted by a fraction of a pixel would be far from the reference.
    TestScene s;
    s.add(planeMesh(8), bumpyMaps(256, 1.0f, 100.0f));
    s.scene.lights = {sun({0.3f, -0.2f, -1.0f})};
    const scene::Camera camera = cameraAt({0.0f, -0.6f, 3.0f});
    Settings settings = settingsFor(Shading::tsl);
    const Picture reference = shoot(s, camera, settingsFor(Shading::reference));
    settings.msaa = 1;
    const double single = psnr(shoot(s, camera, settings).display, reference.display);
    settings.msaa = 4;
    EXPECT_GT(psnr(shoot(s, camera, settings).display, reference.display), single - 0.5);
    EXPECT_GT(single, 20.0);
}

TEST_F(DrawTest, TheEdgeFilterSmoothsEdgesOfObjectsAndNothingElse)
{
    const TestScene s = sphereScene(bumpyMaps(256, 1.0f, 60.0f));
    const scene::Camera camera = cameraAt({0.0f, 0.3f, 3.5f});
    const Image reference = shoot(s, camera, settingsFor(Shading::reference)).display;
    for (const Shading shading : {Shading::tsl, Shading::forward}) {
        Settings settings = settingsFor(shading);
        const Image filtered = shoot(s, camera, settings).display;
        settings.edgeFilter = false;
        const Image plain = shoot(s, camera, settings).display;
        EXPECT_GT(psnr(filtered, reference), psnr(plain, reference));
        const auto equal = [](const float* a, const float* b) { return std::equal(a, a + 3, b); };
        const auto covered = [&](int x, int y) { return !equal(plain.at(x, y), plain.at(0, 0)); };
        int changed = 0;
        for (int y = 1; y + 1 < plain.height; ++y)
            for (int x = 1; x + 1 < plain.width; ++x) {
                if (equal(plain.at(x, y), filtered.at(x, y)))
                    continue;
                ++changed;
                const int beside =
                    covered(x - 1, y) + covered(x + 1, y) + covered(x, y - 1) + covered(x, y + 1);
                EXPECT_TRUE(covered(x, y) ? beside < 4 : beside > 0) << x << ", " << y;
            }
        EXPECT_GT(changed, 20);
    }
}

TEST_F(DrawTest, ViewsShowWhatTheySay)
{
    const TestScene s = sphereScene(plainMaps({0.5f, 0.1f, 0.1f}));
    const auto centreOf = [&](View view, Shading shading) {
        Settings settings = settingsFor(shading);
        settings.view = view;
        const Picture picture = shoot(s, cameraAt({0.0f, 0.0f, 3.5f}), settings);
        const float* pixel = picture.radiance.at(80, 45);
        return glm::vec3(pixel[0], pixel[1], pixel[2]);
    };
    const glm::vec3 diffuse = centreOf(View::diffuse, Shading::tsl);
    EXPECT_NEAR(diffuse.r, 0.5f, 0.01f);
    EXPECT_NEAR(diffuse.g, 0.1f, 0.01f);
    const glm::vec3 tsl = centreOf(View::mode, Shading::tsl),
                    forward = centreOf(View::mode, Shading::forward);
    EXPECT_GT(tsl.g, tsl.r);
    EXPECT_LT(forward.g, forward.r);
    const glm::vec3 lit = centreOf(View::lit, Shading::tsl); // all of a first frame
    EXPECT_GT(lit.r, 2.0f * lit.g);
    const glm::vec3 normal = centreOf(View::normal, Shading::tsl);
    EXPECT_GT(normal.b, normal.r);
}

TEST_F(DrawTest, ThePoolViewShowsEveryTexture)
{
    TestScene s;
    for (int i = 0; i < 4; ++i)
        s.add(planeMesh(), plainMaps(glm::vec3(0.9f)),
              glm::translate(glm::mat4(1.0f), glm::vec3(2.2f * float(i) - 3.3f, 0, 0)));
    s.scene.lights = {sun({0, 0, -1})};
    Settings settings = settingsFor(Shading::tsl);
    settings.view = View::pool;
    const Picture picture = shoot(s, cameraAt({0.0f, 0.0f, 14.0f}), settings);
    ASSERT_EQ(picture.stats.objectsTsl, 4u);
    int bright = 0, unlit = 0;
    for (size_t i = 0; i < picture.radiance.pixels.size(); i += 3) {
        bright += picture.radiance.pixels[i] > 0.2f;
        unlit += picture.radiance.pixels[i + 2] < 0.05f;
    }
    EXPECT_GT(bright, 4 * 100);
    EXPECT_GT(unlit, 100); // what the view does not need of them
}

TEST_F(DrawTest, ChartBordersAreNoWorseThanChartsInside)
{
    constexpr int kCharts = 16, kPixels = 256;
    TestScene s;
    s.add(patchworkMesh(kCharts, 2.0f / 1024.0f), plainMaps({0.4f, 0.3f, 0.2f}, 40.0f));
    scene::Light lamp;
    lamp.type = scene::LightType::point;
    lamp.position = {0.3f, 0.4f, 0.6f};
    lamp.intensity = 2.0f;
    s.scene.lights = {lamp};
    // At level 0 no border shows. At level 1 the gutters are a lumel wide, which a cubic filter reaches
    // across: a chart beside it that is far brighter or darker may show by 4 steps. At coarser levels charts
    // merge, and the object is shaded forward.
    for (const auto& [pixelsPerChart, steps] :
         {std::pair(60.0f, 1.5f), std::pair(30.0f, 4.5f), std::pair(12.0f, 1.5f), std::pair(6.0f, 1.5f)}) {
        // Facing: the plane's 2 metres are kCharts charts.
        const float metresPerPixel = 2.0f / (pixelsPerChart * float(kCharts));
        const scene::Camera camera = cameraAt({0, 0, metresPerPixel * kPixels / (2.0f * std::tan(0.35f))});
        const Picture reference = shoot(s, camera, settingsFor(Shading::reference, {kPixels, kPixels}));
        const Picture tsl = shoot(s, camera, settingsFor(Shading::tsl, {kPixels, kPixels}));
        ASSERT_EQ(tsl.stats.objectsTsl, pixelsPerChart >= 30.0f ? 1u : 0u);
        float border = 0.0f, inside = 0.0f;
        for (int y = 0; y < kPixels; ++y)
            for (int x = 0; x < kPixels; ++x) {
                const glm::vec2 chart = (glm::vec2(x, y) + 0.5f - 0.5f * kPixels) / pixelsPerChart;
                if (std::max(std::abs(chart.x), std::abs(chart.y)) > 0.5f * kCharts - 2.0f / pixelsPerChart)
                    continue; // the silhouette and beyond
                const glm::vec2 away = glm::abs(chart - glm::round(chart)) * pixelsPerChart;
                float& worst = std::min(away.x, away.y) < 1.0f ? border : inside;
                for (int c = 0; c < 3; ++c)
                    worst =
                        std::max(worst, std::abs(tsl.display.at(x, y)[c] - reference.display.at(x, y)[c]));
            }
        EXPECT_GT(inside, 0.0f);
        EXPECT_LE(border, inside + steps / 255.0f) << pixelsPerChart << " pixels a chart";
    }
}

TEST_F(DrawTest, ADollyThroughLevelsDoesNotJump)
{
    const TestScene s = sphereScene(bumpyMaps(256, 1.0f, 60.0f));
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    std::vector<double> changes;
    Image before;
    for (int i = 0; i < 100; ++i) {
        renderer.render(
            cameraAt({0.0f, 0.3f, 9.0f * std::pow(0.988f, float(i))})); // 9 m to 2.7 m: two levels
        const Image now = renderer.readDisplay();
        if (i > 0)
            changes.push_back(compareImages(before, now).rmse);
        before = now;
    }
    // The sphere grows, and with it what a step of the camera changes: compare with the frames around.
    for (size_t i = 5; i + 5 < changes.size(); ++i) {
        std::vector<double> around(changes.begin() + long(i) - 5, changes.begin() + long(i) + 6);
        std::nth_element(around.begin(), around.begin() + 5, around.end());
        EXPECT_LT(changes[i], 2.0 * around[5]) << "frame " << i + 1;
    }
}

namespace {

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

} // namespace

TEST_F(DrawTest, OneCallForManyObjectsShowsTheSame)
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

TEST_F(DrawTest, MeshesShareBuffersUpToASize)
{
    std::vector<scene::Mesh> meshes;
    for (const int cells : {1, 2, 1, 30, 1, 1})
        meshes.push_back(planeMesh(cells));
    meshes[1].indices.resize(21); // an odd number: what follows is aligned all the same
    MeshBuffers buffers(device());
    gpu::UploadBatch batch(device());
    buffers.upload(batch, meshes, 20 * sizeof(shared::Vertex));
    batch.finish();
    const auto& parts = buffers.parts();
    ASSERT_EQ(parts.size(), meshes.size());
    EXPECT_EQ(parts[0].vertices.buffer, parts[1].vertices.buffer);
    EXPECT_EQ(parts[1].vertices.first, 4u);
    EXPECT_EQ(parts[1].vertices.address, parts[0].vertices.address + 4 * sizeof(shared::Vertex));
    EXPECT_EQ(parts[1].indices.first, 6u);
    EXPECT_EQ(parts[2].indices.first, 28u);
    EXPECT_EQ(parts[0].texels, parts[1].texels);
    EXPECT_NE(parts[3].vertices.buffer, parts[2].vertices.buffer); // too large to share
    EXPECT_NE(parts[3].texels, parts[2].texels);
    EXPECT_NE(parts[4].vertices.buffer, parts[3].vertices.buffer);
    EXPECT_EQ(parts[4].indices.buffer, parts[5].indices.buffer);
    for (const MeshParts& part : parts) {
        EXPECT_EQ(part.vertices.address % 8, 0u);
        EXPECT_EQ(part.indices.address % 8, 0u);
    }
}
