// Anisotropic material lookups of forward shading (--forward-anisotropy).
#include "test_scene.h"

namespace lumel::test {
namespace {

// Stripes that run away from the camera, as footprints' major axes do: an isotropic lookup, as wide as these
// are long, blurs them.
TestScene stripedPlane()
{
    baker::Maps maps = bumpyMaps(128, 0.01f, 60.0f);
    maps.diffuse = Image(128, 128, 3);
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x)
            std::fill_n(maps.diffuse.at(x, y), 3, x / 4 % 2 == 0 ? 0.8f : 0.05f);
    TestScene s;
    s.add(planeMesh(), maps);
    s.scene.lights = {sun({-0.4f, -0.5f, -1.0f})};
    return s;
}

const scene::Camera kGrazing = cameraAt({0.0f, -1.6f, 0.22f}, {0.0f, 0.2f, 0.0f});

Image rendered(const TestScene& s, Shading shading, int anisotropy)
{
    Settings settings = settingsFor(shading);
    settings.samples = 128;
    settings.forwardAnisotropy = anisotropy;
    return shoot(s, kGrazing, settings).display;
}

using ForwardAnisotropy = GpuTest;

TEST_F(ForwardAnisotropy, ComesCloserToTheReferenceAtAGrazingAngle)
{
    const TestScene s = stripedPlane();
    const Image reference = rendered(s, Shading::reference, 1);
    double before = 0.0;
    for (const int anisotropy : {1, 2, 4, 8}) {
        const double now = psnr(rendered(s, Shading::forward, anisotropy), reference);
        RecordProperty("psnr" + std::to_string(anisotropy), std::to_string(now));
        EXPECT_GT(now, before + 0.5) << anisotropy;
        before = now;
    }
    EXPECT_EQ(rendered(s, Shading::reference, 8).pixels, reference.pixels)
        << "it has no MIP levels to choose";
}

// The lobes of many taps are one wide lobe: steep bumps under a sun that is reflected towards the camera.
TEST_F(ForwardAnisotropy, SpreadOfNormalsAmongTheTapsWidensTheLobe)
{
    TestScene s;
    baker::Options exact;
    exact.precision = 0.0f;
    s.add(planeMesh(), bumpyMaps(128, 0.15f, 1000.0f), glm::mat4(1.0f), exact);
    s.scene.lights = {sun({0.0f, -1.0f, -0.3f})};
    const Image reference = rendered(s, Shading::reference, 1);
    const double isotropic = psnr(rendered(s, Shading::forward, 1), reference);
    const double anisotropic = psnr(rendered(s, Shading::forward, 8), reference);
    RecordProperty("psnr1", std::to_string(isotropic));
    RecordProperty("psnr8", std::to_string(anisotropic));
    EXPECT_GT(anisotropic, isotropic + 8.0); // 5 dB without the spread
}

} // namespace
} // namespace lumel::test
