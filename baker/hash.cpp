#include "bake.h"
#include "core/file.h"

namespace lumel::baker {
namespace {

// Is anything read across the border of a map? Elsewhere wrapping changes nothing.
bool readsAcrossBorders(const Maps& maps, const Options& options, glm::ivec2 size)
{
    if (!maps.height.empty() || options.reconstruction == Reconstruction::bilinear)
        return true;
    // Maps of another size are interpolated.
    const auto isResampled = [&](const Image& map) {
        return (map.width > 1 && map.width != size.x) || (map.height > 1 && map.height != size.y);
    };
    return isResampled(maps.normal) || isResampled(maps.power) || isResampled(maps.roughness) ||
           isResampled(maps.anisotropy) || isResampled(maps.specular) || isResampled(maps.diffuse);
}

void addImage(ContentHash& hash, const Image& image)
{
    hash.addValue(image.width).addValue(image.height).addValue(image.channels);
    hash.add(image.pixels.data(), image.pixels.size() * sizeof(float));
}

template<class... Fields>
void addFields(ContentHash& hash, const Fields&... fields)
{
    const auto add = [&](const auto& field) {
        if constexpr (std::is_same_v<decltype(field), const Image&>)
            addImage(hash, field);
        else
            hash.addValue(field);
    };
    (add(fields), ...);
}

} // namespace

// The lists name every field, or the structured bindings do not compile: none can be forgotten here.
std::string sourceHash(const Maps& maps, const Options& options)
{
    ContentHash hash;
    hash.add(std::string(kVersion)).add(std::string(kResults));
    const auto& [height, heightScale, normal, normalGreenUp, signedNormals, normalScale, givenWrap, power,
                 powerConstant, roughness, anisotropy, tangentRotation, anisotropicPower, specular,
                 specularConstant, diffuse, diffuseConstant] = maps;
    const auto& [method, model, threads, reduce, reconstruction, givenPrecision, givenLobes, mayProject,
                 profile] = options;
    const Wrap wrap = readsAcrossBorders(maps, options, mapSize(maps)) ? givenWrap : Wrap::repeat;
    addFields(hash, height, heightScale, normal, normalGreenUp, signedNormals, normalScale, wrap, power,
              powerConstant, roughness, anisotropy, tangentRotation, anisotropicPower, specular,
              specularConstant, diffuse, diffuseConstant);
    static_cast<void>(threads); // these do not change the result
    static_cast<void>(profile);
    const bool bestKs = mayProject && !isFitted(method);
    const float precision = isFitted(method) ? givenPrecision : 0.0f;
    const LobeCount lobes = method == Method::fit ? givenLobes : LobeCount::one;
    addFields(hash, method, model, reduce, reconstruction, precision, lobes, bestKs);
    return hash.hex();
}

} // namespace lumel::baker
