// Textures as a glTF file describes them, read at their finest level.
#pragma once
#include <glm/glm.hpp>
#include <tiny_gltf.h>
#include <vector>

namespace lumel::judge {

// RGBA in [0, 1], row 0 on top.
struct Texels {
    int width = 0, height = 0;
    std::vector<glm::vec4> at;
};

enum class Encoding { linear, srgb };

// glTF 2.0, section 5.30 (textureInfo) with KHR_texture_transform.
struct Texture {
    Texels texels; // RGB decoded to linear; none: the texture is white
    int wrapS = TINYGLTF_TEXTURE_WRAP_REPEAT, wrapT = TINYGLTF_TEXTURE_WRAP_REPEAT;
    int set = 0;               // TEXCOORD_0 or _1
    glm::dmat3 transform{1.0}; // of (u, v, 1)

    bool empty() const { return texels.at.empty(); }
    glm::dvec2 place(const glm::dvec2 uv[2]) const;
    // Bilinear between the four nearest texels.
    glm::vec4 operator()(const glm::dvec2 uv[2]) const;
};

Texture readTexture(const tinygltf::Model& model, int index, int set,
                    const tinygltf::ExtensionMap& extensions, Encoding encoding);
// Of an extension's textureInfo; white where it has none of that name.
Texture readTexture(const tinygltf::Model& model, const tinygltf::Value& extension, const char* name,
                    Encoding encoding);

} // namespace lumel::judge
