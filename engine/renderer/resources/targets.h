// Render targets of one picture size.
#pragma once
#include "gpu/resource.h"
#include "renderer/settings.h"

namespace lumel {

struct Targets {
    Targets(const gpu::Device& device, const Settings& settings);
    // Throws Error when the device has no such images.
    static void check(const gpu::Device& device, const Settings& settings);
    // Do both settings take the same images?
    static bool same(const Settings& a, const Settings& b);
    gpu::Image hdr;          // linear radiance and coverage, RGBA16F, one sample per pixel
    gpu::Image depth;        // D32, as many samples as the draw pass
    gpu::Image multisampled; // RGBA16F, only with msaa > 1
    gpu::Image sum;          // RGBA32F, reference only
    // Of a frame that is drawn smaller than it is shown, sRGB encoded: as drawn, RGBA16F, and as wide as
    // shown, four pixels a texel (lib/upscale.glsl).
    gpu::Image small, wide;
    gpu::Image display; // RGBA8, sRGB encoded
};

} // namespace lumel
