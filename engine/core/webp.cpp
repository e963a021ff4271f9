#include "webp.h"
#include "error.h"
#include <cstring>
#include <fmt/format.h>
#include <webp/decode.h>

namespace lumel {

bool isWebp(std::span<const std::byte> bytes)
{
    return bytes.size() >= 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 &&
           std::memcmp(bytes.data() + 8, "WEBP", 4) == 0;
}

Image readWebp(std::span<const std::byte> bytes, const std::string& name)
{
    const auto* data = reinterpret_cast<const uint8_t*>(bytes.data());
    WebPBitstreamFeatures features;
    if (WebPGetFeatures(data, bytes.size(), &features) != VP8_STATUS_OK || features.width < 1 ||
        features.height < 1)
        throw Error(fmt::format("{}: damaged WebP image; export it again", name));
    if (features.has_animation)
        throw Error(fmt::format("{}: animated WebP image; export a still one", name));
    const int channels = features.has_alpha ? 4 : 3;
    checkImageSize(size_t(features.width), size_t(features.height), size_t(channels), bytes.size(), name);
    std::vector<uint8_t> texels(size_t(features.width) * size_t(features.height) * size_t(channels));
    const int stride = features.width * channels;
    const bool ok = features.has_alpha
                        ? WebPDecodeRGBAInto(data, bytes.size(), texels.data(), texels.size(), stride)
                        : WebPDecodeRGBInto(data, bytes.size(), texels.data(), texels.size(), stride);
    if (!ok)
        throw Error(fmt::format("{}: damaged WebP image; export it again", name));
    Image image(features.width, features.height, channels);
    for (size_t i = 0; i < texels.size(); ++i)
        image.pixels[i] = float(texels[i]) / 255.0f;
    return image;
}

} // namespace lumel
