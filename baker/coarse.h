// The coarse levels: average reflectance on shared nodes, summed from cells.
#pragma once
#include "averager.h"
#include "chain.h"
#include "solver.h"
#include "tent.h"

namespace lumel::baker {

class CoarseCells {
public:
    // Surveys the source in cells for the levels from `firstLevel` on, or from the first level on whose
    // averages fit in the memory allowed.
    CoarseCells(Chain& chain, int firstLevel);
    int firstLevel() const { return firstLevel_; }
    // Averages the whole source; then the levels are solved one after the other.
    void averageCells();
    void solveLevel(int number);

private:
    struct Cell {
        Moments sum;
        glm::vec2 lower{1e30f}, upper{-1e30f}; // Lambert coordinates of its normals
        bool uniform = true;                   // one and the same lobe throughout
        Shape shape;
        void merge(const Cell& other, double factor = 1.0);
    };
    // Borders of the texels of all coarse levels on one axis, ascending.
    static std::vector<double> borders(int size, int firstLevel, int levels);
    void gather(int cell, Lobes& lobes, std::vector<Member>& members) const;
    void gatherMoments();
    void planNodes();
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
    SharedLattice lattice_;
    int firstLevel_;
    bool black_ = false; // no specular anywhere: shapes are fitted as if it were white
    int channels_ = 1;
    std::vector<float> g_; // [cell][channel][node], area-weighted sums
};

} // namespace lumel::baker
