#include "texture.h"
#include <cmath>
#include <stdexcept>

namespace lumel::judge {
namespace {

// IEC 61966-2-1.
double decoded(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

Texels decode(const tinygltf::Image& image, Encoding encoding)
{
    if (image.component != 4 || (image.bits != 8 && image.bits != 16))
        throw std::runtime_error("the judge takes RGBA of 8 or 16 bits from tinygltf");
    Texels texels{image.width, image.height, {}};
    const auto value = [&](size_t i) {
        return image.bits == 8 ? image.image.at(i) / 255.0
                               : (image.image.at(2 * i) + 256 * image.image.at(2 * i + 1)) / 65535.0;
    };
    for (size_t i = 0; i < size_t(image.width) * size_t(image.height); ++i) {
        glm::vec4 texel;
        for (size_t c = 0; c < 4; ++c) {
            const double stored = value(4 * i + c);
            texel[int(c)] = float(encoding == Encoding::srgb && c < 3 ? decoded(stored) : stored);
        }
        texels.at.push_back(texel);
    }
    return texels;
}

// Wraps index i along an axis of `size` texels.
int wrapped(int i, int size, int mode)
{
    if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE)
        return std::min(std::max(i, 0), size - 1);
    const int period = mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? 2 * size : size;
    i = ((i % period) + period) % period;
    return i < size ? i : period - 1 - i;
}

// The extension's text turns from u towards -v: its first example reads "the lower left quadrant [...]
// rotated clockwise 90 degrees" at offset (0, 1), rotation pi / 2, scale (0.5, 0.5), which only this sign
// does (the sign of its GLSL fragment leaves the image).
glm::dmat3 transformOf(const tinygltf::Value& values)
{
    const auto pair = [&](const char* name, glm::dvec2 fallback) {
        if (!values.Has(name))
            return fallback;
        return glm::dvec2(values.Get(name).Get(0).GetNumberAsDouble(),
                          values.Get(name).Get(1).GetNumberAsDouble());
    };
    const double angle = values.Has("rotation") ? values.Get("rotation").GetNumberAsDouble() : 0.0;
    const glm::dvec2 offset = pair("offset", {0, 0}), scale = pair("scale", {1, 1});
    const double c = std::cos(angle), s = std::sin(angle);
    const glm::dmat3 translate(1, 0, 0, 0, 1, 0, offset.x, offset.y, 1);
    const glm::dmat3 rotate(c, -s, 0, s, c, 0, 0, 0, 1);
    return translate * rotate * glm::dmat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, 1);
}

} // namespace

glm::dvec2 Texture::place(const glm::dvec2 uv[2]) const
{
    return glm::dvec2(transform * glm::dvec3(uv[set], 1.0));
}

glm::vec4 Texture::operator()(const glm::dvec2 uv[2]) const
{
    if (empty())
        return glm::vec4(1.0f);
    const glm::dvec2 at = place(uv) * glm::dvec2(texels.width, texels.height) - 0.5;
    const int x = int(std::floor(at.x)), y = int(std::floor(at.y));
    const auto fx = float(at.x - x), fy = float(at.y - y);
    const auto texel = [&](int i, int j) {
        const int column = wrapped(i, texels.width, wrapS), row = wrapped(j, texels.height, wrapT);
        return texels.at[size_t(row) * size_t(texels.width) + size_t(column)];
    };
    return glm::mix(glm::mix(texel(x, y), texel(x + 1, y), fx),
                    glm::mix(texel(x, y + 1), texel(x + 1, y + 1), fx), fy);
}

Texture readTexture(const tinygltf::Model& model, int index, int set,
                    const tinygltf::ExtensionMap& extensions, Encoding encoding)
{
    Texture texture;
    if (index < 0)
        return texture;
    const tinygltf::Texture& source = model.textures.at(size_t(index));
    texture.texels = decode(model.images.at(size_t(source.source)), encoding);
    if (source.sampler >= 0) {
        texture.wrapS = model.samplers.at(size_t(source.sampler)).wrapS;
        texture.wrapT = model.samplers.at(size_t(source.sampler)).wrapT;
    }
    texture.set = set;
    if (const auto found = extensions.find("KHR_texture_transform"); found != extensions.end()) {
        texture.transform = transformOf(found->second);
        if (found->second.Has("texCoord"))
            texture.set = found->second.Get("texCoord").GetNumberAsInt();
    }
    return texture;
}

Texture readTexture(const tinygltf::Model& model, const tinygltf::Value& extension, const char* name,
                    Encoding encoding)
{
    if (!extension.Has(name))
        return {};
    const tinygltf::Value& info = extension.Get(name);
    tinygltf::ExtensionMap extensions;
    if (info.Has("extensions"))
        for (const std::string& key : info.Get("extensions").Keys())
            extensions[key] = info.Get("extensions").Get(key);
    const int set = info.Has("texCoord") ? info.Get("texCoord").GetNumberAsInt() : 0;
    return readTexture(model, info.Get("index").GetNumberAsInt(), set, extensions, encoding);
}

} // namespace lumel::judge
