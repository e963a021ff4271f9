// The coarse levels: texels assembled from cells, rectangles between the borders of all their texels.
#pragma once
#include "averager.h"
#include "chain.h"
#include "solver.h"
#include "tent.h"

namespace lumel::baker {

class CoarseCells {
public:
    // Surveys the source and plans cells for the levels from `firstLevel` on, or from the first level on
    // whose sums fit in the memory allowed.
    CoarseCells(Chain& chain, int firstLevel);
    int firstLevel() const { return firstLevel_; }
    // Nodes that texels of fine levels can share with the cells, or null.
    const Nodes* sharedNodes() const { return canShare_ ? &nodes_ : nullptr; }
    bool isBlack() const { return isBlack_; }
    // The cell of a texel of the first level, where texels nest.
    Cell& at(int x, int y) { return cells_[size_t(y) * size_t(across_) + size_t(x)]; }
    // Or gathers all cells from the source.
    void gatherCells();
    void solveLevel(int number);

private:
    // Borders of the texels of all coarse levels on one axis, ascending.
    static std::vector<double> borders(int size, int firstLevel, int levels);
    void survey();
    void gather(int cell, Lobes& lobes, std::vector<Member>& members) const;
    // Merges cells into those of the levels from `level` on.
    void coarsen(int level);
    void addTexel(int number, int x, int y, Solver& solver) const;
    std::vector<TentShare> shares(int t, int levelTexels, int size, const std::vector<double>& cuts) const;
    // Tents end in the middle of texels, which the borders of the next finer level resolve.
    int cellLevel(int level) const
    {
        return level - (chain_.options_.reconstruction == Reconstruction::bilinear ? 1 : 0);
    }

    Chain& chain_;
    std::vector<double> cutsX_, cutsY_;
    int across_ = 0, down_ = 0;
    std::vector<Cell> cells_;
    Nodes nodes_; // of all cells
    size_t mostNodes_ = 1;
    bool canShare_ = false;
    int firstLevel_;
    bool isBlack_ = false; // no specular anywhere: shapes are fitted as if it were white
    int channels_ = 1;
};

} // namespace lumel::baker
