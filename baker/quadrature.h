// Where to sample the disc of half vectors. The average G of a texel's lobes is a sum of bumps; nodes
// go where the bumps are, about one per lobe width, because the trapezoidal rule converges
// exponentially for such functions once its spacing falls below the width (Trefethen and Weideman
// 2014, "The exponentially convergent trapezoidal rule").
#pragma once
#include "moments.h"

namespace lumel::baker {

// Nodes as arrays, padded to a multiple of the widest vector by nodes of no area.
struct NodeSet {
    std::vector<float> x, y, z; // unit half vectors
    std::vector<float> area;    // of the disc
    size_t size() const { return x.size(); }
    void clear();
    void add(float nx, float ny, float nz, float nodeArea);
    void pad();
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
    void plan(const Lobes& lobes, const std::vector<Member>& members, const Moments& mean, NodeSet& nodes);
    // Nodes for any texel of a map: all normals lie in [lower, upper] (Lambert), no lobe is narrower
    // than `power`.
    static void planShared(glm::vec2 lower, glm::vec2 upper, double power, NodeSet& nodes);

private:
    void cover(glm::vec2 lower, glm::vec2 step, int n1, int n2);
    std::vector<glm::vec3> discs_;       // of the members: whitened centre and radius
    std::vector<unsigned char> covered_; // lattice points within some disc
};

inline glm::vec2 lambert(float nx, float ny, float nz)
{
    const float g = std::sqrt(2.0f / (1.0f + nz));
    return {nx * g, ny * g};
}

inline constexpr size_t kMaxNodes = 4096;

} // namespace lumel::baker
