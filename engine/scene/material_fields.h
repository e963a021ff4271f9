// Every field of a material in turn, for code that must not leave one out. The list below is a structured
// binding of the whole struct: a field that is added to Material or UvMapping and not here does not compile.
#pragma once
#include "scene.h"

namespace lumel::scene {

namespace detail {
template<class Visit, class... Fields>
void visitAll(const Visit& visit, Fields&... fields)
{
    (visit(fields), ...);
}
} // namespace detail

// Calls visit(field) in the order of declaration; fields are const where `mapping` is.
template<class Mapping, class Visit>
void forEachUvMappingField(Mapping& mapping, const Visit& visit)
{
#define LUMEL_FIELDS set, offset, scale, rotation, wrapU, wrapV
    auto& [LUMEL_FIELDS] = mapping;
    detail::visitAll(visit, LUMEL_FIELDS);
#undef LUMEL_FIELDS
}

template<class AnyMaterial, class Visit>
void forEachMaterialField(AnyMaterial& material, const Visit& visit)
{
#define LUMEL_FIELDS                                                                                         \
    name, baseColor, metallic, roughness, normalScale, occlusionStrength, emissive, baseColorImage,          \
        metallicRoughnessImage, normalImage, occlusionImage, emissiveImage, specularGlossiness, glossiness,  \
        ior, specular, specularColor, specularImage, specularColorImage, anisotropy, anisotropyRotation,     \
        anisotropyImage, unlit, uv, emissionUv, baseColorUv, metallicRoughnessUv, specularUv,                \
        specularColorUv, anisotropyUv, emissiveUv, alphaMode, alphaCutoff, doubleSided, heightImage,         \
        heightScale, bakedFile, ownChain, ownMaps, power
    auto& [LUMEL_FIELDS] = material;
    detail::visitAll(visit, LUMEL_FIELDS);
#undef LUMEL_FIELDS
}

} // namespace lumel::scene
