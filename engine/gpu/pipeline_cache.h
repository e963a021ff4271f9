// Compiled pipelines, kept in the user's cache folder from one run to the next.
#pragma once
#include <filesystem>
#include <span>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

namespace lumel::gpu {

// What a file holds of this device's and driver's pipelines: nothing where it is missing, damaged or
// another's.
std::vector<std::byte> readPipelineData(const std::filesystem::path& file,
                                        const vk::PhysicalDeviceProperties& device);
// Whole or not at all. Throws Error.
void writePipelineData(const std::filesystem::path& file, std::span<const std::byte> data);

class PipelineCache {
public:
    // keep: read now and written at the end. Trouble with the file costs time, nothing else.
    PipelineCache(const vk::raii::Device& device, const vk::PhysicalDeviceProperties& properties, bool keep);
    ~PipelineCache();
    PipelineCache(const PipelineCache&) = delete;
    PipelineCache& operator=(const PipelineCache&) = delete;

    const vk::raii::PipelineCache& handle() const { return cache_; }

private:
    std::filesystem::path file_; // empty: none
    std::vector<std::byte> known_;
    vk::raii::PipelineCache cache_ = nullptr;
};

} // namespace lumel::gpu
