#include "drivers.h"
#include <algorithm>
#include <cstdlib>
#include <filesystem>

namespace lumel::gpu {
namespace {

constexpr const char* kSwiftShader = "/usr/lib/chromium/vk_swiftshader_icd.json";

vk::PhysicalDeviceDriverProperties driverOf(const vk::raii::PhysicalDevice& device)
{
    return device.getProperties2<vk::PhysicalDeviceProperties2, vk::PhysicalDeviceDriverProperties>()
        .get<vk::PhysicalDeviceDriverProperties>();
}

int preference(const vk::raii::PhysicalDevice& device)
{
    switch (device.getProperties().deviceType) {
    case vk::PhysicalDeviceType::eDiscreteGpu:
        return 0;
    case vk::PhysicalDeviceType::eIntegratedGpu:
        return 1;
    case vk::PhysicalDeviceType::eVirtualGpu:
        return 2;
    default:
        return driverOf(device).driverID == vk::DriverId::eGoogleSwiftshader ? 4 : 3;
    }
}

std::string lowered(std::string_view text)
{
    std::string result(text);
    std::transform(result.begin(), result.end(), result.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return result;
}

bool isSet(const char* variable)
{
    const char* value = std::getenv(variable);
    return value && *value;
}

} // namespace

void findDrivers()
{
    // Once, by the first thread that gets here: others may not read the environment meanwhile.
    static const bool done = [] {
        const char* add =
            "VK_ADD_DRIVER_FILES"; // the loader's, since 1.3.207; it ignores what it cannot load
        if (!isSet("VK_DRIVER_FILES") && !isSet("VK_ICD_FILENAMES") && !isSet(add) &&
            std::filesystem::exists(kSwiftShader))
            setenv(add, kSwiftShader, 1);
        return true;
    }();
    (void)done;
}

std::vector<vk::raii::PhysicalDevice> devicesOf(const vk::raii::Instance& instance)
{
    std::vector<vk::raii::PhysicalDevice> devices;
    try {
        for (auto& device : vk::raii::PhysicalDevices(instance))
            devices.push_back(std::move(device));
    } catch (const vk::SystemError&) { // no driver
    }
    std::stable_sort(devices.begin(), devices.end(),
                     [](const auto& a, const auto& b) { return preference(a) < preference(b); });
    return devices;
}

bool isNamed(const vk::raii::PhysicalDevice& device, std::string_view text)
{
    const auto driver = driverOf(device);
    std::string names =
        std::string(device.getProperties().deviceName.data()) + '\n' + driver.driverName.data();
    if (driver.driverID == vk::DriverId::eMesaLlvmpipe)
        names += "\nlavapipe"; // as Mesa calls its Vulkan driver, whose names are those of its OpenGL driver
    return lowered(names).find(lowered(text)) != std::string::npos;
}

} // namespace lumel::gpu
