// Builds a glTF 2.0 scene and writes it as .gltf, .bin and PNG files.
#pragma once
#include "geometry.h"
#include "maps.h"
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lumel::assets {

struct MaterialLook {
    glm::vec3 baseColour{0.5f}; // linear; reflectance at normal incidence when metallic
    float metallic = 0.0f;
    float power = 50.0f;      // Blinn-Phong; the file's roughness is derived from it
    glm::vec3 emissive{0.0f}; // emitted radiance, at most 1
    int colourImage = -1;     // from addColour()
    int heightImage = -1;     // from addHeight()
    bool doubleSided = false;
};

struct Placement {
    glm::vec3 position{0.0f};
    float turnDegrees = 0.0f; // about +Y
    float scale = 1.0f;
};

struct Instance {
    glm::vec3 position{0.0f};
    glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
    float scale = 1.0f;
};

class GltfWriter {
public:
    // Makes the folder. Files are called <name>.gltf, <name>.bin and <name>_<image>.png.
    GltfWriter(std::filesystem::path folder, std::string name);

    int addColour(const std::string& name, const Image& image);
    // Writes the height map and the normal map that shows the same in other viewers.
    int addHeight(const std::string& name, const HeightMap& map);
    int addMaterial(const std::string& name, const MaterialLook& look);
    int addShape(const Shape& shape);
    // Objects of one shape and one material share a mesh.
    // These return the node, for animate().
    int addObject(const std::string& name, int shape, int material, const Placement& placement = {});
    // One node for all (EXT_mesh_gpu_instancing).
    void addInstances(const std::string& name, int shape, int material,
                      const std::vector<Instance>& instances);
    // A chain of joints `spacing` metres apart along +Y, the first at `foot`, and an object of the shape
    // that they deform. Returns the nodes of the joints. The shape stands on the first joint at rest.
    std::vector<int> addChain(const std::string& name, int shape, int material, const Placement& foot,
                              int joints, float spacing);
    int addCamera(const std::string& name, glm::vec3 eye, glm::vec3 target, float yFovDegrees,
                  float nearMetres);
    // lux; the light travels from `from` towards the origin.
    void addDirectional(const std::string& name, glm::vec3 from, glm::vec3 colour, float lux);
    // Nothing farther than `range` metres is lit; 0 = no limit.
    int addPoint(const std::string& name, glm::vec3 position, glm::vec3 colour, float candela, float range);
    void addSpot(const std::string& name, glm::vec3 position, glm::vec3 target, glm::vec3 colour,
                 float candela, float range, float outerConeDegrees);
    // Keyframes of a node's "translation" or "rotation" (x, y, z, w). Rotations move linearly; translations
    // through a spline with the given tangents, metres per second.
    void turn(int node, const std::vector<float>& seconds, const std::vector<glm::quat>& rotations);
    void move(const std::vector<int>& nodes, const std::vector<float>& seconds,
              const std::vector<glm::vec3>& places, const std::vector<glm::vec3>& tangents);
    // Weights of the node's morph targets, all of them for each key, through a spline without slope.
    void weigh(int node, const std::vector<float>& seconds, const std::vector<std::vector<float>>& weights);
    void write() const;

private:
    int addTexture(const std::string& file);
    template<class T>
    int addVectors(const std::vector<T>& values, const char* type)
    {
        return addAccessor(values.data(), values.size() * sizeof(T), 5126, values.size(), type); // floats
    }
    nlohmann::json addTarget(const Shape& from, const Shape& to);
    int addAccessor(const void* data, size_t bytes, int componentType, size_t count, const char* type);
    void use(const char* extension);
    int addMesh(const std::string& name, int shape, int material);
    int addNode(nlohmann::json node, int parent = -1);
    int addLight(nlohmann::json light, nlohmann::json place);
    int addTimes(const std::vector<float>& seconds);
    void addChannels(const std::vector<int>& nodes, const char* path, int input, int output,
                     const char* interpolation);

    struct HeightTextures {
        int height, normal; // glTF textures
        float scale;
    };
    std::filesystem::path folder_;
    std::string name_;
    nlohmann::json json_;
    std::string bin_;
    std::vector<HeightTextures> heights_;
    std::vector<nlohmann::json> shapes_;           // attributes and indices of a primitive
    std::map<std::pair<int, int>, size_t> meshes_; // by shape and material
};

} // namespace lumel::assets
