#include "image.h"
#include "error.h"
#include "exr_header.h"
#include "file.h"
#include "shared/tonemap.h"
#include "webp.h"
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <sstream>

namespace lumel {
namespace {

// OpenImageIO's messages can span lines; ours are one line each.
std::string firstLine(std::string text)
{
    return text.substr(0, text.find('\n'));
}

// glTF's colours are not multiplied by their alpha, and normal or roughness maps with a fourth channel
// even less; OpenImageIO's readers and writers would do it.
OIIO::ImageSpec asStored()
{
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    return config;
}

Image readOpened(OIIO::ImageInput& input, const std::string& name, size_t encodedBytes,
                 size_t mostPixels = kMaxImagePixels)
{
    const OIIO::ImageSpec& spec = input.spec();
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1 || spec.depth > 1)
        throw Error(fmt::format("{}: not a 2D image; export it as PNG, JPEG, TIFF or EXR", name));
    if (spec.nchannels > 64)
        throw Error(fmt::format("{}: {} channels, at most 64 are read; export fewer", name, spec.nchannels));
    checkImageSize(size_t(spec.width), size_t(spec.height), size_t(spec.nchannels), encodedBytes, name);
    if (size_t(spec.width) * size_t(spec.height) > mostPixels)
        throw Error(fmt::format("{}: {} x {} pixels are more than {}; scale it down", name, spec.width,
                                spec.height, mostPixels));
    Image image(spec.width, spec.height, spec.nchannels);
    if (!input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.pixels.data()))
        throw Error(
            fmt::format("{}: damaged image ({}); export it again", name, firstLine(input.geterror())));
    return image;
}

} // namespace

void checkImageSize(size_t width, size_t height, size_t channels, size_t encodedBytes,
                    const std::string& name)
{
    constexpr size_t kFewPixels = size_t(4096) * 4096, kMaxPixelsPerByte = 16384;
    const size_t pixels = width * height; // each at most 2^31
    if (pixels > kMaxImagePixels || pixels * channels > 4 * kMaxImagePixels)
        throw Error(fmt::format("{}: {} x {} pixels of {} channels exceed the limit of 16384 x 16384 of 4; "
                                "scale it down",
                                name, width, height, channels));
    if (pixels > kFewPixels && pixels / kMaxPixelsPerByte > encodedBytes)
        throw Error(fmt::format("{}: {} x {} pixels cannot be in {} bytes; export it again", name, width,
                                height, encodedBytes));
}

Image readImage(const std::filesystem::path& file, size_t mostPixels)
{
    const std::string name = file.string();
    std::error_code code;
    const auto status = std::filesystem::status(file, code);
    if (!std::filesystem::exists(status))
        throw Error(fmt::format("{}: no such file; check the path", name));
    if (std::filesystem::is_directory(status))
        throw Error(fmt::format("{}: is a folder; name an image file in it", name));
    if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(file, code) == 0)
        throw Error(fmt::format("{}: empty file (0 bytes); export it again", name));
    if (file.extension() == ".webp")
        return readImage(readFile(file), name);
    if (std::ifstream stream(file, std::ios::binary); std::filesystem::is_regular_file(status))
        checkExrHeader(stream, size_t(std::filesystem::file_size(file, code)), name);
    const OIIO::ImageSpec config = asStored();
    auto input = OIIO::ImageInput::open(name, &config);
    if (!input) {
        const std::string why = firstLine(OIIO::geterror());
        throw Error(fmt::format("{}: cannot be read as an image{}; use PNG, JPEG, TIFF or EXR", name,
                                why.empty() ? "" : " (" + why + ")"));
    }
    return readOpened(*input, name, size_t(std::filesystem::file_size(file, code)), mostPixels);
}

Image readImage(std::span<const std::byte> bytes, const std::string& name)
{
    if (bytes.empty())
        throw Error(fmt::format("{}: empty image; export it again", name));
    if (isWebp(bytes))
        return readWebp(bytes, name);
    if (bytes.size() > 4 && std::memcmp(bytes.data(), "\x76\x2f\x31\x01", 4) == 0) { // OpenEXR's magic number
        std::istringstream stream(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
        checkExrHeader(stream, bytes.size(), name);
    }
    // The format is told by content, so the name's extension does not matter.
    OIIO::Filesystem::IOMemReader reader(const_cast<std::byte*>(bytes.data()), bytes.size());
    for (const char* format : {"png", "jpeg", "openexr", "tiff", "tga"}) {
        auto input = OIIO::ImageInput::create(format);
        if (!input || !input->supports("ioproxy") || !input->set_ioproxy(&reader))
            continue;
        OIIO::ImageSpec spec;
        reader.seek(0);
        if (input->open(name, spec, asStored()))
            return readOpened(*input, name, bytes.size());
        (void)input->geterror();
    }
    (void)OIIO::geterror();
    throw Error(fmt::format("{}: not a PNG, JPEG, WebP, EXR, TIFF or TGA image; convert it to PNG", name));
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
    if (!OIIO::ImageBufAlgo::resize(target, source, "catmull-rom", 4.0f))
        throw Error(fmt::format("a picture cannot be scaled ({})", firstLine(target.geterror())));
    for (float& value : result.pixels)
        value = std::max(value, 0.0f);
    return result;
}

void floatsToHalf(std::span<const float> from, uint16_t* to)
{
    OIIO::convert_pixel_values(OIIO::TypeDesc::FLOAT, from.data(), OIIO::TypeDesc::HALF, to,
                               int(from.size()));
}

void halfToFloats(std::span<const uint16_t> from, float* to)
{
    OIIO::convert_pixel_values(OIIO::TypeDesc::HALF, from.data(), OIIO::TypeDesc::FLOAT, to,
                               int(from.size()));
}

float srgbToLinear(float encoded)
{
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

float linearToSrgb(float linear)
{
    return shared::encodeSrgb(linear); // the one that the display pass runs
}

} // namespace lumel
