#include "decode.h"
#include "error.h"
#include "exr_header.h"
#include "image.h"
#include "webp.h"
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

namespace lumel {
namespace {

constexpr int kMostChannels = 64;

// glTF's colours are not multiplied by their alpha, and normal or roughness maps with a fourth channel
// even less; OpenImageIO's readers would do it.
OIIO::ImageSpec asStored()
{
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    return config;
}

const char* readerName(ImageFormat format)
{
    switch (format) {
    case ImageFormat::png:
        return "png";
    case ImageFormat::jpeg:
        return "jpeg";
    case ImageFormat::exr:
        return "openexr";
    case ImageFormat::hdr:
        return "hdr";
    case ImageFormat::tiff:
        return "tiff";
    default:
        return "targa";
    }
}

[[noreturn]] void failDamaged(const std::string& why)
{
    throw Error(fmt::format("damaged image ({}); export it again", why.substr(0, why.find('\n'))));
}

// libjpeg goes on after damage, with grey, and only warns; it also warns of what does no harm. Other readers
// have no harmless messages.
bool tellsDamage(const std::string& message, ImageFormat format)
{
    if (message.empty() || format != ImageFormat::jpeg)
        return !message.empty();
    for (const char* words : {"remature end", "bad Huffman code", "instead of RST"})
        if (message.find(words) != std::string::npos)
            return true;
    return false;
}

SampleType sampleType(const OIIO::TypeDesc& type)
{
    return type == OIIO::TypeDesc::UINT8    ? SampleType::u8
           : type == OIIO::TypeDesc::UINT16 ? SampleType::u16
           : type == OIIO::TypeDesc::HALF   ? SampleType::half
                                            : SampleType::f32;
}

OIIO::TypeDesc typeDesc(SampleType type)
{
    return type == SampleType::u8     ? OIIO::TypeDesc::UINT8
           : type == SampleType::u16  ? OIIO::TypeDesc::UINT16
           : type == SampleType::half ? OIIO::TypeDesc::HALF
                                      : OIIO::TypeDesc::FLOAT;
}

void checkSize(const DecodedShape& shape, size_t bytes, const DecodeRequest& request)
{
    const size_t pixels = size_t(shape.width) * size_t(shape.height);
    checkImageSize(size_t(shape.width), size_t(shape.height), size_t(shape.channels), bytes);
    if (pixels > request.mostPixels)
        throw Error(fmt::format("{} x {} pixels, at most {} are allowed; scale it down", shape.width,
                                shape.height, request.mostPixels));
    if (pixels / request.mostPixelsPerByte > bytes)
        throw Error(fmt::format("{} x {} pixels cannot be in {} bytes; export it again", shape.width,
                                shape.height, bytes));
}

DecodedShape shapeOf(const OIIO::ImageSpec& spec, const DecodeRequest& request)
{
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.depth > 1 || spec.deep)
        throw Error("not a 2D image; export it as PNG, JPEG, TIFF or EXR");
    if (spec.nchannels > kMostChannels)
        throw Error(
            fmt::format("{} channels, at most {} are read; export fewer", spec.nchannels, kMostChannels));
    DecodedShape shape{spec.width, spec.height, spec.nchannels, 1, sampleType(spec.format), {}, {}};
    if (request.part == ImagePart::finest)
        return shape;
    shape.channelNames = spec.channelnames;
    for (const OIIO::ParamValue& value : spec.extra_attribs)
        if (value.name().string().starts_with("lumel:") && value.type() == OIIO::TypeDesc::STRING)
            shape.attributes[value.name().string()] = value.get_string();
    if (request.part == ImagePart::allLevels)
        for (int size = std::max(spec.width, spec.height); size > 1; size /= 2)
            ++shape.levels;
    return shape;
}

void readLevels(OIIO::ImageInput& input, const DecodedShape& shape, ImageFormat format, std::byte* to)
{
    int width = shape.width, height = shape.height;
    for (int level = 0; level < shape.levels; ++level) {
        if (level > 0 && (!input.seek_subimage(0, level) || input.spec().width != width ||
                          input.spec().height != height || input.spec().nchannels != shape.channels))
            throw Error(
                fmt::format("level {} of {} x {} pixels is missing; export it again", level, width, height));
        const bool ok = input.read_image(0, level, 0, shape.channels, typeDesc(shape.type), to);
        const std::string message = input.geterror();
        if (!ok || tellsDamage(message, format))
            failDamaged(message);
        to += size_t(width) * size_t(height) * size_t(shape.channels) * bytesOf(shape.type);
        width = std::max(1, width / 2);
        height = std::max(1, height / 2);
    }
}

DecodedShape decodeWebp(std::span<const std::byte> bytes, const DecodeRequest& request,
                        const PixelAllocator& allocate)
{
    const WebpSize size = readWebpSize(bytes);
    const DecodedShape shape{size.width, size.height, size.channels, 1, SampleType::u8, {}, {}};
    checkSize(shape, bytes.size(), request);
    if (request.part != ImagePart::header)
        readWebp(bytes, size, allocate(shape));
    return shape;
}

} // namespace

size_t bytesOf(SampleType type)
{
    return type == SampleType::u8 ? 1 : type == SampleType::f32 ? 4 : 2;
}

void toFloats(const std::byte* from, SampleType type, std::span<float> to)
{
    // As a picture of one channel, whose rows OpenImageIO shares among its threads, and a rest.
    constexpr size_t kRow = size_t(1) << 14;
    const size_t rows = to.size() / kRow, rest = rows * kRow;
    if (rows > 0)
        OIIO::parallel_convert_image(1, int(kRow), int(rows), 1, from, typeDesc(type), OIIO::AutoStride,
                                     OIIO::AutoStride, OIIO::AutoStride, to.data(), OIIO::TypeDesc::FLOAT,
                                     OIIO::AutoStride, OIIO::AutoStride, OIIO::AutoStride);
    if (to.size() > rest)
        OIIO::convert_pixel_values(typeDesc(type), from + rest * bytesOf(type), OIIO::TypeDesc::FLOAT,
                                   &to[rest], int(to.size() - rest));
}

size_t DecodedShape::samples() const
{
    size_t pixels = 0;
    for (int level = 0; level < levels; ++level)
        pixels += size_t(std::max(1, width >> level)) * size_t(std::max(1, height >> level));
    return pixels * size_t(channels);
}

DecodedShape decode(std::span<const std::byte> bytes, const DecodeRequest& request,
                    const PixelAllocator& allocate)
{
    const ImageFormat format = imageFormat(bytes, request.namedTga != 0);
    if ((request.formats & formatBit(format)) == 0)
        throw Error(fmt::format("its content is not {}; export it as {}", formatNames(request.formats),
                                request.formats == formatBit(ImageFormat::exr) ? "EXR" : "PNG"));
    if (format == ImageFormat::webp)
        return decodeWebp(bytes, request, allocate);
    if (format == ImageFormat::exr)
        checkExrHeader(bytes);
    OIIO::Filesystem::IOMemReader reader(const_cast<std::byte*>(bytes.data()), bytes.size());
    const auto input = OIIO::ImageInput::create(readerName(format));
    if (!input || !input->set_ioproxy(&reader))
        throw Error(fmt::format("OpenImageIO cannot read {} from memory; install its version 2.4",
                                formatNames(formatBit(format))));
    input->threads(1); // several images are decoded at once
    OIIO::ImageSpec spec;
    if (!input->open("image", spec, asStored()))
        failDamaged(input->geterror());
    const DecodedShape shape = shapeOf(spec, request);
    checkSize(shape, bytes.size(), request);
    if (request.part != ImagePart::header)
        readLevels(*input, shape, format, allocate(shape));
    return shape;
}

} // namespace lumel
