#include "upload.h"
#include <glm/gtc/packing.hpp>
#include <tbb/parallel_for.h>

namespace lumel {
namespace {

using baker::kChannels;
using HalfLevels = std::vector<std::vector<uint16_t>>;

// Four channels of every level, packed to half floats.
HalfLevels packLevels(const baker::ReflectanceMips& mips, const std::array<baker::Channel, 4>& channels)
{
    HalfLevels packed;
    for (const baker::Level& level : mips.levels) {
        const size_t count = size_t(level.width) * level.height;
        std::vector<uint16_t> halves(count * 4);
        tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 65536), [&](const auto& range) {
            std::vector<float> row(range.size() * 4);
            for (size_t i = range.begin(); i < range.end(); ++i)
                for (size_t c = 0; c < 4; ++c)
                    row[(i - range.begin()) * 4 + c] = level.texels[i * kChannels + size_t(channels[c])];
            floatsToHalf(row, halves.data() + range.begin() * 4);
        });
        packed.push_back(std::move(halves));
    }
    return packed;
}

} // namespace

gpu::Image uploadChannels(const gpu::Device& device, const baker::ReflectanceMips& mips,
                          const std::array<baker::Channel, 4>& channels, const std::string& name)
{
    return gpu::uploadHalfImage(device, uint32_t(mips.levels.front().width),
                                uint32_t(mips.levels.front().height), packLevels(mips, channels), name);
}

gpu::Image uploadChain(const gpu::Device& device, const std::vector<Image>& chain, const std::string& name)
{
    HalfLevels packed;
    for (const Image& image : chain) {
        const size_t count = size_t(image.width) * image.height;
        std::vector<float> rgba(count * 4, 1.0f);
        for (size_t i = 0; i < count; ++i)
            std::copy_n(image.pixels.data() + i * size_t(image.channels), image.channels,
                        rgba.data() + i * 4);
        packed.emplace_back(rgba.size());
        floatsToHalf(rgba, packed.back().data());
    }
    return gpu::uploadHalfImage(device, uint32_t(chain.front().width), uint32_t(chain.front().height), packed,
                                name);
}

gpu::Buffer uploadColours(const gpu::Device& device, const scene::Mesh& mesh)
{
    if (mesh.colours.empty())
        return {};
    std::vector<glm::uvec2> packed;
    for (const glm::vec4& c : mesh.colours)
        packed.emplace_back(glm::packHalf2x16({c.r, c.g}), glm::packHalf2x16({c.b, c.a}));
    return gpu::uploadBuffer(device, packed, mesh.name + " colours");
}

} // namespace lumel
