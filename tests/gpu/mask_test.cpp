// Surfaces behind alpha masks and blended surfaces are lit as finely as those beside them.
#include "test_scene.h"
#include <cmath>
#include <fmt/format.h>

namespace lumel::test {
namespace {

constexpr glm::uvec2 kViewSize{320, 180};
constexpr float kMaskDistance = 0.5f; // above the floor
constexpr int kTexels = 64;

// A chessboard of `cells` per side, as a MIP chain: white is kept, black is cut out.
scene::HalfChain chessOpacity(int cells, int texels = kTexels)
{
    std::vector<Image> chain;
    Image level(texels, texels, 1);
    for (int y = 0; y < texels; ++y)
        for (int x = 0; x < texels; ++x)
            *level.at(x, y) = float((x * cells / texels + y * cells / texels) % 2);
    chain.push_back(level);
    while (chain.back().width > 1) {
        const Image& fine = chain.back();
        Image half(fine.width / 2, fine.height / 2, 1);
        for (int y = 0; y < half.height; ++y)
            for (int x = 0; x < half.width; ++x)
                *half.at(x, y) = 0.25f * (*fine.at(2 * x, 2 * y) + *fine.at(2 * x + 1, 2 * y) +
                                          *fine.at(2 * x, 2 * y + 1) + *fine.at(2 * x + 1, 2 * y + 1));
        chain.push_back(half);
    }
    return scene::HalfChain(chain);
}

// A bumpy floor; in front of its left half a sheet with a chessboard cut out of it.
TestScene sheetOverFloor(scene::AlphaMode mode, int cells)
{
    static const TestScene floor = [] {
        TestScene baked;
        baked.add(planeMesh(8), bumpyMaps(256, 0.3f, 60.0f));
        return baked;
    }();
    TestScene s = floor;
    baker::Maps sheet = plainMaps(glm::vec3(0.7f, 0.2f, 0.1f));
    sheet.normal = Image(kTexels, kTexels, 3);
    for (size_t i = 0; i < sheet.normal.pixels.size(); ++i)
        sheet.normal.pixels[i] = i % 3 == 2 ? 1.0f : 0.5f;
    const glm::mat4 left = glm::translate(glm::mat4(1.0f), {-1.0f, 0.0f, kMaskDistance});
    s.add(planeMesh(), sheet, left);
    s.scene.materials[1].alphaMode = mode;
    s.materials[1].opacity = chessOpacity(cells);
    s.scene.lights = {sun({-0.4f, -0.5f, -1.0f})};
    return s;
}

const scene::Camera kAbove = cameraAt({0.0f, 0.0f, 2.6f});

// What is seen at each pixel: the sheet's cell and how far its border is, in pixels; beside it, the floor.
enum class Seen { neither, hole, beside };
Seen seenAt(int x, int y, int cells)
{
    const float tangent = std::tan(0.5f * kAbove.yFov);
    const glm::vec2 ndc(2.0f * (float(x) + 0.5f) / float(kViewSize.x) - 1.0f,
                        1.0f - 2.0f * (float(y) + 0.5f) / float(kViewSize.y));
    const glm::vec2 slope = ndc * tangent * glm::vec2(float(kViewSize.x) / float(kViewSize.y), 1.0f);
    const glm::vec2 floor = slope * kAbove.eye.z, sheet = slope * (kAbove.eye.z - kMaskDistance);
    if (std::max(std::abs(floor.x), std::abs(floor.y)) > 0.95f)
        return Seen::neither;
    const float margin = 3.0f * 2.0f * tangent * kAbove.eye.z / float(kViewSize.y); // 3 pixels
    if (sheet.x > margin)
        return Seen::beside;
    const glm::vec2 uv(0.5f * (sheet.x + 2.0f), 0.5f * (1.0f - sheet.y));
    const glm::vec2 cell = uv * float(cells), within = cell - glm::floor(cell);
    const float edge = std::min(std::min(within.x, within.y), 1.0f - std::max(within.x, within.y));
    const bool hole = (int(cell.x) + int(cell.y)) % 2 == 0;
    return hole && edge * 2.0f / float(cells) > margin && sheet.x < -margin ? Seen::hole : Seen::neither;
}

double psnrWhere(const Image& a, const Image& b, Seen what, int cells)
{
    double sum = 0.0;
    size_t count = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x)
            if (seenAt(x, y, cells) == what)
                for (int c = 0; c < 3; ++c, ++count)
                    sum += std::pow(double(a.at(x, y)[c]) - double(b.at(x, y)[c]), 2.0);
    EXPECT_GT(count, 3u * 500u);
    return -10.0 * std::log10(sum / double(count));
}

class Mask : public GpuTest {};

TEST_F(Mask, WhatHolesShowIsAsGoodAsWhatLiesBesideThem)
{
    constexpr int kCells = 4;
    const TestScene s = sheetOverFloor(scene::AlphaMode::mask, kCells);
    const auto picture = [&](Shading way) {
        Settings settings = settingsFor(way, kViewSize);
        settings.shadows = false; // whose borders are behind the sheet alone
        return shoot(s, kAbove, settings).display;
    };
    const Image reference = picture(Shading::reference), tsl = picture(Shading::tsl);
    const double holes = psnrWhere(tsl, reference, Seen::hole, kCells);
    const double beside = psnrWhere(tsl, reference, Seen::beside, kCells);
    std::cout << fmt::format("first frame: {:.1f} dB through the holes, {:.1f} dB beside\n", holes, beside);
    EXPECT_GT(holes, beside - 1.0);
}

// Leaves: holes of a few pixels, and a camera that moves, so that a frame's samples are few.
TEST_F(Mask, FineHolesInMotionShowFineLight)
{
    constexpr int kCells = 16;
    TestScene s = sheetOverFloor(scene::AlphaMode::mask, kCells);
    s.materials[1].opacity = chessOpacity(kCells);
    Renderer renderer(device(), s.scene, s.materials, settingsFor(Shading::tsl, kViewSize));
    scene::Camera camera = cameraAt({0.6f, 0.1f, 2.6f}, {0.6f, 0.1f, 0.0f});
    for (int i = 0; i < 12; ++i) { // sideways, until the sheet is in view as above
        renderer.render(camera);
        camera.eye.x = camera.target.x -= 0.05f;
    }
    const Image moved = (renderer.render(camera), renderer.readDisplay());
    const Image forward = shoot(s, camera, settingsFor(Shading::forward, kViewSize)).display;
    const Image reference = shoot(s, camera, settingsFor(Shading::reference, kViewSize)).display;
    const auto leftHalf = [](const Image& image) {
        Image half(image.width / 2, image.height, 3);
        for (int y = 0; y < half.height; ++y)
            std::copy_n(image.at(0, y), 3 * half.width, half.at(0, y));
        return half;
    };
    const double ours = psnr(leftHalf(moved), leftHalf(reference));
    const double theirs = psnr(leftHalf(forward), leftHalf(reference));
    std::cout << fmt::format("in motion: tsl {:.1f} dB, forward {:.1f} dB\n", ours, theirs);
    EXPECT_GT(ours, theirs - 0.5);
}

// A veil hides nothing.
TEST_F(Mask, BlendedSurfacesHideNothing)
{
    TestScene s = sheetOverFloor(scene::AlphaMode::blend, 4);
    Image opacity(1, 1, 1);
    opacity.pixels = {0.2f};
    s.materials[1].opacity = scene::HalfChain({opacity});
    const Image reference = shoot(s, kAbove, settingsFor(Shading::reference, kViewSize)).display;
    const Image tsl = shoot(s, kAbove, settingsFor(Shading::tsl, kViewSize)).display;
    const double behind = psnrWhere(tsl, reference, Seen::hole, 4),
                 beside = psnrWhere(tsl, reference, Seen::beside, 4);
    std::cout << fmt::format("veil: {:.1f} dB behind, {:.1f} dB beside\n", behind, beside);
    EXPECT_GT(behind, beside - 1.0);
}

// The floor under a sheet that lies flat above it is lit through its holes only.
TEST_F(Mask, CutOutsCastShadowsWithHoles)
{
    constexpr int kCells = 4;
    TestScene s = sheetOverFloor(scene::AlphaMode::mask, kCells);
    s.scene.lights = {sun({0, 0, -1})};
    s.scene.objects[0].worldFromObject = glm::mat4(1.0f);
    for (const Shading way : {Shading::tsl, Shading::forward}) {
        const scene::Camera below = cameraAt({0.0f, -2.2f, 1.6f});
        Settings settings = settingsFor(way, kViewSize);
        const Image shadowed = shoot(s, below, settings).radiance;
        settings.shadows = false;
        const Image lit = shoot(s, below, settings).radiance;
        // Middles of cells on the floor; the camera looks under the sheet from the side.
        int holes = 0, shades = 0;
        const glm::mat4 clip =
            reversedPerspective(below.yFov, float(kViewSize.x) / float(kViewSize.y), 0.01f) *
            glm::lookAt(below.eye, below.target, below.up);
        for (int x = 2; x < kCells; ++x) {
            const int y = kCells - 1; // the nearest row, which nothing hides from here
            const glm::vec3 p(2.0f * (float(x) + 0.5f) / float(kCells) - 2.0f,
                              1.0f - 2.0f * (float(y) + 0.5f) / float(kCells), 0.0f);
            const glm::vec4 at = clip * glm::vec4(p, 1.0f);
            const glm::vec2 place = (glm::vec2(at) / at.w * 0.5f + 0.5f) * glm::vec2(kViewSize);
            const float share =
                *shadowed.at(int(place.x), int(place.y)) / *lit.at(int(place.x), int(place.y));
            if ((x + y) % 2 == 0) {
                EXPECT_GT(share, 0.95f) << x;
                ++holes;
            } else {
                EXPECT_LT(share, 0.3f) << x;
                ++shades;
            }
        }
        EXPECT_TRUE(holes > 0 && shades > 0);
    }
}

} // namespace
} // namespace lumel::test
