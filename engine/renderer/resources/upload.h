// What the baker and the readers hand over as floats, as half-float images and buffers on the GPU.
#pragma once
#include "baker/bake.h"
#include "core/image.h"
#include "gpu/resource.h"
#include "scene/scene.h"
#include <array>

namespace lumel {

// Four channels of every level.
gpu::Image uploadChannels(const gpu::Device& device, const baker::ReflectanceMips& mips,
                          const std::array<baker::Channel, 4>& channels, const std::string& name);
// Of one to four channels; missing ones are 1.
gpu::Image uploadChain(const gpu::Device& device, const std::vector<Image>& chain, const std::string& name);
// Of vertices, four half floats each; nothing where there are none.
gpu::Buffer uploadColours(const gpu::Device& device, const scene::Mesh& mesh);

} // namespace lumel
