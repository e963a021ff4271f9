// Deforming meshes: the GPU's vertices against the CPU's, and pictures of all shadings against
// the reference while they move.
#include "core/compare.h"
#include "scene/environment.h"
#include "shared/tint.h"
#include "test_scene.h"

using namespace lumel;
using namespace lumel::test;

namespace {

// A plane of 16 x 16 quads under a skin of two joints, the left and the right half with a soft change, and a
// morph target that bulges it.
TestScene deformingScene(const baker::Maps& maps = bumpyMaps(128, 1.0f, 60.0f))
{
    TestScene s;
    scene::Mesh mesh = planeMesh(16);
    scene::Deformation& d = mesh.deformation;
    d.jointsPerVertex = 2;
    d.extents = {mesh.bounds, {Bounds{{0, 0, 0}, {0, 0, 0.5f}}}, {{0, mesh.bounds}, {1, mesh.bounds}}};
    for (const shared::Vertex& v : mesh.vertices) {
        const float right = glm::smoothstep(-0.5f, 0.5f, v.position.x);
        d.influences.insert(d.influences.end(), {{0, 1.0f - right}, {1, right}});
        d.firstDeltas.push_back(uint32_t(d.deltas.size()));
        const glm::vec2 p(v.position);
        const float bulge = 0.5f * std::max(1.0f - glm::dot(p, p), 0.0f);
        if (bulge > 0.0f)
            d.deltas.push_back({0, {0, 0, bulge}, {p.x, p.y, 0.0f}, {0, 0, -p.x}});
    }
    d.firstDeltas.push_back(uint32_t(d.deltas.size()));
    s.add(mesh, maps);
    s.scene.skins = {{{scene::Joint{}, scene::Joint{}}}};
    s.scene.deformed.emplace_back();
    s.scene.deformed[0].skin = 0;
    s.scene.deformed[0].weights = {0.0f};
    s.scene.objects[0].deformed = 0;
    s.scene.lights = {sun({-0.4f, -0.5f, -1}), sun({1, 0.3f, -1}, 1.0f)};
    return s;
}

scene::Shapes shapeAt(float seconds)
{
    const auto turned = [](float angle) {
        return glm::rotate(glm::mat4(1.0f), angle, glm::vec3(0.2f, 1, 0));
    };
    return {{{turned(0.3f * seconds),
              glm::scale(turned(-0.9f * seconds), glm::vec3(1.0f, 1.0f + 0.2f * seconds, 1.0f))}},
            {{std::sin(seconds)}}};
}

void setShape(TestScene& s, float seconds)
{
    const scene::Shapes shapes = shapeAt(seconds);
    for (size_t j = 0; j < 2; ++j)
        s.scene.skins[0].joints[j].worldFromJoint = shapes.joints[0][j];
    s.scene.deformed[0].weights = shapes.weights[0];
}

const scene::Camera kFront = cameraAt({0.4f, 0.6f, 3.6f});

// The first mesh's colours show in all shadings, and white ones change nothing.
void expectTints(const TestScene& s)
{
    const Picture reference = shoot(s, kFront, settingsFor(Shading::reference));
    EXPECT_GT(psnr(shoot(s, kFront, settingsFor(Shading::tsl)).display, reference.display), 36.0);
    EXPECT_GT(psnr(shoot(s, kFront, multisampled(Shading::forward)).display, reference.display), 36.0);
    TestScene white = s;
    for (glm::vec4& colour : white.scene.meshes[0].colours)
        colour = glm::vec4(1.0f);
    TestScene none = white;
    none.scene.meshes[0].colours.clear();
    for (const Shading shading : {Shading::tsl, Shading::forward}) {
        const Image without = shoot(none, kFront, settingsFor(shading)).display;
        EXPECT_GT(psnr(shoot(white, kFront, settingsFor(shading)).display, without), 60.0);
        EXPECT_LT(psnr(shoot(s, kFront, settingsFor(shading)).display, without), 25.0);
    }
}

} // namespace

using DeformTest = GpuTest;

TEST_F(DeformTest, TheGpuPutsVerticesWhereTheCpuDoes)
{
    const TestScene s = deformingScene();
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::forward));
    for (const float t : {0.0f, 0.7f, 1.3f}) {
        const scene::Shapes shapes = shapeAt(t);
        renderer.deform(shapes);
        renderer.render(kFront);
        const gpu::Buffer& buffer = renderer.scene().deformedMeshes().items()[0].vertices;
        const auto bytes = gpu::readBack(device(), buffer, buffer.size());
        std::vector<shared::Vertex> found(bytes.size() / sizeof(shared::Vertex));
        std::memcpy(found.data(), bytes.data(), bytes.size());
        const auto expected = deformedVertices(s.scene.meshes[0], shapes.joints[0], shapes.weights[0]);
        ASSERT_EQ(found.size(), expected.size());
        for (size_t i = 0; i < found.size(); ++i) {
            EXPECT_LT(glm::distance(found[i].position, expected[i].position), 1e-5f);
            EXPECT_LT(glm::distance(found[i].normal, expected[i].normal), 1e-5f);
            EXPECT_LT(glm::distance(found[i].tangent, expected[i].tangent), 1e-5f);
            EXPECT_EQ(found[i].uv, expected[i].uv);
        }
    }
}

TEST_F(DeformTest, AllShadingsAgreeWithTheReferenceAtEveryTime)
{
    TestScene s = deformingScene(plainMaps());
    for (const float t : {0.0f, 0.7f, 1.4f}) {
        setShape(s, t);
        const Picture reference = shoot(s, kFront, settingsFor(Shading::reference));
        EXPECT_GT(psnr(shoot(s, kFront, multisampled(Shading::tsl)).display, reference.display), 36.0) << t;
        EXPECT_GT(psnr(shoot(s, kFront, multisampled(Shading::forward)).display, reference.display), 36.0)
            << t;
    }
}

TEST_F(DeformTest, WhatStandsStillKeepsItsLumelsAndWhatMovesIsLitAgain)
{
    TestScene s = deformingScene();
    s.add(planeMesh(), plainMaps(), glm::translate(glm::mat4(1.0f), glm::vec3(0, 0, -1.5f)));
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    renderer.deform(shapeAt(0.4f));
    EXPECT_GT(renderer.render(kFront).lumelsLit, 0u);
    for (int i = 0; i < 5; ++i) {
        renderer.deform(shapeAt(0.4f)); // the animation pauses
        const FrameStats stats = renderer.render(kFront);
        EXPECT_EQ(stats.lumelsLit, 0u) << i;
        EXPECT_FALSE(stats.passMs.contains("deform")) << i;
    }
    renderer.deform(shapeAt(0.9f));
    const FrameStats stats = renderer.render(kFront);
    EXPECT_GT(stats.lumelsLit, 0u);
    EXPECT_TRUE(stats.passMs.contains("deform"));
    for (uint32_t i = 0; i < FeedbackPass::kCycle; ++i)
        renderer.render(kFront); // until the sub-pixel offsets have met every tile
    setShape(s, 0.9f);
    EXPECT_GT(psnr(renderer.readDisplay(), shoot(s, kFront, settingsFor(Shading::tsl)).display), 45.0);
}

// The shadow of a deforming object follows it, whether the camera sees what casts it or the ground alone.
TEST_F(DeformTest, AShadowFollowsWhatDeforms)
{
    TestScene s = deformingScene(plainMaps());
    s.add(planeMesh(8), plainMaps(),
          glm::translate(glm::mat4(1.0f), {1, 0, -1.5f}) * glm::scale(glm::mat4(1.0f), glm::vec3(4)));
    s.scene.lights = {sun({1, 0, -1})};
    const scene::Camera ground = cameraAt({2.6f, 0, 1.5f}, {2.6f, 0, -1.5f}, 0.5f);
    for (const scene::Camera& camera : {cameraAt({1, -4, 3}, {1, 0, -1}), ground}) {
        const bool outOfView = camera.yFov == ground.yFov;
        Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
        setShape(s, 0.0f);
        const Picture before = shoot(s, camera, settingsFor(Shading::reference));
        renderer.deform(shapeAt(0.0f));
        EXPECT_EQ(renderer.render(camera).objectsCulled, outOfView ? 1u : 0u);
        EXPECT_GT(psnr(renderer.readDisplay(), before.display), 33.0);
        setShape(s, 1.2f);
        const Picture after = shoot(s, camera, settingsFor(Shading::reference));
        EXPECT_LT(psnr(after.display, before.display), 22.0);
        renderer.deform(shapeAt(1.2f));
        const FrameStats stats = renderer.render(camera);
        EXPECT_GT(stats.passMs.at("shadow"), 0.0);
        EXPECT_GT(stats.lumelsLit, 0u);
        EXPECT_GT(psnr(renderer.readDisplay(), after.display), 33.0);
        // A pause: its map is as good as new.
        renderer.deform(shapeAt(1.2f));
        EXPECT_FALSE(renderer.render(camera).passMs.contains("shadow"));
    }
}

TEST_F(DeformTest, TheSameMotionGivesTheSameBits)
{
    const TestScene s = deformingScene();
    const auto play = [&] {
        Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl));
        for (int i = 0; i < 6; ++i) {
            renderer.deform(shapeAt(0.2f * float(i)));
            renderer.render(kFront);
        }
        return renderer.readRadiance().pixels;
    };
    EXPECT_EQ(play(), play());
}

TEST_F(DeformTest, JointsBringWhatWasOutOfViewIntoItAsItsNodeWould)
{
    const TestScene s = deformingScene();
    Renderer byJoints(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    Renderer byNode(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    for (const float x : {50.0f, 0.5f}) {
        const glm::mat4 m = glm::translate(glm::mat4(1.0f), glm::vec3(x, 0, 0));
        byJoints.deform({{{m, m}}, {{0.0f}}});
        byNode.moveObject(0, m);
        const FrameStats stats = byJoints.render(kFront);
        EXPECT_EQ(stats.objectsCulled, x > 1.0f ? 1u : 0u);
        EXPECT_EQ(byNode.render(kFront).lumelsLit, stats.lumelsLit);
    }
    EXPECT_GT(psnr(byJoints.readDisplay(), byNode.readDisplay()), 60.0);
}

TEST_F(DeformTest, JointsThatMirrorShowTheFront)
{
    const TestScene s = deformingScene(plainMaps());
    const glm::mat4 mirror = glm::scale(glm::mat4(1.0f), glm::vec3(-1, 1, 1));
    Settings settings = settingsFor(Shading::tsl);
    Renderer renderer(device(), s.scene, s.materials, settings);
    renderer.deform({{{mirror, mirror}}, {{0.0f}}});
    renderer.render(kFront);
    // The plane is symmetric, and so is its material.
    EXPECT_GT(psnr(renderer.readDisplay(), shoot(s, kFront, settings).display), 35.0);
}

TEST_F(DeformTest, VertexColoursTintEveryShading)
{
    TestScene s;
    scene::Mesh mesh = planeMesh(8);
    for (const shared::Vertex& v : mesh.vertices)
        mesh.colours.emplace_back(0.5f + 0.5f * v.position.x, 0.5f + 0.5f * v.position.y, 0.2f, 1.0f);
    s.add(mesh, plainMaps());
    s.add(planeMesh(), plainMaps(), glm::translate(glm::mat4(1.0f), glm::vec3(0.5f, 0, -1)));
    s.scene.lights = {sun({-0.3f, 0.2f, -1.0f})};
    for (const auto& environment : {std::shared_ptr<const scene::Environment>(),
                                    std::make_shared<const scene::Environment>(scene::skyEnvironment())}) {
        s.scene.environment = environment;
        expectTints(s);
    }
}

TEST(Tint, AColourChangesWhatIsMetalOnly)
{
    // Base colour b, metal by the share m, reflectance d of what is not: as baked, then with the colour c.
    for (const float d : {0.04f, 0.02f, 0.1f})
        for (const float m : {0.0f, 0.25f, 0.6f, 0.999f})
            for (const float b : {0.2f, 0.7f, 1.0f})
                for (const float c : {0.0f, 0.5f, 1.0f}) {
                    const float specular = d * (1.0f - m) + b * m, diffuse = b * (1.0f - m) * (1.0f - d);
                    EXPECT_NEAR(shared::tintedSpecular(specular, diffuse, d, c), d * (1.0f - m) + c * b * m,
                                2e-3f)
                        << d << ' ' << m << ' ' << b << ' ' << c;
                }
}

TEST(Tint, ADarkChannelOfAMetalIsTintedToo)
{
    // A red metal reflects less green and blue than what is not metal.
    const glm::vec3 metal(0.9f, 0.03f, 0.01f), colour(0.5f, 0.25f, 0.0f);
    const glm::vec3 tinted = shared::tintedSpecular(metal, glm::vec3(0.0f), 0.04f, colour);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(tinted[c], metal[c] * colour[c], 1e-6f) << c;
    // What is not metal at all keeps its reflectance, however dark it is.
    const glm::vec3 plain = shared::tintedSpecular(glm::vec3(0.04f), {0.5f, 0.01f, 0.0f}, 0.04f, colour);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(plain[c], 0.04f, 1e-6f) << c;
}
