// How different two pictures are: every quality claim of the project is made with these numbers.
#pragma once
#include "image.h"

namespace lumel {

struct Comparison {
    double rmse = 0.0;          // over all pixels and RGB, in display values [0, 1] (tone-mapped sRGB)
    double psnr = 0.0;          // dB, 20 log10(1 / rmse); infinity when equal
    double maxDifference = 0.0; // largest absolute difference of one channel
    size_t yeeFailures = 0;     // pixels that look different: OpenImageIO's compare_Yee (Yee and Newman 2004)
};

// Both pictures: RGB display values in [0, 1], same size. Throws Error when sizes differ.
Comparison compareImages(const Image& a, const Image& b);

// The same without the perceptual count, which takes most of the time.
Comparison compareQuickly(const Image& a, const Image& b);

// |a - b| times `gain`, RGB.
Image differenceImage(const Image& a, const Image& b, float gain = 4.0f);

// Reads a picture as RGB display values: .exr holds linear radiance and is tone-mapped as the renderer does
// at exposure 1, anything else is taken as sRGB already.
Image readDisplayImage(const std::filesystem::path& file);

} // namespace lumel
