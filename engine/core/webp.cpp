#include "webp.h"
#include "error.h"
#include <cstdint>
#include <webp/decode.h>

namespace lumel {

WebpSize readWebpSize(std::span<const std::byte> bytes)
{
    const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(data, bytes.size(), &features) != VP8_STATUS_OK || features.width < 1 ||
        features.height < 1)
        throw Error("damaged WebP image; export it again");
    if (features.has_animation)
        throw Error("animated WebP image; export a still one");
    return {features.width, features.height, features.has_alpha ? 4 : 3};
}

void readWebp(std::span<const std::byte> bytes, const WebpSize& size, std::byte* pixels)
{
    const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
    auto* to = reinterpret_cast<uint8_t*>(pixels);
    const int stride = size.width * size.channels;
    const size_t count = size_t(stride) * size_t(size.height);
    const bool ok = size.channels == 4 ? WebPDecodeRGBAInto(data, bytes.size(), to, count, stride)
                                       : WebPDecodeRGBInto(data, bytes.size(), to, count, stride);
    if (!ok)
        throw Error("damaged WebP image; export it again");
}

} // namespace lumel
