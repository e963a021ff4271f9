#include "frame_ring.h"
#include "core/error.h"
#include "host_work.h"

namespace lumel::gpu {

static vk::raii::Semaphore makeTimeline(const Device& device)
{
    const vk::SemaphoreTypeCreateInfo type{.semaphoreType = vk::SemaphoreType::eTimeline};
    return {device.handle(), vk::SemaphoreCreateInfo{.pNext = &type}};
}

FrameRing::FrameRing(const Device& device) : device_(device), timeline_(makeTimeline(device)) {}

FrameRing::~FrameRing()
{
    try {
        waitFor(submitted_);
    } catch (const std::exception&) { // the device is lost; its next user says so
    }
}

uint64_t FrameRing::submit(vk::CommandBuffer commands, vk::Fence fence)
{
    device_.submit(commands,
                   vk::SemaphoreSubmitInfo{.semaphore = *timeline_,
                                           .value = submitted_ + 1,
                                           .stageMask = vk::PipelineStageFlagBits2::eAllCommands},
                   fence);
    return ++submitted_;
}

bool FrameRing::waitFor(uint64_t submission)
{
    constexpr uint64_t kTenMinutesNs = 600'000'000'000ull;
    if (submission <= finished_)
        return false;
    const vk::SemaphoreWaitInfo info{.semaphoreCount = 1, .pSemaphores = &*timeline_, .pValues = &submission};
    if (device_.handle().waitSemaphores(info, kTenMinutesNs) != vk::Result::eSuccess)
        throw Error("Vulkan: the device did not finish within ten minutes; lower --size or --samples");
    finished_ = submission;
    return true;
}

void FrameRing::wait(uint64_t submission)
{
    hostWork().waits += waitFor(submission) ? 1 : 0;
}

void FrameRing::waitForPlace(uint64_t submission)
{
    hostWork().ringWaits += waitFor(submission) ? 1 : 0;
}

} // namespace lumel::gpu
