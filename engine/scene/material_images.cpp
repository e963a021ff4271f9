#include "material_images.h"
#include "core/progress.h"
#include <algorithm>
#include <cmath>

namespace lumel::scene {
namespace {

// sRGB decoding of 8-bit images by table: std::pow for each of 2048^2 texels would take longer than PNG.
float decodeSrgb(float encoded)
{
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values;
        for (size_t i = 0; i < values.size(); ++i)
            values[i] = srgbToLinear(float(i) / 255.0f);
        return values;
    }();
    const float scaled = encoded * 255.0f;
    const float nearest = std::nearbyint(scaled);
    if (nearest >= 0.0f && nearest <= 255.0f && std::abs(scaled - nearest) < 1e-4f)
        return table[size_t(nearest)];
    return srgbToLinear(encoded);
}

Image linear(Image image)
{
    const int colours = image.channels >= 3 ? 3 : 1;
    for (size_t i = 0; i < image.pixels.size(); i += size_t(image.channels))
        for (int c = 0; c < colours; ++c)
            image.pixels[i + size_t(c)] = decodeSrgb(image.pixels[i + size_t(c)]);
    return image;
}

int wrapped(int i, int size, Wrap wrap)
{
    const auto modulo = [](int a, int n) { return (a % n + n) % n; };
    if (wrap == Wrap::clamp)
        return std::clamp(i, 0, size - 1);
    if (wrap == Wrap::repeat)
        return modulo(i, size);
    const int twice = modulo(i, 2 * size);
    return twice < size ? twice : 2 * size - 1 - twice;
}

// The image as it appears at coordinates `common`, where its own are `own`, both of one set; as fine as it
// is.
Image moved(const Image& in, const UvMapping& own, const UvMapping& common)
{
    constexpr float kMostTexels = 4096.0f;
    const glm::mat3 relative = *mappingBetween(common, own);
    const glm::vec2 inSize(in.width, in.height);
    const auto texelsAlong = [&](glm::vec3 step) {
        return int(std::clamp(std::ceil(glm::length(glm::vec2(step) * inSize) - 0.01f), 1.0f, kMostTexels));
    };
    Image out(texelsAlong(relative[0]), texelsAlong(relative[1]), in.channels);
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            const glm::vec2 p = (glm::vec2(x, y) + 0.5f) / glm::vec2(out.width, out.height);
            const glm::vec2 q = glm::clamp(glm::vec2(relative * glm::vec3(p, 1.0f)) * inSize - 0.5f,
                                           glm::vec2(-1e9f), glm::vec2(1e9f));
            const glm::ivec2 first(glm::floor(q));
            const glm::vec2 f = q - glm::floor(q);
            for (int corner = 0; corner < 4; ++corner) {
                const int i = corner & 1, j = corner >> 1;
                const float weight = (i ? f.x : 1.0f - f.x) * (j ? f.y : 1.0f - f.y);
                const float* from = in.at(wrapped(first.x + i, in.width, own.wrapU),
                                          wrapped(first.y + j, in.height, own.wrapV));
                for (int c = 0; c < in.channels; ++c)
                    out.at(x, y)[c] += weight * from[c];
            }
        }
    return out;
}

} // namespace

Image resized(const Image& in, int width, int height)
{
    Image out(width, height, in.channels);
    const auto wrap = [](int i, int size) { return (i % size + size) % size; };
    for (int y = 0; y < height; ++y) {
        const float sy = (float(y) + 0.5f) * float(in.height) / float(height) - 0.5f;
        const int y0 = wrap(int(std::floor(sy)), in.height), y1 = wrap(int(std::floor(sy)) + 1, in.height);
        const float fy = sy - std::floor(sy);
        for (int x = 0; x < width; ++x) {
            const float sx = (float(x) + 0.5f) * float(in.width) / float(width) - 0.5f;
            const int x0 = wrap(int(std::floor(sx)), in.width), x1 = wrap(int(std::floor(sx)) + 1, in.width);
            const float fx = sx - std::floor(sx);
            for (int c = 0; c < in.channels; ++c) {
                const float upper = in.at(x0, y0)[c] * (1.0f - fx) + in.at(x1, y0)[c] * fx;
                const float lower = in.at(x0, y1)[c] * (1.0f - fx) + in.at(x1, y1)[c] * fx;
                out.at(x, y)[c] = upper * (1.0f - fy) + lower * fy;
            }
        }
    }
    return out;
}

const Image* MaterialImages::get(int index)
{
    if (index < 0)
        return nullptr;
    checkInterrupted();
    const SceneImage& source = scene_.images[size_t(index)];
    auto found = decoded_.find(index);
    if (found == decoded_.end())
        found = decoded_.emplace(index, readImage(source.bytes, source.name, kGltfImageFormats)).first;
    return &found->second;
}

const Image* MaterialImages::get(int index, const UvMapping& own, const UvMapping& common)
{
    return placed(get(index), own, common);
}

const Image* MaterialImages::colours(int index, const UvMapping& own, const UvMapping& common)
{
    const Image* encoded = get(index);
    if (!encoded)
        return nullptr;
    auto found = colours_.find(index);
    if (found == colours_.end())
        found = colours_.emplace(index, linear(*encoded)).first;
    return placed(&found->second, own, common);
}

const Image* MaterialImages::placed(const Image* image, const UvMapping& own, const UvMapping& common)
{
    if (!image || own.set != common.set || own.matrix() == common.matrix() || !mappingBetween(common, own))
        return image;
    return &moved_.emplace_back(moved(*image, own, common));
}

} // namespace lumel::scene
