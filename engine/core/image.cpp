#include "image.h"
#include "decoder_process.h"
#include "error.h"
#include "file.h"
#include "shared/tonemap.h"
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>

namespace lumel {
namespace {

// OpenImageIO's messages can span lines; ours are one line each.
std::string firstLine(std::string text)
{
    return text.substr(0, text.find('\n'));
}

ImageFile readAny(Descriptor file, const DecodeRequest& request, const std::string& name)
{
    try {
        ImageFile result;
        SampleType type = SampleType::f32;
        const auto allocate = [&](const DecodedShape& shape) {
            type = shape.type;
            result = {.levels = {},
                      .width = shape.width,
                      .height = shape.height,
                      .isFloat = type == SampleType::f32,
                      .channelNames = shape.channelNames,
                      .attributes = shape.attributes};
            for (int level = 0; level < shape.levels && request.part != ImagePart::header; ++level)
                result.levels.emplace_back(std::max(1, shape.width >> level),
                                           std::max(1, shape.height >> level), shape.channels);
        };
        const Mapping pixels = decodeElsewhere(std::move(file), request, allocate);
        const std::byte* from = pixels.bytes().data();
        for (Image& image : result.levels) {
            toFloats(from, type, image.pixels);
            from += image.pixels.size() * bytesOf(type);
        }
        return result;
    } catch (const Error& e) { // where it is decoded, it has no name
        throw Error(fmt::format("{}: {}", name, e.what()));
    }
}

Descriptor openImage(const std::filesystem::path& file)
{
    const std::string name = file.string();
    std::error_code code;
    const auto status = std::filesystem::status(file, code);
    if (!std::filesystem::exists(status))
        throw Error(fmt::format("{}: no such file; check the path", name));
    if (std::filesystem::is_directory(status))
        throw Error(fmt::format("{}: is a folder; name an image file in it", name));
    if (!std::filesystem::is_regular_file(status))
        throw Error(fmt::format("{}: not a regular file; name an image file", name));
    if (std::filesystem::file_size(file, code) == 0)
        throw Error(fmt::format("{}: empty file (0 bytes); export it again", name));
    Descriptor opened(open(name.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (opened.get() < 0)
        throw Error(
            fmt::format("{}: cannot be read ({}); check its permissions", name, std::strerror(errno)));
    return opened;
}

ImageFile readFrom(const std::filesystem::path& file, DecodeRequest request)
{
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    request.namedTga = ending == ".tga";
    return readAny(openImage(file), request, file.string());
}

} // namespace

void checkImageSize(size_t width, size_t height, size_t channels, size_t encodedBytes)
{
    constexpr size_t kFewPixels = size_t(4096) * 4096, kMaxPixelsPerByte = 16384;
    const size_t pixels = width * height; // each at most 2^31
    if (pixels > kMaxImagePixels || pixels * channels > 4 * kMaxImagePixels)
        throw Error(fmt::format("{} x {} pixels of {} channels exceed the limit of 16384 x 16384 of 4; "
                                "scale it down",
                                width, height, channels));
    if (pixels > kFewPixels && pixels / kMaxPixelsPerByte > encodedBytes)
        throw Error(fmt::format("{} x {} pixels cannot be in {} bytes; export it again", width, height,
                                encodedBytes));
}

Image readImage(const std::filesystem::path& file, size_t mostPixels)
{
    return std::move(readFrom(file, {.mostPixels = mostPixels}).levels.front());
}

Image readImage(std::span<const std::byte> bytes, const std::string& name, ImageFormats formats)
{
    if (bytes.empty())
        throw Error(fmt::format("{}: empty image; export it again", name));
    return std::move(readAny(memoryFile(bytes), {.formats = formats}, name).levels.front());
}

ImageFile readExrHeader(const std::filesystem::path& file)
{
    return readFrom(file, {.part = ImagePart::header, .formats = formatBit(ImageFormat::exr)});
}

ImageFile readExrLevels(const std::filesystem::path& file, size_t mostPixelsPerByte)
{
    return readFrom(file, {.part = ImagePart::allLevels,
                           .formats = formatBit(ImageFormat::exr),
                           .mostPixelsPerByte = mostPixelsPerByte});
}

void writeImage(const std::filesystem::path& file, const Image& image)
{
    const std::string extension = file.extension().string();
    OIIO::TypeDesc type;
    if (extension == ".exr")
        type = OIIO::TypeDesc::HALF;
    else if (extension == ".png" || extension == ".jpg" || extension == ".jpeg")
        type = OIIO::TypeDesc::UINT8;
    else
        throw Error(fmt::format("{}: unknown picture format; end the name in .png or .exr", file.string()));
    writeAtomically(file, [&](const std::filesystem::path& temporary) {
        auto output = OIIO::ImageOutput::create(temporary.string());
        OIIO::ImageSpec spec(image.width, image.height, image.channels, type);
        // A fixed date: the same picture is the same file, whenever it is made.
        spec.attribute("DateTime", "1970:01:01 00:00:00"); // erased, the EXR writer would add the present one
        spec.attribute("oiio:UnassociatedAlpha", 1);
        if (extension == ".png")
            spec.attribute("png:compressionLevel", 6);
        else if (extension == ".exr")
            spec.attribute("compression", "zip");
        if (!output || !output->open(temporary.string(), spec) ||
            !output->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data()) || !output->close())
            throw Error(fmt::format("{}: cannot be written ({})", file.string(),
                                    firstLine(output ? output->geterror() : OIIO::geterror())));
    });
}

std::vector<unsigned char> encodePng(const Image& image)
{
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput memory(bytes);
    auto output = OIIO::ImageOutput::create("png");
    OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeDesc::UINT8);
    spec.attribute("DateTime", "1970:01:01 00:00:00");
    spec.attribute("oiio:UnassociatedAlpha", 1);
    if (!output || !output->set_ioproxy(&memory) || !output->open("memory.png", spec) ||
        !output->write_image(OIIO::TypeDesc::FLOAT, image.pixels.data()) || !output->close())
        throw Error(fmt::format("a picture cannot be encoded as PNG ({})",
                                firstLine(output ? output->geterror() : OIIO::geterror())));
    return bytes;
}

Image upscaled(const Image& image, int width, int height)
{
    const OIIO::ImageSpec from(image.width, image.height, image.channels, OIIO::TypeDesc::FLOAT);
    const OIIO::ImageSpec to(width, height, image.channels, OIIO::TypeDesc::FLOAT);
    Image result(width, height, image.channels);
    const OIIO::ImageBuf source(from, const_cast<float*>(image.pixels.data()));
    OIIO::ImageBuf target(to, result.pixels.data());
    if (!OIIO::ImageBufAlgo::resize(target, source, "triangle"))
        throw Error(fmt::format("a picture cannot be scaled ({})", firstLine(target.geterror())));
    return result;
}

float srgbToLinear(float encoded)
{
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float linearToSrgb(float linear)
{
    return shared::encodeSrgb(linear);
}

} // namespace lumel
