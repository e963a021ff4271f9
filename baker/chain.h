// The chain of levels over one source.
#pragma once
#include "bake.h"
#include "closed_form.h"
#include "source.h"
#include <memory>

namespace lumel::baker {

class Chain {
public:
    Chain(const Maps& maps, const Options& options, Progress* progress);
    std::vector<Level> run();

private:
    Level baseLevel() const;
    void allocate(std::vector<Level>& levels, int first) const;
    // Levels whose texels cover few lobes: nodes of their own for each texel.
    void fineLevel(int number);
    void advance(size_t units) const;
    struct TexelTask makeTask(int number, int x, int y, const struct Moments& mean);

    const Maps& maps_;
    const Options& options_;
    Progress* progress_;
    Source source_;
    std::unique_ptr<HeightMips> heights_;
    std::vector<Level> levels_;
    std::vector<Level> shadows_; // anisotropic fits beside an isotropic chain

    friend class FineTile;
    friend class CoarseCells;
};

} // namespace lumel::baker
