// GGX levels as the maps that engines read.
#pragma once
#include "ggx.h"

namespace lumel::baker {

// Which channels hold roughness and metalness:
//   gltf    metallic_roughness: G roughness, B metalness
//   orm     occlusion_roughness_metallic: R occlusion (1), G roughness, B metalness
//   unity   metallic_smoothness: RGB metalness, A smoothness, 1 - roughness
//   unreal  roughness, metallic: one channel each
enum class Packing { gltf, orm, unity, unreal };

enum class ColourSpace { linear, srgb };

struct MapChannel {
    std::string name;    // "G"
    std::string meaning; // "perceptual roughness"
    std::string decoded; // "value", "2 value - 1": from what is stored in [0, 1]
};

// Values are in [0, 1] and linear; whoever stores 8 bits encodes sRGB.
struct ExportMap {
    std::string name; // "normal"
    ColourSpace colourSpace = ColourSpace::linear;
    bool isNormal = false; // the third channel follows from the others
    std::vector<MapChannel> channels;
    std::vector<Image> levels;
};

struct MapOptions {
    Packing packing = Packing::gltf;
    bool normalGreenUp = true;
    bool anisotropic = false; // adds the texture of KHR_materials_anisotropy
};

// Normal, roughness and metalness, base colour and specular, each with all levels.
std::vector<ExportMap> makeMaps(const std::vector<GgxLevel>& levels, const MapOptions& options);

// glTF 2.0, appendix B: what metalness and base colour give this diffuse colour and F0, with dielectrics of
// F0 = 0.04.
struct MetallicColour {
    float metallic;
    glm::vec3 baseColour;
};
MetallicColour metallicColour(glm::vec3 diffuse, glm::vec3 f0);

// Perceptual roughness as glTF defines it; with anisotropy that across the highlight.
float roughnessOf(const GgxTexel& texel, bool anisotropic);
// KHR_materials_anisotropy: direction in the tangent frame and strength in [0, 1].
glm::vec3 anisotropyOf(const GgxTexel& texel);

} // namespace lumel::baker
