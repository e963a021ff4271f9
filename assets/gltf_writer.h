// A glTF 2.0 scene put together piece by piece and written as .gltf, .bin and PNG files.
#pragma once
#include "geometry.h"
#include "maps.h"
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lumel::assets {

struct MaterialLook {
    glm::vec3 baseColour{0.5f}; // linear; reflectance at normal incidence when metallic
    float metallic = 0.0f;
    float power = 50.0f;  // Blinn-Phong; the file's roughness is derived from it
    int colourImage = -1; // from addColour()
    int heightImage = -1; // from addHeight()
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
    void addObject(const std::string& name, int shape, int material, glm::vec3 position = glm::vec3(0.0f));
    void addCamera(const std::string& name, glm::vec3 eye, glm::vec3 target, float yFovDegrees,
                   float nearMetres);
    // lux; the light travels from `from` towards the origin.
    void addDirectional(const std::string& name, glm::vec3 from, glm::vec3 colour, float lux);
    void addPoint(const std::string& name, glm::vec3 position, glm::vec3 colour, float candela);
    void write() const;

private:
    int addTexture(const std::string& file);
    int addAccessor(const void* data, size_t bytes, int componentType, size_t count, const char* type);
    int addNode(nlohmann::json node);
    void addLight(const std::string& name, const char* type, glm::vec3 colour, float intensity,
                  nlohmann::json place);

    struct HeightTextures {
        int height, normal; // glTF textures
        float scale;
    };
    std::filesystem::path folder_;
    std::string name_;
    nlohmann::json json_;
    std::string bin_;
    std::vector<HeightTextures> heights_;
    std::vector<nlohmann::json> shapes_; // attributes and indices of a primitive
};

} // namespace lumel::assets
