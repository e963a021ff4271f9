// The closed-form methods: what a renderer without a fit would use.
#pragma once
#include "moments.h"

namespace lumel::baker {

// `mapNormal` is the texel's normal by the method's own rule where it has one (flat, height).
Shape closedFormShape(Method method, const Moments& mean, glm::vec3 mapNormal);

// Normals of the height map's own MIP levels: average the heights, then differentiate.
class HeightMips {
public:
    // Of a chain whose level 0 has `width` x `height` texels.
    HeightMips(const Maps& maps, int width, int height);
    // The normal at texel (x, y) of a level above 0.
    glm::vec3 normal(int level, int x, int y) const;

private:
    const Maps& maps_;
    int width_, height_;
    std::vector<Image> levels_; // from level 1 on
};

} // namespace lumel::baker
