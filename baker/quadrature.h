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
    void resize(size_t count);
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

private:
    void cover(glm::vec2 lower, glm::vec2 step, int n1, int n2);
    void layOut(const struct Whitening& whitening, glm::vec2 lower, glm::vec2 step, int n1, int n2,
                NodeSet& nodes);
    std::vector<glm::vec3> discs_;       // of the members: whitened centre and radius
    std::vector<unsigned char> covered_; // lattice points within some disc
};

// A lattice for any texel of a map, or the rule for the whole disc where lobes are broad.
class SharedLattice {
public:
    // All lobes lie in [lower, upper] (Lambert); those that matter have at most `power`. No more
    // than `mostNodes` nodes: narrower lobes then are sampled too sparsely for their own sake, which
    // only shows where few of them stand alone.
    void plan(glm::vec2 lower, glm::vec2 upper, double power, size_t mostNodes);

    const NodeSet& nodes() const { return nodes_; }
    // Runs of consecutive nodes that cover the disc of a lobe: calls run(first, count).
    template<class Run>
    void around(glm::vec2 centre, float radius, const Run& run) const
    {
        if (across_ == 0)
            return run(size_t(0), nodes_.size());
        const int first = std::max(0, int(std::ceil((centre.y - radius - from_.y) / step_.y - 0.5f)));
        const int last = std::min(down_ - 1, int(std::floor((centre.y + radius - from_.y) / step_.y - 0.5f)));
        for (int j = first; j <= last; ++j) {
            const float dy = from_.y + (float(j) + 0.5f) * step_.y - centre.y;
            const float half = std::sqrt(std::max(0.0f, radius * radius - dy * dy));
            const int begin = std::max(0, int(std::ceil((centre.x - half - from_.x) / step_.x - 0.5f)));
            const int end =
                std::min(across_ - 1, int(std::floor((centre.x + half - from_.x) / step_.x - 0.5f)));
            if (begin <= end)
                run(size_t(j) * size_t(stride_) + size_t(begin), size_t(end - begin + 1));
        }
    }

private:
    NodeSet nodes_;
    glm::vec2 from_{0.0f}, step_{1.0f};
    int across_ = 0, down_ = 0; // 0: not a lattice
    int stride_ = 0;            // nodes from row to row: whole vectors
};

// Radius of a lobe's support in Lambert's map, given the smaller eigenvalue of its precision.
float supportRadius(float lowestPower);

inline glm::vec2 lambert(float nx, float ny, float nz)
{
    const float g = std::sqrt(2.0f / (1.0f + nz));
    return {nx * g, ny * g};
}

inline constexpr size_t kMaxNodes = 4096;

} // namespace lumel::baker
