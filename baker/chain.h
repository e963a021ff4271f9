// The chain of levels over one source.
#pragma once
#include "bake.h"
#include "closed_form.h"
#include "source.h"
#include <atomic>
#include <memory>

namespace lumel::baker {

class Chain {
public:
    Chain(const Maps& maps, const Options& options, Progress* progress);
    // Hands the levels to `sink` as they are finished, the finest first.
    void run(LevelSink& sink);

private:
    void writeBase(LevelSink& sink) const;
    void write(LevelSink& sink, int from, int to);
    void allocatePairs();
    void fitLevels(LevelSink* sink);
    // Second lobes wanted: all levels, then their labels, then the output.
    void finishPairs(LevelSink& sink);
    void allocate(std::vector<Level>& levels, int first) const;
    // Levels whose texels cover few lobes: one level after the other, or where texels nest and can share
    // nodes with the cells, all up to the cells at once.
    void fineLevel(int number);
    bool nests(class CoarseCells& cells) const;
    void nestedLevels(class CoarseCells& cells);
    // Reports progress by texels of a level; each level counts as many units as level 0 has texels.
    void advance(int number, size_t texels);
    struct TexelTask makeTask(int number, int x, int y, const struct Cell& cell);

    const Maps& maps_;
    const Options& options_;
    Progress* progress_;
    Source source_;
    bool fitsPairs_; // second lobes where they are worth it
    bool usesLists_; // fits to lists of lobes, not to sums at quadrature nodes
    std::unique_ptr<HeightMips> heights_;
    std::vector<Level> levels_;
    std::vector<Level> oneLobe_;            // fits of one anisotropic lobe, beside a chain of others
    std::vector<std::atomic<size_t>> done_; // texels of each level, for progress

    friend class FineTile;
    friend class CoarseCells;
};

} // namespace lumel::baker
