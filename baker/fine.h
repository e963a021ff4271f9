// Fine levels: texels that cover few lobes are gathered from them, or from the texels below.
#pragma once
#include "averager.h"
#include "chain.h"
#include "coarse.h"
#include "solver.h"
#include "tent.h"

namespace lumel::baker {

class FineTile {
public:
    // Texels share the nodes of `cells`, if there are any that they can share.
    FineTile(Chain& chain, const CoarseCells* cells);
    // Texels [x0, x0 + size) x [y0, y0 + size) of a level, cut at its border.
    void run(int number, int x0, int y0, int size);
    // A chain whose texels nest: all fine levels under the texels [x0, x0 + size) x [y0, y0 + size) of
    // level `top`, which is the first of `cells`; each level filtered from the one below, up to the cells.
    void runNested(int top, int x0, int y0, int size, CoarseCells& cells);

private:
    void readLobes(int number, int x0, int y0, int x1, int y1);
    void span(int from, int to, int coarseSize, int size, int& begin, int& end) const;
    void gatherMembers(const Level& level, int x, int y);
    // The sums under a texel, from the finer cells of the block where those are on the shared nodes.
    void fill(int number, int x, int y, bool isCell, Cell& cell);
    void addTexel(int number, int x, int y, Cell& cell);
    void addChildren(int number, int x, int y, TexelTask& task);

    Chain& chain_;
    const Nodes* shared_;
    bool isBlack_;
    Solver solver_;
    Averager averager_;
    Lobes lobes_;
    int originX_ = 0, originY_ = 0, rectWidth_ = 0;
    std::vector<Member> members_;
    std::vector<TentShare> sharesX_, sharesY_;
    struct Block { // the cells of the texels from (x0, y0) on
        std::vector<Cell> cells;
        int x0 = 0, y0 = 0, width = 0;
    };
    Block finer_, current_;
    bool haveFiner_ = false;
    Cell single_;
};

} // namespace lumel::baker
