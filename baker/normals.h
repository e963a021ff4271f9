// One normal from a height map or a normal map, at that map's own resolution.
#pragma once
#include "bake.h"

namespace lumel::baker {

// Index of texel i on an axis of `size` texels, across the border as `wrap` says.
inline int wrapped(int i, int size, Wrap wrap)
{
    if (wrap == Wrap::clamp)
        return std::min(std::max(i, 0), size - 1);
    if (i >= 0 && i < size)
        return i; // a division takes as long as all else of a normal
    i %= size;
    return i < 0 ? i + size : i;
}

// Normal of the height field h * heightScale by central differences (one-sided at a clamped border).
// Heights and positions are in units of the map's width, texels are square.
glm::vec3 normalFromHeight(const Image& height, float heightScale, Wrap wrap, int x, int y);

// Decoded tangent-space normal with z > 0. Missing blue is rebuilt from x and y; (0, 0, 0) is flat.
glm::vec3 normalFromMap(const Maps& maps, int x, int y);

// The unit normal nearest to `n` that a lobe can have: above the horizon (see lobeNormal()).
glm::vec3 aboveHorizon(glm::vec3 n);

} // namespace lumel::baker
