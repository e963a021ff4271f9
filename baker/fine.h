// A tile of a fine level: gathers the lobes under each texel and hands the texels to the solver.
#pragma once
#include "averager.h"
#include "chain.h"
#include "solver.h"
#include "tent.h"

namespace lumel::baker {

class FineTile {
public:
    explicit FineTile(Chain& chain);
    // Texels [x0, x0 + size) x [y0, y0 + size) of the level, cut at its border.
    void run(int number, int x0, int y0, int size);

private:
    void readLobes(int number, int x0, int y0, int x1, int y1);
    void addTexel(int number, int x, int y);
    void span(int from, int to, int coarseSize, int size, int& begin, int& end) const;
    void gather(const Level& level, int x, int y);
    void addQuadrants(TexelTask& task) const;

    Chain& chain_;
    Solver solver_;
    Averager averager_;
    Lattice lattice_;
    Lobes lobes_;
    int originX_ = 0, originY_ = 0, rectWidth_ = 0;
    std::vector<Member> members_;
    std::vector<TentShare> sharesX_, sharesY_;
    NodeSet nodes_;
};

// True when all members are one and the same lobe; `shape` then is that lobe.
bool sameLobe(const Lobes& lobes, const std::vector<Member>& members, Shape& shape);

} // namespace lumel::baker
