// Conventions, stated once:
//   right-handed, +Y up, metres (glTF); view space looks along -Z; clip depth in [0, 1], reversed
//   (1 near, 0 far); matrices are named clipFromWorld so that products read with spaces cancelling;
//   tangent frame: x = T, y = B, z = N with glTF's handedness (green up).
#pragma once
#ifndef GLM_FORCE_DEPTH_ZERO_TO_ONE
#define GLM_FORCE_DEPTH_ZERO_TO_ONE
#endif
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

namespace lumel {

struct Bounds {
    glm::vec3 lower{std::numeric_limits<float>::max()};
    glm::vec3 upper{std::numeric_limits<float>::lowest()};

    void add(glm::vec3 p)
    {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    glm::vec3 corner(int i) const // of the eight
    {
        return {i & 1 ? upper.x : lower.x, i & 2 ? upper.y : lower.y, i & 4 ? upper.z : lower.z};
    }
    bool empty() const { return lower.x > upper.x; }
    glm::vec3 centre() const { return 0.5f * (lower + upper); }
    // Radius of the sphere around the box.
    float radius() const { return 0.5f * glm::length(upper - lower); }
};

// Perspective with reversed depth: near plane at 1, infinity at 0 (Lapidous and Jiao 1999: float depth
// is then precise at all distances). yFov in radians, aspect = width / height.
inline glm::mat4 reversedPerspective(float yFov, float aspect, float nearMetres)
{
    const float f = 1.0f / std::tan(0.5f * yFov);
    glm::mat4 m(0.0f);
    m[0][0] = f / aspect;
    m[1][1] = -f; // Vulkan's clip space has +Y down
    m[2][3] = -1.0f;
    m[3][2] = nearMetres;
    return m;
}

// A box of view space, which looks along -Z, to clip space: reversed depth and +Y down as above.
inline glm::mat4 reversedOrthographic(glm::vec3 lower, glm::vec3 upper)
{
    const glm::vec3 size = upper - lower;
    glm::mat4 m(1.0f);
    m[0][0] = 2.0f / size.x;
    m[1][1] = -2.0f / size.y;
    m[2][2] = 1.0f / size.z;
    m[3] = {-(lower.x + upper.x) / size.x, (lower.y + upper.y) / size.y, -lower.z / size.z, 1.0f};
    return m;
}

} // namespace lumel
