#include "deform_pass.h"
#include <algorithm>

namespace lumel {

void DeformPass::prepare(const Frame& frame)
{
    const auto& kinds = frame.scene.surfaceKinds();
    if (!pipeline_.handle.begun() && std::ranges::any_of(kinds, &SurfaceKind::deformed))
        pipeline_ = gpu::makeComputePipeline(frame.device, "deform.comp", {*frame.scene.frameSet().layout()},
                                             sizeof(shared::DeformPush));
}

void DeformPass::record(Frame& frame)
{
    DeformedMeshes& meshes = frame.scene.deformedMeshes();
    std::vector<uint8_t> wanted(meshes.items().size(), 0);
    const bool shadows = !frame.scene.lights().shadows().empty();
    for (size_t i = 0; i < frame.inView.size(); ++i) {
        const GpuObject& object = frame.scene.objects()[i];
        // What is out of view may cast its shadow into it.
        if (object.deformed >= 0 && (frame.inView[i] || (shadows && object.casts)))
            wanted[size_t(object.deformed)] = meshes.items()[size_t(object.deformed)].stale;
    }
    if (std::none_of(wanted.begin(), wanted.end(), [](uint8_t is) { return is != 0; }))
        return;
    const PassScope scope(frame, "deform");
    bindSets(frame, vk::PipelineBindPoint::eCompute, pipeline_);
    for (size_t i = 0; i < wanted.size(); ++i) {
        if (!wanted[i])
            continue;
        const shared::DeformPush push = meshes.write(i);
        pushConstants(frame.commands, pipeline_, push);
        constexpr uint32_t kMostGroups = 32768; // a group takes more vertices where there are more
        frame.commands.dispatch(std::min(groupsOf64(push.vertexCount), kMostGroups), 1, 1);
    }
    gpu::memoryBarrier(frame.commands, gpu::Use::computeWrite, gpu::Use::general);
}

} // namespace lumel
