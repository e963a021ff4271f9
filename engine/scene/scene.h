// A glTF file as plain data, ready to bake and to upload.
#pragma once
#include "animation.h"
#include "core/image.h"
#include "core/math.h"
#include "deformation.h"
#include "shared/structs.h"
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace lumel::scene {

using shared::Vertex; // metres and glTF's frame

// How well a mesh was unwrapped, see unwrap.h. Shares are of the texture's area, gaps of its width.
struct UnwrapReport {
    uint32_t charts = 0;
    float meanStretch = 1.0f, worstStretch = 1.0f;
    float leastDensity = 1.0f, greatestDensity = 1.0f; // of the mean
    float coveredShare = 0.0f;
    float gap = 0.0f; // least distance between charts
};

// One glTF primitive (triangles).
struct Mesh {
    std::string name;
    std::vector<Vertex> vertices;
    std::vector<uint32_t> indices;
    std::vector<glm::vec4> colours; // of the vertices, linear; empty: all white
    Bounds bounds;
    // Of the lit UVs (Vertex::uv). Empty when each point of [0, 1]^2 belongs to at most one triangle, so that
    // lumels are unique; else the reason: "UVs overlap by 7.5 %" (of the area they cover), "UVs leave [0,
    // 1]", "no UVs", "UVs cover no area".
    std::string uvProblem;
    std::optional<UnwrapReport> unwrapped; // the lit UVs were made here
    Deformation deformation;
    // While the mesh is read, where its vertices are copied and left out: the file's vertex that each one is.
    std::vector<uint32_t> sources;
};

enum class AlphaMode { opaque, mask, blend };

enum class Wrap { repeat, mirror, clamp };

// Where a texture is read: a UV set of the mesh, transformed (KHR_texture_transform), and what lies beyond
// [0, 1].
struct UvMapping {
    int set = 0; // TEXCOORD_0 or _1
    glm::vec2 offset{0.0f}, scale{1.0f};
    float rotation = 0.0f; // radians
    Wrap wrapU = Wrap::repeat, wrapV = Wrap::repeat;

    bool operator==(const UvMapping&) const = default;
    glm::vec2 operator()(glm::vec2 uv) const;
    glm::mat3 matrix() const; // the same, of (u, v, 1)
};

// Of coordinates that `from` gives to those that `to` gives, for mappings of one set. Nothing where `from`
// has no inverse.
std::optional<glm::mat3> mappingBetween(const UvMapping& from, const UvMapping& to);

// Images are indices into Scene::images, -1 for none. Factors multiply images, as in glTF 2.0.
struct Material {
    std::string name;
    glm::vec4 baseColor{1.0f}; // linear
    float metallic = 1.0f;
    float roughness = 1.0f; // perceptual
    float normalScale = 1.0f;
    float occlusionStrength = 1.0f;
    glm::vec3 emissive{0.0f};
    int baseColorImage = -1;         // sRGB
    int metallicRoughnessImage = -1; // linear, G roughness, B metallic
    int normalImage = -1;            // linear
    int occlusionImage = -1;         // linear, R
    int emissiveImage = -1;          // sRGB
    // KHR_materials_pbrSpecularGlossiness: baseColor is the diffuse colour, specularColor the reflectance at
    // normal incidence, and the metallic-roughness image holds a specular colour (sRGB) and in alpha
    // the glossiness, which replaces 1 - roughness.
    bool specularGlossiness = false;
    float glossiness = 1.0f;
    float ior = 1.5f;                // KHR_materials_ior; 0 = reflects everything
    float specular = 1.0f;           // KHR_materials_specular
    glm::vec3 specularColor{1.0f};   // linear
    int specularImage = -1;          // linear, A
    int specularColorImage = -1;     // sRGB
    float anisotropy = 0.0f;         // KHR_materials_anisotropy: strength in [0, 1]
    float anisotropyRotation = 0.0f; // radians from the tangent towards the bitangent
    int anisotropyImage = -1;        // linear, RG direction, B strength
    bool unlit = false;              // KHR_materials_unlit: only emits
    // The baker joins all maps of a kind into one. Where they are read: reflectance, and occlusion and
    // emission.
    UvMapping uv, emissionUv;
    // Their own, where they are not the first of their kind: moved to the common place while baking.
    UvMapping baseColorUv, metallicRoughnessUv, specularUv, specularColorUv, anisotropyUv, emissiveUv;
    AlphaMode alphaMode = AlphaMode::opaque;
    float alphaCutoff = 0.5f;
    bool doubleSided = false;
    // material.extras.lumel = { "heightTexture": {"index": i}, "heightScale": s, "power": p }: a height map
    // for the baker in place of a normal map (ours; other viewers ignore it and use normalTexture).
    int heightImage = -1;
    float heightScale = 0.0f;        // height of value 1 in units of the map's width
    std::filesystem::path bakedFile; // a chain of `lumel bake` that was asked for in place of all maps
    // extras.lumel = { "baked": "file", "maps": hash }: the model's own chain, and mapsHash() of what it was
    // baked from; empty: not known. See own_chains.h.
    std::filesystem::path ownChain;
    std::string ownMaps;
    float power = 0.0f; // Blinn-Phong power in place of the roughness; 0 = use the roughness
};

// Decoded lazily: files stay encoded until a material is baked, and a cached material never decodes.
struct SceneImage {
    std::string name;             // for messages: file name, or "model.glb#image3"
    std::vector<std::byte> bytes; // the encoded file
};

struct Object {
    std::string name;
    int mesh = 0;
    int material = 0;
    int node = -1;                   // in Scene::animation that moves it, -1 none
    int deformed = -1;               // in Scene::deformed, -1: the mesh as it is
    glm::mat4 nodeFromObject{1.0f};  // of an instance
    glm::mat4 worldFromObject{1.0f}; // invertible; where it mirrors, front faces turn clockwise
};

struct Camera {
    std::string name;
    glm::vec3 eye{0.0f};
    glm::vec3 target{0.0f, 0.0f, -1.0f};
    glm::vec3 up{0.0f, 1.0f, 0.0f};
    float yFov = 0.7f; // radians
    float nearMetres = 0.01f;
    int node = -1; // in Scene::animation, -1 none
};

enum class LightType { directional = 0, point = 1, spot = 2 };

// KHR_lights_punctual. Intensity: lux for directional lights, candela for point and spot.
struct Light {
    std::string name;
    LightType type = LightType::directional;
    glm::vec3 colour{1.0f}; // linear
    float intensity = 1.0f;
    float range = 0.0f;                             // metres; 0 = unlimited
    float innerCone = 0.0f, outerCone = 0.7853982f; // radians
    glm::vec3 position{0.0f};
    glm::vec3 direction{0.0f, -1.0f, 0.0f}; // the way the light travels, unit length
    int node = -1;                          // in Scene::animation, -1 none
    bool operator==(const Light&) const = default;
};

struct Environment; // environment.h

struct Scene {
    std::filesystem::path file;
    std::vector<Mesh> meshes;
    std::vector<Material> materials; // the ones that objects use
    std::vector<SceneImage> images;
    std::vector<Object> objects;
    std::vector<Camera> cameras;                    // as in the file; may be empty
    std::vector<Light> lights;                      // as in the file; may be empty
    std::shared_ptr<const Environment> environment; // none: a faint constant light fills the shadows
    std::vector<Skin> skins;
    std::vector<DeformedMesh> deformed;
    Animation animation; // objects, cameras and lights are where the nodes say, not the tracks
    Bounds bounds;       // of all objects, world space
};

// A camera that frames the scene's bounds from the front, a little above and to the right.
Camera frameBounds(const Bounds& bounds, float aspect);

// Key, fill and rim directional lights fixed to the scene: used when the file has no lights.
std::vector<Light> threeLightRig();

// `count` lights around the scene, point and spot in turn, for measurements: the more there are, the weaker
// each is, so that the picture stays as bright.
std::vector<Light> lightRing(int count, const Bounds& bounds);

} // namespace lumel::scene
