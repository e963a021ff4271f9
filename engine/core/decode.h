// Image files' bytes into pixels. These libraries crash on some damaged files: readImage() lets a process of
// its own do this (decoder_process.h).
#pragma once
#include "image_format.h"
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace lumel {

enum class SampleType : uint32_t { u8, u16, half, f32 };
size_t bytesOf(SampleType type);
// Integers become [0, 1].
void toFloats(const std::byte* from, SampleType type, std::span<float> to);

enum class ImagePart : uint32_t {
    header,    // no pixels
    finest,    // the first image of the file
    allLevels, // all its MIP levels, each half as large as the one before, rounded down, to 1 x 1
};

struct DecodeRequest {
    ImagePart part = ImagePart::finest;
    ImageFormats formats = kAllImageFormats;
    uint32_t namedTga = 0;
    uint64_t mostPixels = ~uint64_t(0);        // of the finest level, beside what checkImageSize() says
    uint64_t mostPixelsPerByte = ~uint64_t(0); // of the file
};

// What a file holds. The pixels follow level by level, row by row, channels interleaved.
struct DecodedShape {
    int32_t width = 0, height = 0, channels = 0, levels = 0;
    SampleType type = SampleType::f32;
    // Not read for ImagePart::finest.
    std::vector<std::string> channelNames;
    std::map<std::string, std::string> attributes; // those in text that begin with "lumel:"

    size_t samples() const; // of all levels
};

// Called once the file's header is known and accepted: returns memory for the pixels.
using PixelAllocator = std::function<std::byte*(const DecodedShape&)>;

// Throws Error, without the file's name, for what is no image of the formats asked for, damaged or too large.
DecodedShape decode(std::span<const std::byte> bytes, const DecodeRequest& request,
                    const PixelAllocator& allocate);

} // namespace lumel
