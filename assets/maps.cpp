#include "maps.h"
#include "core/error.h"
#include "core/file.h"
#include <OpenImageIO/imageio.h>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace lumel::assets {
namespace {

// Calls shade(x, y) for every pixel, rows in parallel. Each pixel depends on its position alone, so
// the result does not depend on the number of threads.
template<class Shade>
void fill(Image& image, const Shade& shade)
{
    tbb::parallel_for(0, image.height, [&](int y) {
        for (int x = 0; x < image.width; ++x)
            shade(x, y);
    });
}

// dh/dx and dh/dy in heights per map width; y counts downwards.
glm::vec2 gradient(const Image& height, int x, int y)
{
    const int right = std::min(x + 1, height.width - 1), left = std::max(x - 1, 0);
    const int below = std::min(y + 1, height.height - 1), above = std::max(y - 1, 0);
    const float dx = (*height.at(right, y) - *height.at(left, y)) / float(right - left);
    const float dy = (*height.at(x, below) - *height.at(x, above)) / float(below - above);
    return float(height.width) * glm::vec2(dx, dy);
}

} // namespace

HeightMap makeHeight(int size, const std::function<float(glm::vec2)>& height)
{
    HeightMap map;
    map.image = Image(size, size, 1);
    fill(map.image, [&](int x, int y) { *map.image.at(x, y) = height(glm::vec2(x, y) + 0.5f); });
    const auto [lowest, highest] = std::minmax_element(map.image.pixels.begin(), map.image.pixels.end());
    const float offset = *lowest, range = std::max(*highest - *lowest, 1e-20f);
    for (float& value : map.image.pixels)
        value = (value - offset) / range;
    map.scale = range;
    return map;
}

Image makeColour(int size, const std::function<glm::vec3(glm::vec2)>& linearColour)
{
    Image image(size, size, 3);
    fill(image, [&](int x, int y) {
        const glm::vec3 colour = linearColour(glm::vec2(x, y) + 0.5f);
        for (int c = 0; c < 3; ++c)
            image.at(x, y)[c] = linearToSrgb(colour[c]);
    });
    return image;
}

void setSlope(HeightMap& map, float slopeRms, const std::function<bool(glm::vec2)>& inside)
{
    double sum = 0.0, count = 0.0;
    for (int y = 0; y < map.image.height; ++y)
        for (int x = 0; x < map.image.width; ++x) {
            if (!inside(glm::vec2(x, y) + 0.5f))
                continue;
            const glm::vec2 g = gradient(map.image, x, y);
            sum += glm::dot(g, g);
            count += 1.0;
        }
    map.scale = slopeRms / float(std::sqrt(sum / count));
}

Image normalFromHeight(const HeightMap& map)
{
    Image normals(map.image.width, map.image.height, 3);
    fill(normals, [&](int x, int y) {
        const glm::vec2 slope = map.scale * gradient(map.image, x, y);
        const glm::vec3 n = glm::normalize(glm::vec3(-slope.x, slope.y, 1.0f));
        for (int c = 0; c < 3; ++c)
            normals.at(x, y)[c] = 0.5f * n[c] + 0.5f;
    });
    return normals;
}

void writePng(const std::filesystem::path& file, const Image& image, int bits)
{
    writeAtomically(file, [&](const std::filesystem::path& temporary) {
        const auto type = bits == 16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8;
        OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
        spec.attribute("png:compressionLevel", 1); // speed: these files never leave the build folder
        auto output = OIIO::ImageOutput::create(temporary.string());
        if (!output || !output->open(temporary.string(), spec) ||
            !output->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data()) || !output->close())
            throw Error(fmt::format("{}: cannot be written", file.string()));
    });
}

} // namespace lumel::assets
