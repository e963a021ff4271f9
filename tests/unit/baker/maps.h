// Small deterministic maps for the baker's tests.
#pragma once
#include "baker/bake.h"
#include <cmath>
#include <random>

namespace lumel::baker::test {

inline Image constantImage(int w, int h, std::vector<float> value)
{
    Image image(w, h, int(value.size()));
    for (size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = value[i % value.size()];
    return image;
}

// Normals with independent Gaussian slopes of deviation `slope`, stored as [0, 1].
inline Image noiseNormals(int w, int h, float slope, unsigned seed)
{
    std::mt19937 random(seed);
    std::normal_distribution<float> gauss(0.0f, slope);
    Image image(w, h, 3);
    for (int i = 0; i < w * h; ++i) {
        const glm::vec3 n = glm::normalize(glm::vec3(gauss(random), gauss(random), 1.0f));
        for (int c = 0; c < 3; ++c)
            image.pixels[size_t(i) * 3 + size_t(c)] = 0.5f * n[c] + 0.5f;
    }
    return image;
}

// Smooth periodic bumps: sums of sines with integer wave counts.
inline Image bumps(int w, int h)
{
    Image image(w, h, 1);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            const float u = 6.2831853f * float(x) / float(w), v = 6.2831853f * float(y) / float(h);
            *image.at(x, y) = 0.5f + 0.2f * std::sin(3 * u + std::cos(2 * v)) +
                              0.15f * std::sin(5 * v - 2 * u) + 0.1f * std::cos(7 * u + 4 * v);
        }
    return image;
}

// Grooves along y: every row is the same.
inline Image grooves(int w, int h, int count)
{
    Image image(w, h, 1);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x)
            *image.at(x, y) = 0.5f + 0.5f * std::sin(6.2831853f * float(count * x) / float(w) + 0.3f);
    return image;
}

inline Maps normalMaps(Image normal, float power)
{
    Maps maps;
    maps.normal = std::move(normal);
    maps.powerConstant = power;
    maps.specularConstant = glm::vec3(1.0f);
    return maps;
}

inline Maps heightMaps(Image height, float scale, float power)
{
    Maps maps;
    maps.height = std::move(height);
    maps.heightScale = scale;
    maps.powerConstant = power;
    maps.specularConstant = glm::vec3(1.0f);
    return maps;
}

// Without the approximations that make the fit fast.
inline Options exactly()
{
    Options options;
    options.precision = 0.0f;
    return options;
}

inline double meanOf(const Level& level, int channel)
{
    double sum = 0.0;
    for (size_t i = size_t(channel); i < level.texels.size(); i += kChannels)
        sum += level.texels[i];
    return sum / double(level.texels.size() / kChannels);
}

} // namespace lumel::baker::test
