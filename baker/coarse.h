// The coarse levels: average reflectance on shared nodes, summed from cells.
#pragma once
#include "chain.h"
#include "group.h"

namespace lumel::baker {

class CoarseCells {
public:
    // Averages the whole source for the levels from `firstLevel` on.
    CoarseCells(Chain& chain, int firstLevel);
    void solveLevel(int number);

private:
    struct Cell {
        Moments sum;
        glm::vec2 lower{1e30f}, upper{-1e30f}; // Lambert coordinates of its normals
        bool uniform = true;                   // one and the same lobe throughout
        Shape shape;
    };
    // Borders of the texels of all coarse levels on one axis, ascending.
    static std::vector<double> borders(int size, int firstLevel, int levels);
    void gather(int cell, Lobes& lobes, std::vector<Member>& members) const;
    void gatherMoments();
    void averageCells();
    void solveTexel(int number, int x, int y, std::vector<Node>& nodes, std::vector<float>* g,
                    TexelTask& task);

    Chain& chain_;
    std::vector<double> cutsX_, cutsY_;
    int across_ = 0, down_ = 0;
    std::vector<Cell> cells_;
    std::vector<Node> nodes_;
    int channels_ = 1;
    std::vector<float> g_; // [cell][channel][node], area-weighted sums
};

} // namespace lumel::baker
