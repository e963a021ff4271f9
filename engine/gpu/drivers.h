// Which Vulkan drivers there are, and which of their devices is meant.
#pragma once
#include <string>
#include <string_view>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

namespace lumel::gpu {

// Before an instance is made: shows the loader the drivers that are installed where it does not look.
// Debian's chromium-common keeps SwiftShader, a second Vulkan driver for the CPU, in a folder of its own.
// VK_DRIVER_FILES takes precedence.
void findDrivers();

// All devices, the best first: discrete, integrated, virtual, then software; SwiftShader after any other.
// Their places in this list are their indices.
std::vector<vk::raii::PhysicalDevice> devicesOf(const vk::raii::Instance& instance);

// Is this text a part of the device's name or of its driver's, whatever the case?
bool isNamed(const vk::raii::PhysicalDevice& device, std::string_view text);

} // namespace lumel::gpu
