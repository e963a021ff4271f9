// GPU time of each pass, from timestamps written between passes (inside one rendering pass they mean
// nothing on software devices).
#pragma once
#include "device.h"

namespace lumel::gpu {

class Timer {
public:
    static constexpr uint32_t kMaxScopes = 32;
    explicit Timer(const Device& device);

    void reset(vk::CommandBuffer commands); // at the start of a frame
    void begin(vk::CommandBuffer commands, const char* name);
    void end(vk::CommandBuffer commands);

    // Milliseconds per scope in recorded order, after the frame's commands have finished.
    std::vector<std::pair<std::string, double>> results() const;

private:
    const Device& device_;
    vk::raii::QueryPool pool_ = nullptr;
    std::vector<std::string> names_;
};

} // namespace lumel::gpu
