// What the readers hand over, as images and buffers on the GPU.
#pragma once
#include "gpu/upload.h"
#include "scene/half_maps.h"
#include "scene/scene.h"

namespace lumel {

gpu::Image uploadChain(gpu::UploadBatch& batch, const scene::HalfChain& chain, const std::string& name);
// Of one of this size that holds `before`, whose levels that do not differ are left out; empty: all are
// filled.
void refillChain(gpu::UploadBatch& batch, const gpu::Image& image, const scene::HalfChain& before,
                 const scene::HalfChain& after);
// Of vertices, four half floats each; nothing where there are none.
gpu::Buffer uploadColours(gpu::UploadBatch& batch, const scene::Mesh& mesh);

} // namespace lumel
