#include "light_pass.h"

namespace lumel {

LightPass::LightPass(const gpu::Device& device, const GpuScene& scene, const LitPool& pool)
    : light_(gpu::makeComputePipeline(device, "light.comp", {*scene.materialLayout(), *pool.lightLayout()},
                                      sizeof(shared::LightPush))),
      lower_(gpu::makeComputePipeline(device, "lower.comp", {*pool.lowerLayout()}, sizeof(shared::LightPush)))
{
}

size_t LightPass::listTiles(Frame& frame)
{
    std::vector<shared::Tile> tiles;
    jobs_.clear();
    size_t lit = 0;
    for (uint32_t mip = 0; mip < shared::kMaxLevels; ++mip)
        for (uint32_t i = 0; i < frame.room.objects.size(); ++i) {
            const tsl::ObjectRoom& room = frame.room.objects[i];
            const GpuTexelMap* map = frame.scene.objects()[i].texelMap;
            if (room.texture < 0 || room.litLevel + mip >= map->map.levels)
                continue;
            const auto& occupied = map->tiles[room.litLevel + mip];
            jobs_.push_back({i, mip, uint32_t(tiles.size()), uint32_t(occupied.size())});
            for (const glm::uvec2 tile : occupied)
                tiles.push_back({i, tile.x, tile.y});
            if (mip == 0)
                lit += occupied.size();
        }
    const size_t bytes = tiles.size() * sizeof(shared::Tile);
    if (bytes > tiles_.size())
        tiles_ = gpu::Buffer(frame.device, bytes + bytes / 2, gpu::Buffer::Home::host, "tiles");
    std::memcpy(tiles_.mapped<void>(), tiles.data(), bytes);
    return lit;
}

void LightPass::recordLight(Frame& frame, LitPool& pool)
{
    const PassScope scope(frame, "light");
    const vk::CommandBuffer commands = frame.commands;
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *light_.handle);
    for (const Job& job : jobs_) {
        if (job.mip != 0)
            break;
        LitTexture& texture = pool.texture(frame.room.objects[job.object].texture);
        gpu::imageBarrier(commands, texture.image.handle(), texture.image.aspect(),
                          texture.written ? gpu::Use::fragmentSample : gpu::Use::undefined,
                          gpu::Use::computeReadWrite);
        texture.written = true;
        const vk::DescriptorSet sets[] = {*frame.scene.objects()[job.object].material->set,
                                          *texture.lightSet};
        commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *light_.layout, 0, sets, nullptr);
        pushConstants(commands, light_,
                      shared::LightPush{.view = frame.view,
                                        .tiles = tiles_.address() + job.firstTile * sizeof(shared::Tile),
                                        .mip = 0});
        commands.dispatch(job.tileCount, 1, 1);
    }
}

void LightPass::recordLower(Frame& frame, LitPool& pool)
{
    const PassScope scope(frame, "lower");
    const vk::CommandBuffer commands = frame.commands;
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *lower_.handle);
    uint32_t mip = 0;
    for (const Job& job : jobs_) {
        if (job.mip == 0)
            continue;
        if (job.mip != mip) // one barrier a MIP for all objects
            gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::computeReadWrite);
        mip = job.mip;
        const LitTexture& texture = pool.texture(frame.room.objects[job.object].texture);
        commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *lower_.layout, 0,
                                    *texture.lowerSets[job.mip - 1], nullptr);
        pushConstants(commands, lower_,
                      shared::LightPush{.view = frame.view,
                                        .tiles = tiles_.address() + job.firstTile * sizeof(shared::Tile),
                                        .mip = job.mip});
        commands.dispatch(job.tileCount, 1, 1);
    }
    for (const Job& job : jobs_)
        if (job.mip == 0) {
            const LitTexture& texture = pool.texture(frame.room.objects[job.object].texture);
            gpu::imageBarrier(commands, texture.image.handle(), texture.image.aspect(),
                              gpu::Use::computeReadWrite, gpu::Use::fragmentSample);
        }
}

} // namespace lumel
