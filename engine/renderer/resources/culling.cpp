#include "culling.h"
#include "shared/shading.h"
#include <algorithm>

namespace lumel {

std::vector<uint8_t> objectsInView(const std::vector<GpuObject>& objects, const glm::mat4& clipFromWorld)
{
    std::vector<uint8_t> inView(objects.size(), 0);
    for (size_t i = 0; i < objects.size(); ++i) {
        const glm::mat4 clipFromObject = clipFromWorld * objects[i].data.worldFromObject;
        const Bounds& box = objects[i].bounds;
        // Out of view when all eight corners lie outside the same plane. Planes: left, right, bottom, top,
        // near (reversed depth: z <= w); infinity has no far plane.
        std::array<int, 5> outside{};
        for (int corner = 0; corner < 8; ++corner) {
            const glm::vec4 clip = clipFromObject * glm::vec4(box.corner(corner), 1.0f);
            outside[0] += clip.x < -clip.w;
            outside[1] += clip.x > clip.w;
            outside[2] += clip.y < -clip.w;
            outside[3] += clip.y > clip.w;
            outside[4] += clip.z > clip.w;
        }
        inView[i] = std::none_of(outside.begin(), outside.end(), [](int n) { return n == 8; });
    }
    return inView;
}

float motionInPixels(const std::vector<GpuObject>& objects, const std::vector<uint8_t>& inView,
                     const std::vector<glm::mat4>& before, const glm::mat4& clipFromWorld, glm::uvec2 size)
{
    float farthest = 0.0f;
    for (size_t i = 0; i < objects.size(); ++i) {
        if (!inView[i])
            continue;
        const glm::mat4 now = clipFromWorld * objects[i].data.worldFromObject;
        const Bounds& box = objects[i].bounds;
        for (int point = 0; point < 9; ++point) {
            const glm::vec4 place(point < 8 ? box.corner(point) : box.centre(), 1.0f);
            const glm::vec4 from = before[i] * place, to = now * place;
            if (from.w <= 0.0f || to.w <= 0.0f || std::max(std::abs(to.x), std::abs(to.y)) > to.w)
                continue;
            const glm::vec2 moved = glm::vec2(to) / to.w - glm::vec2(from) / from.w;
            farthest = std::max(farthest, glm::length(0.5f * glm::vec2(size) * moved));
        }
    }
    return farthest;
}

LightSet lightsReaching(const GpuObject& object, std::span<const shared::Light> lights)
{
    const glm::mat4& m = object.data.worldFromObject;
    const glm::vec3 centre = m * glm::vec4(object.bounds.centre(), 1.0f);
    float radius = 0.0f; // to the farthest corner of the box
    for (int corner = 0; corner < 8; ++corner)
        radius = std::max(
            radius, glm::length(glm::mat3(m) * (object.bounds.corner(corner) - object.bounds.centre())));
    LightSet reaching{};
    for (uint32_t i = 0; i < std::min<size_t>(lights.size(), shared::kListedLights); ++i)
        if (shared::lightReaches(lights[i], centre, radius))
            reaching[i / 32] |= 1u << i % 32;
    return reaching;
}

} // namespace lumel
