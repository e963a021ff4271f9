// Where to sample the disc of half vectors. The average G of a texel's lobes is a sum of bumps; nodes
// go where the bumps are, about one per lobe width, because the trapezoidal rule converges
// exponentially for such functions once its spacing falls below the width (Trefethen and Weideman
// 2014, "The exponentially convergent trapezoidal rule").
#pragma once
#include "moments.h"

namespace lumel::baker {

struct Node {
    float x, y, z; // unit half vector
    float area;    // of the disc
};

// One texel's lobes as indices into a Lobes block with their shares of the texel's area.
struct Member {
    uint32_t lobe;
    float share;
};

// A lattice that covers the lobes of one texel (or, over a whole map, of all of them).
// It is laid out in Lambert's azimuthal equal-area map of the hemisphere, which keeps lobes nearly
// round at any tilt and has no singularity at the rim: h.xy = l sqrt(1 - |l|^2 / 4), h.z = 1 - |l|^2 / 2,
// and dx dy = h.z dl.
class Lattice {
public:
    // Nodes for the members of one texel; `mean` are their mean moments.
    static void plan(const Lobes& lobes, const Member* members, size_t count, const Moments& mean,
                     std::vector<Node>& nodes);
    // Nodes for any texel of a map: all normals lie in [lower, upper] (Lambert), no lobe is narrower
    // than `power`.
    static void planShared(glm::vec2 lower, glm::vec2 upper, double power, std::vector<Node>& nodes);
};

inline glm::vec2 lambert(float nx, float ny, float nz)
{
    const float g = std::sqrt(2.0f / (1.0f + nz));
    return {nx * g, ny * g};
}

inline constexpr size_t kMaxNodes = 4096;

} // namespace lumel::baker
