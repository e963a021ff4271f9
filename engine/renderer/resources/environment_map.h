// An environment on the GPU, which all renderers that show it share.
#pragma once
#include "gpu/resource.h"
#include "scene/environment.h"
#include <array>

namespace lumel {

class EnvironmentMap {
public:
    // Null: none. There is a map nevertheless, a black one.
    EnvironmentMap(const gpu::Device& device, const scene::Environment* environment);

    bool exists() const { return exists_; }
    vk::ImageView view() const { return levels_.view(); }
    // Coefficients of shared::environmentDiffuse(); of none they are 0.
    const std::array<glm::vec3, 9>& diffuse() const { return diffuse_; }

private:
    bool exists_;
    gpu::Image levels_;
    std::array<glm::vec3, 9> diffuse_{};
};

} // namespace lumel
