// The closed-form methods: what a renderer without a fit would use.
#pragma once
#include "moments.h"

namespace lumel::baker {

// `mapNormal` is the texel's normal by the method's own rule where it has one (flat, height).
Shape closedFormShape(Method method, const Moments& mean, glm::vec3 mapNormal);

// Normals of the height map's own MIP levels: average the heights, then differentiate.
class HeightMips {
public:
    HeightMips(const Maps& maps, int width, int height);
    // The normal at texel (x, y) of a level of `width` x `height` texels.
    void setLevel(int width, int height);
    glm::vec3 normal(int x, int y) const;

private:
    const Maps& maps_;
    int fullWidth_, fullHeight_;
    Image level_;
};

} // namespace lumel::baker
