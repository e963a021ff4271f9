#include "timer.h"
#include <cassert>

namespace lumel::gpu {

Timer::Timer(const Device& device)
    : device_(device),
      pool_(device.handle(), {.queryType = vk::QueryType::eTimestamp, .queryCount = 2 * kMaxScopes})
{
}

void Timer::reset(vk::CommandBuffer commands)
{
    commands.resetQueryPool(*pool_, 0, 2 * kMaxScopes);
    names_.clear();
}

void Timer::begin(vk::CommandBuffer commands, const char* name)
{
    assert(names_.size() < kMaxScopes);
    commands.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, *pool_, uint32_t(2 * names_.size()));
    names_.emplace_back(name);
    // Software Vulkan takes the timestamp when it flushes, which a dispatch alone does not cause but any
    // barrier does. One without contents orders nothing: other devices go on.
    commands.pipelineBarrier2(vk::DependencyInfo{});
}

void Timer::end(vk::CommandBuffer commands)
{
    commands.writeTimestamp2(vk::PipelineStageFlagBits2::eAllCommands, *pool_,
                             uint32_t(2 * names_.size() - 1));
}

std::vector<std::pair<std::string, double>> Timer::results() const
{
    std::vector<std::pair<std::string, double>> times;
    if (names_.empty())
        return times;
    const uint32_t count = uint32_t(2 * names_.size());
    const auto ticks =
        pool_.getResults<uint64_t>(0, count, count * sizeof(uint64_t), sizeof(uint64_t),
                                   vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
    const double msPerTick = device_.properties().limits.timestampPeriod * 1e-6;
    for (size_t i = 0; i < names_.size(); ++i)
        times.emplace_back(names_[i], double(ticks.second[2 * i + 1] - ticks.second[2 * i]) * msPerTick);
    return times;
}

} // namespace lumel::gpu
