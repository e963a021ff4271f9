#include "normals.h"
#include "shared/lobe.h"

namespace lumel::baker {

glm::vec3 aboveHorizon(glm::vec3 n)
{
    const float length2 = glm::dot(n, n);
    if (!(length2 > 1e-20f))
        return {0.0f, 0.0f, 1.0f};
    n /= std::sqrt(length2);
    // lobeNormal() pulls what lies on or below the rim of the disc inside; the direction stays.
    if (n.z <= 0.0f) {
        const float r = std::hypot(n.x, n.y);
        return r > 0.0f ? shared::lobeNormal(glm::vec2(n) / r) : glm::vec3(0.0f, 0.0f, 1.0f);
    }
    return n.z * n.z < 1e-4f ? shared::lobeNormal(glm::vec2(n)) : n;
}

glm::vec3 normalFromHeight(const Image& height, float heightScale, Wrap wrap, int x, int y)
{
    const auto slope = [&](int i0, int j0, int i1, int j1, bool clampedEnd) {
        const float difference = *height.at(i1, j1) - *height.at(i0, j0);
        return difference * heightScale * float(height.width) * (clampedEnd ? 1.0f : 0.5f);
    };
    const bool endX = wrap == Wrap::clamp && (x == 0 || x == height.width - 1);
    const bool endY = wrap == Wrap::clamp && (y == 0 || y == height.height - 1);
    const float dx =
        slope(wrapped(x - 1, height.width, wrap), y, wrapped(x + 1, height.width, wrap), y, endX);
    const float dy =
        slope(x, wrapped(y - 1, height.height, wrap), x, wrapped(y + 1, height.height, wrap), endY);
    // Rows run down and B runs up, so the slope along B is -dy.
    return aboveHorizon({-dx, dy, 1.0f});
}

glm::vec3 normalFromMap(const Maps& maps, int x, int y)
{
    const float* texel = maps.normal.at(x, y);
    const auto decode = [&](float v) { return maps.signedNormals ? v : 2.0f * v - 1.0f; };
    glm::vec3 n(decode(texel[0]), decode(texel[1]), 0.0f);
    if (maps.normal.channels >= 3)
        n.z = decode(texel[2]);
    else
        n.z = std::sqrt(std::max(0.0f, 1.0f - n.x * n.x - n.y * n.y));
    if (!maps.normalGreenUp)
        n.y = -n.y;
    n.x *= maps.normalScale;
    n.y *= maps.normalScale;
    return aboveHorizon(n);
}

} // namespace lumel::baker
