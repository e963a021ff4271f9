#include "draw_list.h"
#include <algorithm>

namespace lumel {
namespace {

using Command = vk::DrawIndexedIndirectCommand;

Command commandOf(const GpuObject& object, uint32_t index)
{
    return {object.indexCount, 1, object.firstIndex, int32_t(object.firstVertex), index};
}

} // namespace

DrawList::DrawList(const gpu::Device& device, size_t objects)
    : most_(device.limits().mostIndirectDraws),
      commands_(device, std::max<size_t>(objects, 1) * sizeof(Command), gpu::MemoryUsage::device,
                "draw commands")
{
}

void DrawList::write(Frame& frame, std::vector<uint32_t> objects)
{
    constexpr size_t kMostAtOnce = 65536 / sizeof(Command); // vkCmdUpdateBuffer takes so many bytes
    objects_ = std::move(objects);
    if (most_ == 0 || objects_.empty())
        return;
    std::vector<Command> commands;
    commands.reserve(objects_.size());
    for (const uint32_t object : objects_)
        commands.push_back(commandOf(frame.scene.objects()[object], object));
    gpu::memoryBarrier(frame.commands, gpu::Use::indirectRead, gpu::Use::transferWrite);
    for (size_t i = 0; i < commands.size(); i += kMostAtOnce) {
        const auto part = std::span(commands).subspan(i, std::min(kMostAtOnce, commands.size() - i));
        frame.commands.updateBuffer(commands_.handle(), i * sizeof(Command), part.size_bytes(), part.data());
    }
    gpu::memoryBarrier(frame.commands, gpu::Use::transferWrite, gpu::Use::indirectRead);
}

void DrawList::draw(Frame& frame) const
{
    const auto& all = frame.scene.objects();
    for (size_t first = 0, end = 0; first < objects_.size(); first = end) {
        const GpuObject& o = all[objects_[first]];
        do {
            ++end;
        } while (end < objects_.size() && end - first < most_ && drawAlike(o, all[objects_[end]]));
        bindMesh(frame, o, 0);
        if (end - first > 1) {
            frame.commands.drawIndexedIndirect(commands_.handle(), first * sizeof(Command),
                                               uint32_t(end - first), sizeof(Command));
        } else {
            const Command c = commandOf(o, objects_[first]);
            frame.commands.drawIndexed(c.indexCount, 1, c.firstIndex, c.vertexOffset, c.firstInstance);
        }
    }
}

} // namespace lumel
