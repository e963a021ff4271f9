#include "upload.h"
#include <algorithm>
#include <glm/gtc/packing.hpp>

namespace lumel {

namespace {

std::vector<std::span<const uint16_t>> levelsOf(const scene::HalfChain& chain)
{
    std::vector<std::span<const uint16_t>> levels;
    for (size_t level = 0; level < chain.levels(); ++level)
        levels.push_back(chain.texels(level));
    return levels;
}

} // namespace

gpu::Image uploadChain(gpu::UploadBatch& batch, const scene::HalfChain& chain, const std::string& name)
{
    return batch.halfImage(uint32_t(chain.size().x), uint32_t(chain.size().y), levelsOf(chain), name);
}

void refillChain(gpu::UploadBatch& batch, const gpu::Image& image, const scene::HalfChain& before,
                 const scene::HalfChain& after)
{
    uint32_t first = 0;
    while (first < std::min(before.levels(), after.levels()) &&
           std::ranges::equal(before.texels(first), after.texels(first)))
        ++first;
    if (first < after.levels())
        batch.refill(image, first, levelsOf(after));
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
