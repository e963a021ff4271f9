#include "pipeline_cache.h"
#include "core/error.h"
#include "core/file.h"
#include <cstring>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace lumel::gpu {
namespace {

// In front of the data, since drivers need not notice that it is damaged.
std::string hashOf(std::span<const std::byte> data)
{
    return ContentHash().add(data.data(), data.size()).hex();
}

bool isOf(std::span<const std::byte> data, const vk::PhysicalDeviceProperties& device)
{
    VkPipelineCacheHeaderVersionOne header{};
    if (data.size() < sizeof header)
        return false;
    std::memcpy(&header, data.data(), sizeof header);
    return header.headerVersion == VK_PIPELINE_CACHE_HEADER_VERSION_ONE &&
           header.vendorID == device.vendorID && header.deviceID == device.deviceID &&
           std::memcmp(header.pipelineCacheUUID, device.pipelineCacheUUID.data(), VK_UUID_SIZE) == 0;
}

// One per device and driver.
std::filesystem::path fileOf(const vk::PhysicalDeviceProperties& device)
{
    const std::string key = ContentHash()
                                .addValue(device.vendorID)
                                .addValue(device.deviceID)
                                .addValue(device.driverVersion)
                                .add(device.pipelineCacheUUID.data(), VK_UUID_SIZE)
                                .hex();
    return cacheFolder() / (key + ".pipelines");
}

} // namespace

std::vector<std::byte> readPipelineData(const std::filesystem::path& file,
                                        const vk::PhysicalDeviceProperties& device)
{
    if (!std::filesystem::exists(file))
        return {};
    try {
        const std::vector<std::byte> bytes = readFile(file);
        const size_t front = hashOf({}).size();
        if (bytes.size() < front)
            return {};
        const std::span data = std::span(bytes).subspan(front);
        if (std::memcmp(hashOf(data).data(), bytes.data(), front) != 0 || !isOf(data, device))
            return {};
        return {data.begin(), data.end()};
    } catch (const Error&) {
        return {};
    }
}

void writePipelineData(const std::filesystem::path& file, std::span<const std::byte> data)
{
    writeFileAtomically(file,
                        hashOf(data) + std::string(reinterpret_cast<const char*>(data.data()), data.size()));
}

PipelineCache::PipelineCache(const vk::raii::Device& device, const vk::PhysicalDeviceProperties& properties,
                             bool keep)
{
    if (keep)
        try {
            file_ = fileOf(properties);
            known_ = readPipelineData(file_, properties);
        } catch (const Error& e) {
            spdlog::debug("pipelines are not kept: {}", e.what());
        }
    cache_ = vk::raii::PipelineCache(device, vk::PipelineCacheCreateInfo{}.setInitialData<std::byte>(known_));
}

PipelineCache::~PipelineCache()
{
    if (file_.empty())
        return;
    try {
        const std::vector<uint8_t> data = cache_.getData();
        const auto bytes = std::as_bytes(std::span(data));
        if (!std::ranges::equal(bytes, known_))
            writePipelineData(file_, bytes);
        else
            markUsed(file_);
    } catch (const std::exception& e) {
        spdlog::debug("pipelines are not kept: {}", e.what());
    }
}

} // namespace lumel::gpu
