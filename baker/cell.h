// Sums over the lobes under a texel or under a cell of the map. They filter up the chain, so that level-0
// lobes are read and evaluated once.
#pragma once
#include "lobe_list.h"
#include "quadrature.h"

namespace lumel::baker {

// Area-weighted sum of lobes at quadrature nodes: a rectangle of a lattice, or the whole rule.
struct Patch {
    Nodes nodes;
    Sublattice sublattice;                     // where lobes are summed and nodes are to be
    int x0 = 0, y0 = 0, width = 0, height = 0; // lattice points; the rule is one row
    std::vector<float> g;                      // [channel][height][width]

    size_t size() const { return size_t(width) * size_t(height); }
    // No sums yet, over the points from `from` to `to` (exclusive); a rule ignores them.
    void reset(const Nodes& nodes, glm::ivec2 from, glm::ivec2 to, int channels);
    // Adds `other` on the same nodes, growing where it reaches further.
    void add(const Patch& other, float factor, int channels);
    // Appends the nodes at which the sums are not negligible, and `factor` times the sums there; padded.
    void appendTo(NodeSet& to, std::vector<float>* sums, float factor, int channels) const;

private:
    struct Block {
        int x0, y0, x1, y1; // of the rectangle
    };
    size_t appendBlock(NodeSet& to, std::vector<float>* sums, size_t end, float peak, const Block& block,
                       int channels) const;
    size_t appendMerged(NodeSet& to, std::vector<float>* sums, size_t end, float peak, int channels) const;
};

struct Cell {
    Moments sum;
    bool uniform = true; // one and the same lobe throughout
    Shape shape;         // that lobe
    Patch patch;         // the sum of the lobes, or
    LobeList list;       // the lobes

    // Clears all; keeps the memory.
    void clear();
    void add(const Lobes& lobes, size_t lobe, double area);
    void merge(const Cell& other, double factor, int channels);
    // One lobe stands for equal ones, a few for many.
    void shortenList();
};

} // namespace lumel::baker
