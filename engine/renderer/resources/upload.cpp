#include "upload.h"
#include <glm/gtc/packing.hpp>

namespace lumel {

gpu::Image uploadChain(gpu::UploadBatch& batch, const scene::HalfChain& chain, const std::string& name)
{
    std::vector<std::span<const uint16_t>> levels;
    for (size_t level = 0; level < chain.levels(); ++level)
        levels.push_back(chain.texels(level));
    return batch.halfImage(uint32_t(chain.size().x), uint32_t(chain.size().y), levels, name);
}

gpu::Buffer uploadColours(gpu::UploadBatch& batch, const scene::Mesh& mesh)
{
    if (mesh.colours.empty())
        return {};
    std::vector<glm::uvec2> packed;
    for (const glm::vec4& c : mesh.colours)
        packed.emplace_back(glm::packHalf2x16({c.r, c.g}), glm::packHalf2x16({c.b, c.a}));
    return batch.buffer(packed, mesh.name + " colours", gpu::MemoryKind::geometry);
}

} // namespace lumel
