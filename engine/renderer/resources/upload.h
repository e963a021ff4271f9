// What the readers hand over, as images and buffers on the GPU.
#pragma once
#include "gpu/resource.h"
#include "scene/half_maps.h"
#include "scene/scene.h"

namespace lumel {

gpu::Image uploadChain(const gpu::Device& device, const scene::HalfChain& chain, const std::string& name);
// Of vertices, four half floats each; nothing where there are none.
gpu::Buffer uploadColours(const gpu::Device& device, const scene::Mesh& mesh);

} // namespace lumel
