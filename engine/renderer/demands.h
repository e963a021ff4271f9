// What the passes ask of a device beyond the features that every device must have.
#pragma once
#include "gpu/device.h"
#include "settings.h"

namespace lumel {

gpu::Demands rendererDemands();
// The options, for a device that is to render.
gpu::DeviceOptions forRendering(gpu::DeviceOptions options);
// Throws Error when the device has no images of the wanted sizes. Before a scene is loaded and baked.
void checkSizes(const gpu::Device& device, const Settings& settings);

} // namespace lumel
