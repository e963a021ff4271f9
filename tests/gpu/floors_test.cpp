// The least that passes could take: measured for what the frame did, without a trace in the next picture.
#include "core/pass_names.h"
#include "test_scene.h"
#include <algorithm>

using namespace lumel;
using namespace lumel::test;

namespace {

class FloorsTest : public GpuTest {
protected:
    const TestScene scene_ = sphereScene(bumpyMaps(64, 0.3f, 50.0f));
    const scene::Camera camera_ = cameraAt({0.0f, 0.0f, 3.5f}), next_ = cameraAt({0.3f, 0.0f, 3.5f});
};

TEST_F(FloorsTest, EachShadingHasThoseOfItsPasses)
{
    for (const Shading shading : {Shading::tsl, Shading::forward})
        for (const int msaa : {1, 4}) {
            Settings settings = settingsFor(shading);
            settings.msaa = msaa;
            Renderer renderer(device(), scene_.scene, scene_.materials, settings);
            renderer.render(camera_);
            const FloorStats floors = renderer.measureFloors(camera_);
            for (const std::string name : kFloorNames) {
                ASSERT_EQ(floors.nanoseconds.contains(name),
                          (shading == Shading::forward) == (name == "forward"))
                    << name;
                if (floors.nanoseconds.contains(name)) {
                    EXPECT_GT(floors.nanoseconds.at(name), 0.0) << name;
                }
            }
        }
}

TEST_F(FloorsTest, CoverTheSamePixels)
{
    Renderer renderer(device(), scene_.scene, scene_.materials, settingsFor(Shading::tsl));
    const FrameStats stats = renderer.render(camera_);
    const double pixels = double(renderer.measureFloors(camera_).pixels);
    EXPECT_NEAR(pixels, double(stats.pixelsCovered), 0.05 * pixels); // the edge's are covered in part
}

TEST_F(FloorsTest, AFrameThatLitNothingHasNoneOfLight)
{
    Renderer renderer(device(), scene_.scene, scene_.materials, settingsFor(Shading::tsl));
    for (int i = 0; i < 20; ++i)
        renderer.render(camera_);
    const FloorStats floors = renderer.measureFloors(camera_);
    EXPECT_FALSE(floors.nanoseconds.contains("light"));
    EXPECT_FALSE(floors.nanoseconds.contains("lower"));
    EXPECT_TRUE(floors.nanoseconds.contains("bicubic_two_levels"));
}

TEST_F(FloorsTest, ChangeNoPicture)
{
    for (const Shading shading : {Shading::tsl, Shading::forward}) {
        Renderer measured(device(), scene_.scene, scene_.materials, settingsFor(shading));
        Renderer plain(device(), scene_.scene, scene_.materials, settingsFor(shading));
        for (const scene::Camera& camera : {camera_, next_, next_}) {
            measured.render(camera);
            measured.measureFloors(camera);
            plain.render(camera);
            EXPECT_EQ(measured.readDisplay().pixels, plain.readDisplay().pixels);
        }
    }
}

} // namespace
