// Renderers of one scene share what is large, and show the same as with resources of their own.
#include "test_scene.h"

namespace lumel::test {
namespace {

class SharingTest : public GpuTest {};

constexpr glm::vec3 kEye{0.0f, 0.0f, 3.0f};

// What `make` leaves allocated.
template<class Make>
auto measured(uint64_t& bytes, Make make)
{
    const uint64_t before = device().memory().report().usedBytes();
    auto made = make();
    bytes = device().memory().report().usedBytes() - before;
    return made;
}

Image displayOf(Renderer& renderer)
{
    renderer.render(cameraAt(kEye));
    return renderer.readDisplay();
}

TEST_F(SharingTest, RenderersWithSharedResourcesAllocateNoneOfThem)
{
    const TestScene s = sphereScene(bumpyMaps(64, 0.3f, 50.0f));
    const Settings settings = settingsFor(Shading::tsl);
    uint64_t shared = 0, sharing = 0, own = 0;
    SceneResources resources = measured(shared, [&] { return uploadScene(device(), s.scene, s.materials); });
    auto first =
        measured(sharing, [&] { return std::make_unique<Renderer>(device(), s.scene, resources, settings); });
    auto second = std::make_unique<Renderer>(device(), s.scene, resources, settings);
    auto alone =
        measured(own, [&] { return std::make_unique<Renderer>(device(), s.scene, s.materials, settings); });
    EXPECT_GT(shared, 0u);
    EXPECT_EQ(sharing + shared, own);

    const Image expected = displayOf(*alone);
    EXPECT_EQ(displayOf(*first).pixels, expected.pixels);
    // The last renderer keeps alive what it needs.
    resources = {};
    first.reset();
    EXPECT_EQ(displayOf(*second).pixels, expected.pixels);
}

TEST_F(SharingTest, MaterialsOfAnotherMethodShareTheGeometry)
{
    const baker::Maps maps = bumpyMaps(64, 0.3f, 50.0f);
    TestScene s = sphereScene(maps);
    SceneResources resources = uploadScene(device(), s.scene, s.materials);
    s.materials[0].reflectance = baker::bake(maps, {.method = baker::Method::average});
    resources.materials = std::make_shared<MaterialResources>(device(), s.scene, s.materials);
    for (const Shading shading : {Shading::tsl, Shading::forward}) {
        Renderer sharing(device(), s.scene, resources, settingsFor(shading));
        Renderer alone(device(), s.scene, s.materials, settingsFor(shading));
        EXPECT_EQ(displayOf(sharing).pixels, displayOf(alone).pixels);
    }
}

// As the viewer does while it bakes.
TEST_F(SharingTest, MaterialsThatAreReplacedAreLitAgainInThePlaceOfTheOld)
{
    const baker::Maps maps = bumpyMaps(256, 0.3f, 50.0f);
    for (const Shading shading : {Shading::tsl, Shading::forward, Shading::reference}) {
        TestScene s = sphereScene(maps);
        s.add(planeMesh(), plainMaps());
        const scene::Reflectance baked = s.materials[0].reflectance;
        const scene::Reflectance placeholder = s.materials[0].reflectance = baker::placeholder(maps, {});
        const SceneResources resources = uploadScene(device(), s.scene, s.materials);
        Renderer renderer(device(), s.scene, resources, settingsFor(shading));
        const Image before = displayOf(renderer);
        for (int frame = 0; frame < 6; ++frame) // to the state in which nothing is lit
            displayOf(renderer);
        const gpu::MemoryReport memory = device().memory().report();
        resources.materials->replace(device(), 0, placeholder, baked);
        renderer.changeMaterial(0);
        EXPECT_EQ(device().memory().report().usedBytes(), memory.usedBytes());
        const Image after = displayOf(renderer);
        s.materials[0].reflectance = baked;
        Renderer fresh(device(), s.scene, s.materials, settingsFor(shading));
        EXPECT_TRUE(after.pixels == displayOf(fresh).pixels) << int(shading);
        // The reference reads the finest level, which placeholders have as it is.
        EXPECT_EQ(before.pixels == after.pixels, shading == Shading::reference) << int(shading);
    }
}

// A plane whose texels have second lobes, or none, as a renderer shows it that began with the other.
struct Exchanged {
    TestScene scene;
    SceneResources resources;
    std::unique_ptr<Renderer> renderer;
    scene::Reflectance before, after;

    Exchanged(baker::LobeCount from, baker::LobeCount to, const Settings& settings)
    {
        const baker::Maps maps = bumpyMaps(256, 0.3f, 200.0f);
        scene.add(planeMesh(4), maps);
        scene.add(sphereMesh(), plainMaps(), glm::translate(glm::mat4(1.0f), {0.0f, 0.0f, 0.5f}));
        scene.scene.lights = {sun({-0.4f, -0.5f, -1.0f})};
        before = scene.materials[0].reflectance = baker::bake(maps, {.lobes = from});
        after = baker::bake(maps, {.lobes = to});
        resources = uploadScene(device(), scene.scene, scene.materials);
        renderer = std::make_unique<Renderer>(device(), scene.scene, resources, settings);
    }

    Image frame(Renderer& of) const
    {
        of.render(cameraAt({0.0f, -5.0f, 4.0f}));
        return of.readDisplay();
    }

    // Lit from the surface cache, as the sun has moved.
    Image litAgain(Renderer& of) const
    {
        for (int i = 0; i < 10; ++i)
            frame(of);
        of.setLights({sun({0.5f, -0.2f, -1.0f})});
        return frame(of);
    }
};

uint64_t bytesOfSecondLobes(const scene::Reflectance& reflectance)
{
    return reflectance.second.byteCount() + reflectance.secondSpecular.byteCount();
}

TEST_F(SharingTest, SecondLobesComeAndGoInThePlaceOfTheOld)
{
    using enum baker::LobeCount;
    for (const auto& [from, to] : {std::pair(one, two), std::pair(two, one)})
        for (const Shading shading : {Shading::tsl, Shading::forward}) {
            Exchanged e(from, to, settingsFor(shading));
            ASSERT_NE(e.before.hasSecond(), e.after.hasSecond());
            for (int i = 0; i < 10; ++i)
                e.frame(*e.renderer);
            const gpu::MemoryReport memory = device().memory().report();
            e.resources.materials->replace(device(), 0, e.before, e.after);
            e.renderer->changeMaterial(0);
            const double gained = double(device().memory().report().usedBytes()) - double(memory.usedBytes());
            const double second = double(bytesOfSecondLobes(e.after)) - double(bytesOfSecondLobes(e.before));
            EXPECT_NEAR(gained / second, 1.0, 0.2);
            const Image after = e.frame(*e.renderer);
            e.scene.materials[0].reflectance = e.after;
            Renderer fresh(device(), e.scene.scene, e.scene.materials, settingsFor(shading));
            EXPECT_TRUE(after.pixels == e.frame(fresh).pixels) << int(shading);
            EXPECT_TRUE(e.litAgain(*e.renderer).pixels == e.litAgain(fresh).pixels) << int(shading);
        }
}

TEST_F(SharingTest, SecondLobesThatAreExpectedHaveTheirPipelines)
{
    for (const Shading shading : {Shading::tsl, Shading::forward}) {
        Settings settings = settingsFor(shading);
        settings.budgetMs = 40.0;
        Exchanged e(baker::LobeCount::one, baker::LobeCount::two, settings);
        e.renderer->expectSecondLobes({0});
        for (int i = 0; i < 6; ++i)
            e.frame(*e.renderer);
        const uint64_t created = gpu::hostWork().pipelinesCreated;
        e.resources.materials->replace(device(), 0, e.before, e.after);
        e.renderer->changeMaterial(0);
        for (int i = 0; i < 10; ++i)
            e.frame(*e.renderer);
        EXPECT_EQ(gpu::hostWork().pipelinesCreated, created) << int(shading);
    }
}

// As `bench --objects` does.
TEST_F(SharingTest, APartOfTheObjectsUsesTheResourcesOfAll)
{
    TestScene s = sphereScene(plainMaps());
    s.add(planeMesh(), bumpyMaps(32, 0.3f, 50.0f));
    const SceneResources resources = uploadScene(device(), s.scene, s.materials);
    s.scene.objects.erase(s.scene.objects.begin());
    Renderer sharing(device(), s.scene, resources, settingsFor(Shading::tsl));
    Renderer alone(device(), s.scene, s.materials, settingsFor(Shading::tsl));
    EXPECT_EQ(displayOf(sharing).pixels, displayOf(alone).pixels);
}

} // namespace
} // namespace lumel::test
