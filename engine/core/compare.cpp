#include "compare.h"
#include "error.h"
#include "shared/tonemap.h"
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace lumel {
namespace {

void checkSameSize(const Image& a, const Image& b)
{
    if (a.width != b.width || a.height != b.height)
        throw Error(
            fmt::format("pictures differ in size ({} x {} and {} x {}); render both with the same --size",
                        a.width, a.height, b.width, b.height));
}

OIIO::ImageBuf wrap(const Image& image)
{
    OIIO::ImageBuf buffer(OIIO::ImageSpec(image.width, image.height, image.channels, OIIO::TypeDesc::FLOAT));
    buffer.set_pixels(OIIO::ROI::All(), OIIO::TypeDesc::FLOAT, image.pixels.data());
    return buffer;
}

} // namespace

Comparison compareQuickly(const Image& a, const Image& b)
{
    checkSameSize(a, b);
    Comparison result;
    double sum = 0.0;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        const double difference = std::abs(double(a.pixels[i]) - double(b.pixels[i]));
        sum += difference * difference;
        result.maxDifference = std::max(result.maxDifference, difference);
    }
    result.rmse = std::sqrt(sum / double(a.pixels.size()));
    result.psnr =
        result.rmse > 0.0 ? -20.0 * std::log10(result.rmse) : std::numeric_limits<double>::infinity();
    return result;
}

Comparison compareImages(const Image& a, const Image& b)
{
    Comparison result = compareQuickly(a, b);
    OIIO::ImageBufAlgo::CompareResults yee;
    const OIIO::ImageBuf bufferA = wrap(a), bufferB = wrap(b);
    result.yeeFailures = size_t(OIIO::ImageBufAlgo::compare_Yee(bufferA, bufferB, yee));
    return result;
}

Image differenceImage(const Image& a, const Image& b, float gain)
{
    checkSameSize(a, b);
    Image difference(a.width, a.height, a.channels);
    for (size_t i = 0; i < a.pixels.size(); ++i)
        difference.pixels[i] = gain * std::abs(a.pixels[i] - b.pixels[i]);
    return difference;
}

Image readDisplayImage(const std::filesystem::path& file)
{
    const Image read = readImage(file);
    Image rgb(read.width, read.height, 3);
    const bool linear = file.extension() == ".exr";
    for (int y = 0; y < read.height; ++y)
        for (int x = 0; x < read.width; ++x) {
            const float* from = read.at(x, y);
            glm::vec3 colour(from[0], from[read.channels > 2 ? 1 : 0], from[read.channels > 2 ? 2 : 0]);
            if (linear)
                colour = shared::displayColour(colour, 1.0f);
            std::copy_n(&colour.x, 3, rgb.at(x, y));
        }
    return rgb;
}

} // namespace lumel
