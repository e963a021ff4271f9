// Small baked chains and folders for the export's tests.
#pragma once
#include "../baker/maps.h"
#include "export/export.h"
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace lumel::baker::test {

struct Folder {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("lumel-export-test-" + std::to_string(::getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() { std::filesystem::remove_all(path); }
};

// Smoothly varying roughness in [0.2, 0.7].
inline Image roughnessMap(int w, int h)
{
    Image image = bumps(w, h);
    for (float& value : image.pixels)
        value = 0.2f + 0.5f * std::clamp(value, 0.0f, 1.0f);
    return image;
}

// Uneven normals, roughness and colour.
inline Maps unevenMaps(int w, int h, float slope = 0.2f)
{
    Maps maps;
    maps.normal = noiseNormals(w, h, slope, 7);
    maps.roughness = roughnessMap(w, h);
    maps.specularConstant = glm::vec3(0.04f);
    maps.diffuse = Image(w, h, 3);
    for (size_t i = 0; i < maps.diffuse.pixels.size(); ++i)
        maps.diffuse.pixels[i] = 0.1f + 0.6f * float(i * 37 % 101) / 101.0f;
    return maps;
}

// One export map of a single texel format, with a chain of levels of uneven values.
inline ExportMap unevenMap(int w, int h, int channels, bool srgb = false)
{
    ExportMap map{"uneven", srgb ? ColourSpace::srgb : ColourSpace::linear, false, {}, {}};
    for (int c = 0; c < channels; ++c)
        map.channels.push_back({std::string(1, "RGBA"[c]), "", "value"});
    for (;; w = std::max(1, w / 2), h = std::max(1, h / 2)) {
        Image image(w, h, channels);
        for (int y = 0; y < h; ++y)
            for (int x = 0; x < w; ++x)
                for (int c = 0; c < channels; ++c)
                    image.at(x, y)[c] =
                        0.5f + 0.45f * std::sin(0.07f * float(x) + 0.05f * float(y * (c + 1)) + float(w + c));
        map.levels.push_back(std::move(image));
        if (w == 1 && h == 1)
            return map;
    }
}

inline double psnr(double squaredError, size_t count)
{
    return 10.0 * std::log10(double(count) / std::max(squaredError, 1e-20));
}

} // namespace lumel::baker::test
