// The images of one material, decoded once each and brought to common coordinates and sizes.
#pragma once
#include "core/image.h"
#include "scene.h"
#include <array>
#include <deque>
#include <map>

namespace lumel::scene {

// Channel c of a texel, as if the image had rgb: grey images have one channel, or two with alpha.
inline float texel(const Image& image, int x, int y, int c)
{
    return image.at(x, y)[image.channels >= 3 ? c : 0];
}

// 1 where the image has none. Grey or colour, alpha is last.
inline float alphaOf(const Image& image, int x, int y)
{
    return image.channels == 2 || image.channels == 4 ? image.at(x, y)[image.channels - 1] : 1.0f;
}

// Bilinear at texel centres; the border repeats, which is glTF's default.
Image resized(const Image& in, int width, int height);

// Occlusion, roughness and metalness often share a file.
class MaterialImages {
public:
    explicit MaterialImages(const Scene& scene) : scene_(scene) {}

    // As stored; null for index -1.
    const Image* get(int index);
    // The same at the coordinates that it shares with others.
    const Image* get(int index, const UvMapping& own, const UvMapping& common);
    // Linear colours of an image of sRGB ones; its alpha is linear as it is. Decoded before anything is
    // resampled, as texture units do: a mean of light is a mean of linear values.
    const Image* colours(int index, const UvMapping& own, const UvMapping& common);

private:
    const Image* placed(const Image* image, const UvMapping& own, const UvMapping& common);

    const Scene& scene_;
    std::map<int, Image> decoded_, colours_;
    std::deque<Image> moved_;
};

// Images brought to the size of the largest one. Any may be null: constant.
template<size_t N>
struct SameSize {
    std::array<const Image*, N> images;
    int width = 1, height = 1;

    explicit SameSize(const std::array<const Image*, N>& sources) : images(sources)
    {
        for (const Image* image : images)
            if (image) {
                width = std::max(width, image->width);
                height = std::max(height, image->height);
            }
        for (size_t i = 0; i < N; ++i)
            if (images[i] && (images[i]->width != width || images[i]->height != height)) {
                storage_[i] = resized(*images[i], width, height);
                images[i] = &storage_[i];
            }
    }
    SameSize(const SameSize&) = delete;

    // Channel c of MaterialImages::colours(), and of others as stored; 1 without an image.
    float colour(size_t i, int x, int y, int c) const { return value(i, x, y, c); }
    float value(size_t i, int x, int y, int c) const { return images[i] ? texel(*images[i], x, y, c) : 1.0f; }
    float alpha(size_t i, int x, int y) const { return images[i] ? alphaOf(*images[i], x, y) : 1.0f; }

private:
    std::array<Image, N> storage_;
};

} // namespace lumel::scene
