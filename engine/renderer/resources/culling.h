// What the view, and what each light, may reach, by the objects' boxes.
#pragma once
#include "gpu_object.h"
#include <array>
#include <span>
#include <vector>

namespace lumel {

// Per object: does its box meet the view volume?
std::vector<uint8_t> objectsInView(const std::vector<GpuObject>& objects, const glm::mat4& clipFromWorld);

// The farthest that a corner or the centre of an object's box has moved across a picture of `size` pixels
// since objects were drawn with `before` (clip from object), of those that are now in the picture.
float motionInPixels(const std::vector<GpuObject>& objects, const std::vector<uint8_t>& inView,
                     const std::vector<glm::mat4>& before, const glm::mat4& clipFromWorld, glm::uvec2 size);

// Bit i of word i / 32 is light i. Beyond kListedLights, lights are taken to reach everything.
using LightSet = std::array<uint32_t, shared::kListedLights / 32>;
inline bool contains(const LightSet& lights, uint32_t light)
{
    return light >= shared::kListedLights || (lights[light / 32] >> light % 32 & 1u);
}
// The lights that may reach the object, by its bounding ball.
LightSet lightsReaching(const GpuObject& object, std::span<const shared::Light> lights);

} // namespace lumel
