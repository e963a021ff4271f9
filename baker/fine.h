// A tile of a fine level: gathers the lobes under each texel and hands groups of texels to the solver.
#pragma once
#include "chain.h"
#include "group.h"

namespace lumel::baker {

class FineTile {
public:
    explicit FineTile(Chain& chain);
    // Texels [x0, x0 + size) x [y0, y0 + size) of the level, cut at its border.
    void run(int number, int x0, int y0, int size);

private:
    struct Texel {
        TexelTask task;
        std::vector<Member> members;
        std::vector<Node> nodes;
    };
    void readLobes(int number, int x0, int y0, int x1, int y1);
    void prepare(int number, int x, int y, Texel& texel);

    Chain& chain_;
    Group group_;
    Lobes lobes_;
    int originX_ = 0, originY_ = 0, rectWidth_ = 0;
    std::vector<Texel> texels_;
    std::vector<size_t> order_;
};

// True when all members are one and the same lobe; `shape` then is that lobe.
bool sameLobe(const Lobes& lobes, const std::vector<Member>& members, Shape& shape);

} // namespace lumel::baker
