// glTF 2.0, section 3.9.2 and appendix B: base colour c, metalness m, roughness r.
//   F0 = mix(d, c, m)      reflectance at normal incidence; d = 0.04 is that of glass, index 1.5, unless
//                          KHR_materials_ior or _specular say otherwise
//   Kd = c (1 - m) (1 - d)
// Colours are sRGB in images and linear as factors; image and factor are multiplied.
#include "material_maps.h"
#include "baker/footprint.h"
#include "core/error.h"
#include "core/progress.h"
#include "material_images.h"
#include "shared/energy.h"
#include <fmt/format.h>
#include <optional>
#include <tbb/parallel_for.h>

namespace lumel::scene {
namespace {

// Images of one value become constants, so that they neither cost time nor set the size of the chain.
bool isConstant(const Image& image)
{
    for (size_t i = size_t(image.channels); i < image.pixels.size(); ++i)
        if (image.pixels[i] != image.pixels[i % size_t(image.channels)])
            return false;
    return true;
}

Image oneTexel(float value)
{
    Image image(1, 1, 1);
    image.pixels = {value};
    return image;
}

// An image of one value becomes a constant.
void give(Image& image, Image& map, glm::vec3& constant)
{
    if (isConstant(image))
        constant = {image.pixels[0], image.pixels[1], image.pixels[2]};
    else
        map = std::move(image);
}

// Schlick's reflectance of a dielectric against air at normal incidence; KHR_materials_ior: 0 is a mirror.
float dielectricF0(float ior)
{
    const float ratio = (ior - 1.0f) / (ior + 1.0f);
    return ratio * ratio;
}

// KHR_materials_specular: F0 = min(F0(ior) specularColor, 1) specular. F90, which it scales too, is not
// modelled. Diffuse reflection gets what Fresnel's F0 leaves (glTF 2.0, appendix B.3.4, fresnel_mix); what
// the grazing part takes depends on the view (shading.h).
void setColours(const Material& m, MaterialImages& sources, baker::Maps& maps)
{
    const SameSize<4> images({sources.colours(m.baseColorImage, m.baseColorUv, m.uv),
                              sources.get(m.metallicRoughnessImage, m.metallicRoughnessUv, m.uv),
                              sources.get(m.specularImage, m.specularUv, m.uv),
                              sources.colours(m.specularColorImage, m.specularColorUv, m.uv)});
    Image specular(images.width, images.height, 3), diffuse(images.width, images.height, 3);
    const float f0 = dielectricF0(m.ior);
    tbb::parallel_for(0, images.height, [&](int y) {
        for (int x = 0; x < images.width; ++x) {
            const float metal = m.metallic * images.value(1, x, y, 2);
            const float strength = m.specular * images.alpha(2, x, y);
            glm::vec3 colour, dielectric;
            for (int c = 0; c < 3; ++c) {
                colour[c] = m.baseColor[c] * images.colour(0, x, y, c);
                dielectric[c] =
                    std::min(f0 * m.specularColor[c] * images.colour(3, x, y, c), 1.0f) * strength;
            }
            const float left = 1.0f - std::max({dielectric.x, dielectric.y, dielectric.z});
            for (int c = 0; c < 3; ++c) {
                specular.at(x, y)[c] = dielectric[c] + (colour[c] - dielectric[c]) * metal;
                diffuse.at(x, y)[c] = colour[c] * (1.0f - metal) * left;
            }
        }
    });
    give(specular, maps.specular, maps.specularConstant);
    give(diffuse, maps.diffuse, maps.diffuseConstant);
}

// KHR_materials_pbrSpecularGlossiness, "BRDF": Kd = diffuse (1 - max(specular)).
void setSpecularGlossinessColours(const Material& m, MaterialImages& sources, baker::Maps& maps)
{
    const SameSize<2> images({sources.colours(m.baseColorImage, m.baseColorUv, m.uv),
                              sources.colours(m.metallicRoughnessImage, m.metallicRoughnessUv, m.uv)});
    Image specular(images.width, images.height, 3), diffuse(images.width, images.height, 3);
    for (int y = 0; y < images.height; ++y)
        for (int x = 0; x < images.width; ++x) {
            float* ks = specular.at(x, y);
            for (int c = 0; c < 3; ++c)
                ks[c] = m.specularColor[c] * images.colour(1, x, y, c);
            const float rest = 1.0f - std::max({ks[0], ks[1], ks[2]});
            for (int c = 0; c < 3; ++c)
                diffuse.at(x, y)[c] = m.baseColor[c] * images.colour(0, x, y, c) * rest;
        }
    give(specular, maps.specular, maps.specularConstant);
    give(diffuse, maps.diffuse, maps.diffuseConstant);
}

float roughnessAt(const Material& m, const Image& image, int x, int y)
{
    return m.specularGlossiness ? 1.0f - m.glossiness * alphaOf(image, x, y)
                                : m.roughness * texel(image, x, y, 1);
}

// The constant roughness, or none when the map varies.
std::optional<float> setRoughness(const Material& m, const Image* image, baker::Maps& maps)
{
    if (m.power > 0.0f) {
        maps.powerConstant = m.power;
        return std::nullopt;
    }
    float constant = m.specularGlossiness ? 1.0f - m.glossiness : m.roughness;
    if (image) {
        Image roughness(image->width, image->height, 1);
        for (int y = 0; y < roughness.height; ++y)
            for (int x = 0; x < roughness.width; ++x)
                *roughness.at(x, y) = roughnessAt(m, *image, x, y);
        if (!isConstant(roughness)) {
            maps.roughness = std::move(roughness);
            return std::nullopt;
        }
        constant = roughness.pixels[0];
    }
    maps.powerConstant = shared::powerFromRoughness(constant);
    return constant;
}

// KHR_materials_anisotropy. The image's direction is (2 r - 1, 2 g - 1) in the tangent frame; the rotation
// turns it further, and the axes repeat after half a turn.
void setAnisotropy(const Material& m, const Image* image, std::optional<float> roughness, baker::Maps& maps)
{
    if (m.anisotropy <= 0.0f || m.power > 0.0f)
        return;
    maps.anisotropy = Image(image ? image->width : 1, image ? image->height : 1, 1);
    maps.tangentRotation = maps.anisotropy;
    for (int y = 0; y < maps.anisotropy.height; ++y)
        for (int x = 0; x < maps.anisotropy.width; ++x) {
            float angle = m.anisotropyRotation, strength = m.anisotropy;
            if (image) {
                angle +=
                    std::atan2(2.0f * texel(*image, x, y, 1) - 1.0f, 2.0f * texel(*image, x, y, 0) - 1.0f);
                strength *= texel(*image, x, y, 2);
            }
            const float halfTurns = angle / glm::pi<float>();
            *maps.tangentRotation.at(x, y) = halfTurns - std::floor(halfTurns);
            *maps.anisotropy.at(x, y) = strength;
        }
    if (roughness && isConstant(maps.anisotropy)) {
        const glm::vec2 along = baker::anisotropicRoughness(*roughness, maps.anisotropy.pixels[0]);
        maps.anisotropicPower = {shared::powerFromRoughness(along.x), shared::powerFromRoughness(along.y)};
        maps.anisotropy = {};
    } else if (roughness) {
        maps.roughness = oneTexel(*roughness);
    }
    for (Image* map : {&maps.anisotropy, &maps.tangentRotation})
        if (!map->empty() && isConstant(*map))
            *map = oneTexel(map->pixels[0]);
}

Image halved(const Image& in)
{
    Image out(std::max(1, in.width / 2), std::max(1, in.height / 2), in.channels);
    const float area = float(in.width) / float(out.width) * float(in.height) / float(out.height);
    tbb::parallel_for(0, out.height, [&](int y) {
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
    });
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
    MaterialImages sources(scene);
    baker::Maps maps;
    if (material.uv.wrapU != Wrap::repeat || material.uv.wrapV != Wrap::repeat)
        maps.wrap = baker::Wrap::clamp;
    if (material.heightImage >= 0) {
        maps.height = *sources.get(material.heightImage);
        maps.heightScale = material.heightScale;
    } else if (material.normalImage >= 0) {
        maps.normal = *sources.get(material.normalImage);
        maps.normalScale = material.normalScale;
    } else {
        maps.normal = Image(1, 1, 3); // flat: the baker wants a surface
        maps.normal.pixels = {0.5f, 0.5f, 1.0f};
    }
    if (material.unlit) {
        maps.specularConstant = glm::vec3(0.0f);
        return maps;
    }
    if (material.specularGlossiness)
        setSpecularGlossinessColours(material, sources, maps);
    else
        setColours(material, sources, maps);
    checkInterrupted();
    const auto roughness = setRoughness(
        material, sources.get(material.metallicRoughnessImage, material.metallicRoughnessUv, material.uv),
        maps);
    setAnisotropy(material, sources.get(material.anisotropyImage, material.anisotropyUv, material.uv),
                  roughness, maps);
    return maps;
}

bool emissiveVaries(const Material& material)
{
    return occludes(material) || (emits(material) && material.emissiveImage >= 0);
}

Image emissiveImage(const Scene& scene, const Material& material)
{
    MaterialImages sources(scene);
    const SameSize<2> images({sources.colours(emits(material) ? material.emissiveImage : -1,
                                              material.emissiveUv, material.emissionUv),
                              sources.get(occludes(material) ? material.occlusionImage : -1)});
    Image emissive(images.width, images.height, 4);
    tbb::parallel_for(0, images.height, [&](int y) {
        for (int x = 0; x < images.width; ++x) {
            for (int c = 0; c < 3; ++c)
                emissive.at(x, y)[c] = material.emissive[c] * images.colour(0, x, y, c);
            emissive.at(x, y)[3] = 1.0f + material.occlusionStrength * (images.value(1, x, y, 0) - 1.0f);
        }
    });
    for (float value : emissive.pixels)
        if (!std::isfinite(value))
            throw Error(
                fmt::format("{}: material '{}': its emissive or occlusion image holds values that are not "
                            "finite; repair the image",
                            scene.file.string(), material.name));
    return emissive;
}

Image opacityImage(const Scene& scene, const Material& material)
{
    Image opacity(1, 1, 1);
    opacity.pixels = {material.alphaMode == AlphaMode::opaque ? 1.0f : material.baseColor.a};
    if (material.alphaMode == AlphaMode::opaque || material.baseColorImage < 0)
        return opacity;
    MaterialImages sources(scene);
    const Image& base = *sources.get(material.baseColorImage, material.baseColorUv, material.uv);
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
    while (levels.back().width > 1 || levels.back().height > 1) {
        checkInterrupted();
        levels.push_back(halved(levels.back()));
    }
    return levels;
}

HalfChain emissiveChain(Image image)
{
    const HalfChain level({image});
    halfToFloats(level.texels(0), image.pixels.data());
    return HalfChain(mipChain(std::move(image)));
}

std::vector<Image> baseReflectance(const baker::ReflectanceMips& mips)
{
    const baker::Level& level = mips.levels.front();
    Image image(level.width, level.height, 4);
    tbb::parallel_for(0, level.height, [&](int y) {
        for (int x = 0; x < level.width; ++x) {
            const float* t = level.at(x, y);
            const glm::vec3 covariance(t[baker::kSxx], t[baker::kSxy], t[baker::kSyy]);
            const glm::vec3 f0 =
                shared::reflectanceOf({t[baker::kKsR], t[baker::kKsG], t[baker::kKsB]}, covariance);
            float* out = image.at(x, y);
            std::copy_n(&f0.x, 3, out);
            out[3] = shared::baseVariance(covariance);
        }
    });
    if (!isConstant(image))
        return mipChain(std::move(image));
    Image constant(1, 1, 4);
    std::copy_n(image.pixels.begin(), 4, constant.pixels.begin());
    return {constant};
}

} // namespace lumel::scene
