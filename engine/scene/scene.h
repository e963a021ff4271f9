// A glTF file as plain data, ready to bake and to upload.
#pragma once
#include "core/image.h"
#include "core/math.h"
#include "shared/structs.h"
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lumel::scene {

using shared::Vertex; // position, normal, tangent (w = handedness), uv; metres and glTF's frame

// One glTF primitive (triangles).
struct Mesh {
    std::string name;
    std::vector<Vertex> vertices;
    std::vector<uint32_t> indices;
    Bounds bounds;
    // Empty when each point of [0, 1]^2 belongs to at most one triangle, so that lumels are unique;
    // else the reason: "UVs overlap by 7.5 %" (of the area they cover), "UVs leave [0, 1]", "no UVs",
    // "UVs cover no area".
    std::string uvProblem;
};

enum class AlphaMode { opaque, mask, blend };

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
    AlphaMode alphaMode = AlphaMode::opaque;
    float alphaCutoff = 0.5f;
    bool doubleSided = false;
    // material.extras.lumel = { "heightTexture": {"index": i}, "heightScale": s, "power": p }: a height map
    // for the baker in place of a normal map (ours; other viewers ignore it and use normalTexture).
    int heightImage = -1;
    float heightScale = 0.0f;        // height of value 1 in units of the map's width
    std::filesystem::path bakedFile; // a chain of `lumel bake` in place of what the maps would give
    float power = 0.0f;              // Blinn-Phong power in place of the roughness; 0 = use the roughness
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
    glm::mat4 worldFromObject{1.0f}; // invertible; where it mirrors, front faces turn clockwise
};

struct Camera {
    std::string name;
    glm::vec3 eye{0.0f};
    glm::vec3 target{0.0f, 0.0f, -1.0f};
    glm::vec3 up{0.0f, 1.0f, 0.0f};
    float yFov = 0.7f; // radians
    float nearMetres = 0.01f;
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
    bool operator==(const Light&) const = default;
};

struct Scene {
    std::filesystem::path file;
    std::vector<Mesh> meshes;
    std::vector<Material> materials; // the ones that objects use
    std::vector<SceneImage> images;
    std::vector<Object> objects;
    std::vector<Camera> cameras; // as in the file; may be empty
    std::vector<Light> lights;   // as in the file; may be empty
    Bounds bounds;               // of all objects, world space
};

// Loads .gltf (with files beside it or embedded) or .glb. Throws Error, one line naming file and remedy,
// for anything malformed. Logs one line per object that cannot be lit in texture space.
Scene loadGltf(const std::filesystem::path& file);

// A camera that frames the scene's bounds from the front, a little above and to the right.
Camera frameBounds(const Bounds& bounds, float aspect);

// Key, fill and rim directional lights fixed to the scene: used when the file has no lights.
std::vector<Light> threeLightRig();

// `count` lights around the scene, point and spot in turn, for measurements: the more there are, the weaker
// each is, so that the picture stays as bright.
std::vector<Light> lightRing(int count, const Bounds& bounds);

} // namespace lumel::scene
