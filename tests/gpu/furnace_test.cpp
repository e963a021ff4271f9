// A white furnace: light of 1 from everywhere. White metals return it whatever their roughness, dielectrics
// no more than it, in every shading, from an environment and from lights. LUMEL_TABLE=1 prints what each
// sphere returns.
#include "scene/environment.h"
#include "shared/energy.h"
#include "test_scene.h"
#include <cstdlib>
#include <numbers>

namespace lumel::test {
namespace {

constexpr float kRoughnesses[] = {0.12f, 0.2f, 0.3f, 0.5f, 0.7f, 0.8f, 0.9f, 1.0f};
constexpr int kColumns = int(std::size(kRoughnesses));
constexpr int kPixels = 80; // a cell; its sphere is a little smaller
constexpr float kSpacing = 2.2f;

// Above, white metals; below, white dielectrics.
TestScene spheres()
{
    TestScene s;
    for (int column = 0; column < kColumns; ++column)
        for (const bool metal : {true, false}) {
            const float power = shared::powerFromRoughness(kRoughnesses[column]);
            baker::Maps maps = plainMaps(glm::vec3(metal ? 0.0f : 0.96f), power);
            maps.anisotropicPower = {power, power};
            maps.specularConstant = glm::vec3(metal ? 1.0f : 0.04f);
            const glm::vec3 place((float(column) - 0.5f * float(kColumns - 1)) * kSpacing,
                                  metal ? 0.5f * kSpacing : -0.5f * kSpacing, 0.0f);
            s.add(sphereMesh(48, 96), maps, glm::translate(glm::mat4(1.0f), place));
        }
    return s;
}

void addEnvironment(TestScene& s)
{
    Image white(32, 16, 3);
    std::fill(white.pixels.begin(), white.pixels.end(), 1.0f);
    s.scene.environment = std::make_shared<const scene::Environment>(scene::makeEnvironment(white));
}

// An even dome all around: a spiral of equal areas.
void addLights(TestScene& s)
{
    constexpr int kLights = 256;
    for (int i = 0; i < kLights; ++i) {
        const float y = 1.0f - 2.0f * (float(i) + 0.5f) / kLights, r = std::sqrt(1.0f - y * y);
        const float turn = float(i) * std::numbers::pi_v<float> * (3.0f - std::sqrt(5.0f));
        s.scene.lights.push_back(
            sun({r * std::cos(turn), y, r * std::sin(turn)}, 4.0f * std::numbers::pi_v<float> / kLights));
    }
}

// The mean over a sphere's disc, less its rim.
double returned(const Image& radiance, int column, bool metal)
{
    const float radius = 0.96f / kSpacing * kPixels;
    const glm::vec2 centre((float(column) + 0.5f) * kPixels, (metal ? 0.5f : 1.5f) * kPixels);
    double sum = 0.0;
    int count = 0;
    for (int y = 0; y < radiance.height; ++y)
        for (int x = 0; x < radiance.width; ++x)
            if (glm::distance(glm::vec2(x, y) + 0.5f, centre) < radius) {
                sum += double(radiance.at(x, y)[1]);
                ++count;
            }
    return sum / count;
}

class Furnace : public GpuTest {
protected:
    // tolerance: for the smoothest metal, whose highlights of single lights are one pixel wide; all others 2
    // %.
    void expectAllReturned(const TestScene& s, const char* light, double tolerance)
    {
        const scene::Camera camera = cameraAt({0, 0, 200}, glm::vec3(0), 2.0f * std::atan(kSpacing / 200.0f));
        for (const Shading way : {Shading::reference, Shading::forward, Shading::tsl}) {
            Settings settings = settingsFor(way, {kColumns * kPixels, 2 * kPixels});
            settings.samples = 9;
            settings.shadows = false;
            const Image radiance = shoot(s, camera, settings).radiance;
            const char* name = way == Shading::reference ? "reference"
                               : way == Shading::forward ? "forward"
                                                         : "tsl";
            for (const bool metal : {true, false}) {
                if (std::getenv("LUMEL_TABLE"))
                    std::printf("%-12s %-10s %-10s", light, name, metal ? "metal" : "dielectric");
                for (int column = 0; column < kColumns; ++column) {
                    const double all = returned(radiance, column, metal);
                    if (std::getenv("LUMEL_TABLE"))
                        std::printf(" %.3f", all);
                    if (metal)
                        EXPECT_NEAR(all, 1.0, column == 0 ? tolerance : 0.02)
                            << light << " " << name << " roughness " << kRoughnesses[column];
                    else
                        EXPECT_TRUE(all > 0.95 && all < 1.01)
                            << all << " " << light << " " << name << " roughness " << kRoughnesses[column];
                }
                if (std::getenv("LUMEL_TABLE"))
                    std::printf("\n");
            }
        }
    }
};

TEST_F(Furnace, EnvironmentsAreReturned)
{
    TestScene s = spheres();
    addEnvironment(s);
    expectAllReturned(s, "environment", 0.02);
}

TEST_F(Furnace, LightsFromEverywhereAreReturned)
{
    TestScene s = spheres();
    addLights(s);
    expectAllReturned(s, "256 lights", 0.03);
}

} // namespace
} // namespace lumel::test
