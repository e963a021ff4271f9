// Images as plain float arrays.
#pragma once
#include "image_format.h"
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace lumel {

// Row-major, channels interleaved, row 0 on top.
struct Image {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<float> pixels;

    Image() = default;
    Image(int w, int h, int c) : width(w), height(h), channels(c), pixels(size_t(w) * h * c) {}
    float* at(int x, int y) { return pixels.data() + (size_t(y) * width + x) * channels; }
    const float* at(int x, int y) const { return pixels.data() + (size_t(y) * width + x) * channels; }
    bool empty() const { return pixels.empty(); }
};

// Files that declare more pixels than this are refused before anything is allocated (image bombs).
inline constexpr size_t kMaxImagePixels = size_t(16384) * 16384;

// Throws Error, without a file's name, for a declared size beyond kMaxImagePixels of 4 channels, and for one
// of more than 4096 x 4096 that so few encoded bytes cannot hold: no PNG or JPEG packs 16384 pixels into one.
void checkImageSize(size_t width, size_t height, size_t channels, size_t encodedBytes);

// Reads the first image of a PNG, JPEG, WebP, EXR, HDR, TIFF or TGA file, told by its content. Integer
// formats map to [0, 1], floats stay as stored; no colour conversion. It is decoded in a process of its own,
// which main() must have made possible (decoder_process.h). Throws Error naming the file when it is missing,
// empty, not an image, damaged or too large.
Image readImage(const std::filesystem::path& file, size_t mostPixels = kMaxImagePixels);
// The same from memory (embedded glTF images), if it is of one of the formats; `name` is what messages call
// it.
Image readImage(std::span<const std::byte> bytes, const std::string& name,
                ImageFormats formats = kAllImageFormats);

// More of an image file.
struct ImageFile {
    std::vector<Image> levels; // finest first
    int width = 0, height = 0; // of the finest
    bool isFloat = false;      // stored as 32-bit floats
    std::vector<std::string> channelNames;
    std::map<std::string, std::string> attributes; // those in text that begin with "lumel:"
};
// The header alone, or all MIP levels down to 1 x 1 with it: of an EXR file with at most `mostPixelsPerByte`.
ImageFile readExrHeader(const std::filesystem::path& file);
ImageFile readExrLevels(const std::filesystem::path& file, size_t mostPixelsPerByte);

// Writes `file` whole or not at all. The extension chooses the format: .exr stores 16-bit half float,
// .png and .jpg store 8 bit (values clamped to [0, 1] and rounded; the caller applies sRGB).
void writeImage(const std::filesystem::path& file, const Image& image);

// The bytes of an 8-bit PNG file of the image (values as for writeImage): pictures inside other files.
std::vector<unsigned char> encodePng(const Image& image);

// The image at a greater size, linearly: splines ring around radiance's highlights, and without what falls
// below 0 the mean would rise.
Image upscaled(const Image& image, int width, int height);

// IEEE half floats, rounded to nearest; values beyond +-65504 become infinities.
void floatsToHalf(std::span<const float> from, uint16_t* to);
void halfToFloats(std::span<const uint16_t> from, float* to);

// sRGB transfer functions, IEC 61966-2-1, piecewise. Negative values stay linear.
float srgbToLinear(float encoded);
float linearToSrgb(float linear);

} // namespace lumel
