// glTF 2.0, section 3.9.2 and appendix B: base colour c, metalness m, roughness r.
//   Ks = mix(0.04, c, m)   reflectance at normal incidence; 0.04 is that of glass, index 1.5
//   Kd = c (1 - m)
// Colours are sRGB in images and linear as factors; image and factor are multiplied.
#include "material_maps.h"
#include "baker/footprint.h"
#include "core/error.h"
#include <array>
#include <deque>
#include <fmt/format.h>
#include <map>

namespace lumel::scene {
namespace {

constexpr float kDielectricKs = 0.04f;

// sRGB decoding of 8-bit images by table: std::pow for each of 2048^2 texels would take longer than PNG.
float decodeSrgb(float encoded)
{
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values;
        for (size_t i = 0; i < values.size(); ++i)
            values[i] = srgbToLinear(float(i) / 255.0f);
        return values;
    }();
    const float scaled = encoded * 255.0f;
    const float nearest = std::nearbyint(scaled);
    if (nearest >= 0.0f && nearest <= 255.0f && std::abs(scaled - nearest) < 1e-4f)
        return table[size_t(nearest)];
    return srgbToLinear(encoded);
}

// Channel c of a texel, as if the image had rgb: grey images have one channel, or two with alpha.
float texel(const Image& image, int x, int y, int c)
{
    return image.at(x, y)[image.channels >= 3 ? c : 0];
}

// Bilinear at texel centres; the border repeats, which is glTF's default.
Image resized(const Image& in, int width, int height)
{
    Image out(width, height, in.channels);
    const auto wrap = [](int i, int size) { return (i % size + size) % size; };
    for (int y = 0; y < height; ++y) {
        const float sy = (float(y) + 0.5f) * float(in.height) / float(height) - 0.5f;
        const int y0 = wrap(int(std::floor(sy)), in.height), y1 = wrap(int(std::floor(sy)) + 1, in.height);
        const float fy = sy - std::floor(sy);
        for (int x = 0; x < width; ++x) {
            const float sx = (float(x) + 0.5f) * float(in.width) / float(width) - 0.5f;
            const int x0 = wrap(int(std::floor(sx)), in.width), x1 = wrap(int(std::floor(sx)) + 1, in.width);
            const float fx = sx - std::floor(sx);
            for (int c = 0; c < in.channels; ++c) {
                const float upper = in.at(x0, y0)[c] * (1.0f - fx) + in.at(x1, y0)[c] * fx;
                const float lower = in.at(x0, y1)[c] * (1.0f - fx) + in.at(x1, y1)[c] * fx;
                out.at(x, y)[c] = upper * (1.0f - fy) + lower * fy;
            }
        }
    }
    return out;
}

int wrapped(int i, int size, Wrap wrap)
{
    const auto modulo = [](int a, int n) { return (a % n + n) % n; };
    if (wrap == Wrap::clamp)
        return std::clamp(i, 0, size - 1);
    if (wrap == Wrap::repeat)
        return modulo(i, size);
    const int twice = modulo(i, 2 * size);
    return twice < size ? twice : 2 * size - 1 - twice;
}

// The image as it appears at coordinates `common`, where its own are `own`, both of one set; as fine as it
// is.
Image moved(const Image& in, const UvMapping& own, const UvMapping& common)
{
    constexpr float kMostTexels = 4096.0f;
    const glm::mat3 relative = *mappingBetween(common, own);
    const glm::vec2 inSize(in.width, in.height);
    const auto texelsAlong = [&](glm::vec3 step) {
        return int(std::clamp(std::ceil(glm::length(glm::vec2(step) * inSize) - 0.01f), 1.0f, kMostTexels));
    };
    Image out(texelsAlong(relative[0]), texelsAlong(relative[1]), in.channels);
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) {
            const glm::vec2 p = (glm::vec2(x, y) + 0.5f) / glm::vec2(out.width, out.height);
            const glm::vec2 q = glm::clamp(glm::vec2(relative * glm::vec3(p, 1.0f)) * inSize - 0.5f,
                                           glm::vec2(-1e9f), glm::vec2(1e9f));
            const glm::ivec2 first(glm::floor(q));
            const glm::vec2 f = q - glm::floor(q);
            for (int corner = 0; corner < 4; ++corner) {
                const int i = corner & 1, j = corner >> 1;
                const float weight = (i ? f.x : 1.0f - f.x) * (j ? f.y : 1.0f - f.y);
                const float* from = in.at(wrapped(first.x + i, in.width, own.wrapU),
                                          wrapped(first.y + j, in.height, own.wrapV));
                for (int c = 0; c < in.channels; ++c)
                    out.at(x, y)[c] += weight * from[c];
            }
        }
    return out;
}

// Images of one material, each decoded once: occlusion, roughness and metalness often share a file.
class Decoder {
public:
    explicit Decoder(const Scene& scene) : scene_(scene) {}

    // The same at the coordinates that it shares with others.
    const Image* get(int index, const UvMapping& own, const UvMapping& common)
    {
        const Image* image = get(index);
        if (!image || own.set != common.set || own.matrix() == common.matrix() ||
            !mappingBetween(common, own))
            return image;
        return &moved_.emplace_back(moved(*image, own, common));
    }

    // Null for index -1.
    const Image* get(int index)
    {
        if (index < 0)
            return nullptr;
        const SceneImage& source = scene_.images[size_t(index)];
        auto found = decoded_.find(index);
        if (found == decoded_.end())
            found = decoded_.emplace(index, readImage(source.bytes, source.name)).first;
        return &found->second;
    }

private:
    const Scene& scene_;
    std::map<int, Image> decoded_;
    std::deque<Image> moved_;
};

// Two images brought to the size of the larger one. Either may be null: constant.
struct Pair {
    const Image* a;
    const Image* b;
    int width = 1, height = 1;

    Pair(const Image* first, const Image* second) : a(first), b(second)
    {
        for (const Image* image : {a, b})
            if (image) {
                width = std::max(width, image->width);
                height = std::max(height, image->height);
            }
        fit(a, resizedA_);
        fit(b, resizedB_);
    }
    Pair(const Pair&) = delete;

private:
    void fit(const Image*& image, Image& storage)
    {
        if (!image || (image->width == width && image->height == height))
            return;
        storage = resized(*image, width, height);
        image = &storage;
    }
    Image resizedA_, resizedB_;
};

// Images of one value become constants, so that they neither cost time nor set the size of the chain.
bool isConstant(const Image& image)
{
    for (size_t i = size_t(image.channels); i < image.pixels.size(); ++i)
        if (image.pixels[i] != image.pixels[i % size_t(image.channels)])
            return false;
    return true;
}

void setColours(const Material& material, const Image* base, const Image* metal, baker::Maps& maps)
{
    const Pair pair(base, metal);
    Image specular(pair.width, pair.height, 3), diffuse(pair.width, pair.height, 3);
    for (int y = 0; y < pair.height; ++y)
        for (int x = 0; x < pair.width; ++x) {
            const float m = material.metallic * (pair.b ? texel(*pair.b, x, y, 2) : 1.0f);
            for (int c = 0; c < 3; ++c) {
                const float colour =
                    material.baseColor[c] * (pair.a ? decodeSrgb(texel(*pair.a, x, y, c)) : 1.0f);
                specular.at(x, y)[c] = kDielectricKs + (colour - kDielectricKs) * m;
                diffuse.at(x, y)[c] = colour * (1.0f - m);
            }
        }
    const auto give = [](Image& image, Image& map, glm::vec3& constant) {
        if (isConstant(image))
            constant = {image.pixels[0], image.pixels[1], image.pixels[2]};
        else
            map = std::move(image);
    };
    give(specular, maps.specular, maps.specularConstant);
    give(diffuse, maps.diffuse, maps.diffuseConstant);
}

void setRoughness(const Material& material, const Image* metallicRoughness, baker::Maps& maps)
{
    if (material.power > 0.0f) {
        maps.powerConstant = material.power;
        return;
    }
    float constant = material.roughness;
    if (metallicRoughness) {
        Image roughness(metallicRoughness->width, metallicRoughness->height, 1);
        for (int y = 0; y < roughness.height; ++y)
            for (int x = 0; x < roughness.width; ++x)
                *roughness.at(x, y) = material.roughness * texel(*metallicRoughness, x, y, 1);
        if (!isConstant(roughness)) {
            maps.roughness = std::move(roughness);
            return;
        }
        constant = roughness.pixels[0];
    }
    maps.powerConstant = baker::powerFromRoughness(constant);
}

Image halved(const Image& in)
{
    Image out(std::max(1, in.width / 2), std::max(1, in.height / 2), in.channels);
    const float area = float(in.width) / float(out.width) * float(in.height) / float(out.height);
    for (int y = 0; y < out.height; ++y) {
        const baker::Footprint rows(y, out.height, in.height);
        for (int x = 0; x < out.width; ++x) {
            const baker::Footprint columns(x, out.width, in.width);
            for (int sy = rows.first; sy < rows.last; ++sy)
                for (int sx = columns.first; sx < columns.last; ++sx) {
                    const float weight = rows.weight(sy) * columns.weight(sx) / area;
                    for (int c = 0; c < in.channels; ++c)
                        out.at(x, y)[c] += weight * in.at(sx, sy)[c];
                }
        }
    }
    return out;
}

bool emits(const Material& material)
{
    return material.emissive != glm::vec3(0.0f);
}

bool occludes(const Material& material)
{
    return material.occlusionImage >= 0 && material.occlusionStrength > 0.0f;
}

} // namespace

baker::Maps reflectanceMaps(const Scene& scene, const Material& material)
{
    Decoder decoder(scene);
    baker::Maps maps;
    if (material.uv.wrapU != Wrap::repeat || material.uv.wrapV != Wrap::repeat)
        maps.wrap = baker::Wrap::clamp;
    if (material.heightImage >= 0) {
        maps.height = *decoder.get(material.heightImage);
        maps.heightScale = material.heightScale;
    } else if (material.normalImage >= 0) {
        maps.normal = *decoder.get(material.normalImage);
        maps.normalScale = material.normalScale;
    } else {
        maps.normal = Image(1, 1, 3); // flat: the baker wants a surface
        maps.normal.pixels = {0.5f, 0.5f, 1.0f};
    }
    const Image* metallicRoughness =
        decoder.get(material.metallicRoughnessImage, material.metallicRoughnessUv, material.uv);
    setColours(material, decoder.get(material.baseColorImage, material.baseColorUv, material.uv),
               metallicRoughness, maps);
    setRoughness(material, metallicRoughness, maps);
    return maps;
}

bool glowVaries(const Material& material)
{
    return occludes(material) || (emits(material) && material.emissiveImage >= 0);
}

Image glowImage(const Scene& scene, const Material& material)
{
    Decoder decoder(scene);
    const Pair pair(
        decoder.get(emits(material) ? material.emissiveImage : -1, material.emissiveUv, material.glowUv),
        decoder.get(occludes(material) ? material.occlusionImage : -1));
    Image glow(pair.width, pair.height, 4);
    for (int y = 0; y < pair.height; ++y)
        for (int x = 0; x < pair.width; ++x) {
            for (int c = 0; c < 3; ++c)
                glow.at(x, y)[c] =
                    material.emissive[c] * (pair.a ? decodeSrgb(texel(*pair.a, x, y, c)) : 1.0f);
            const float open = pair.b ? texel(*pair.b, x, y, 0) : 1.0f;
            glow.at(x, y)[3] = 1.0f + material.occlusionStrength * (open - 1.0f);
        }
    for (float value : glow.pixels)
        if (!std::isfinite(value))
            throw Error(
                fmt::format("{}: material '{}': its emissive or occlusion image holds values that are not "
                            "finite; repair the image",
                            scene.file.string(), material.name));
    return glow;
}

Image opacityImage(const Scene& scene, const Material& material)
{
    Image opacity(1, 1, 1);
    opacity.pixels = {material.alphaMode == AlphaMode::opaque ? 1.0f : material.baseColor.a};
    if (material.alphaMode == AlphaMode::opaque || material.baseColorImage < 0)
        return opacity;
    Decoder decoder(scene);
    const Image& base = *decoder.get(material.baseColorImage, material.baseColorUv, material.uv);
    if (base.channels != 2 && base.channels != 4) // grey or colour with alpha last
        return opacity;
    Image varying(base.width, base.height, 1);
    for (size_t i = 0; i < varying.pixels.size(); ++i)
        varying.pixels[i] =
            material.baseColor.a * base.pixels[i * size_t(base.channels) + size_t(base.channels) - 1];
    return varying;
}

std::vector<Image> mipChain(Image image)
{
    std::vector<Image> levels;
    levels.push_back(std::move(image));
    while (levels.back().width > 1 || levels.back().height > 1)
        levels.push_back(halved(levels.back()));
    return levels;
}

} // namespace lumel::scene
