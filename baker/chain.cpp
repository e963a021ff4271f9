#include "chain.h"
#include "coarse.h"
#include "core/error.h"
#include "fine.h"
#include "footprint.h"
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace lumel::baker {
namespace {
// Levels 1 and 2 average the few lobes under each texel at nodes of their own; from here on averages are
// summed from finer ones.
constexpr int kFirstCoarseLevel = 3;
} // namespace

Chain::Chain(const Maps& maps, const Options& options, Progress* progress)
    : maps_(maps), options_(options), progress_(progress), source_(maps)
{
    if (options.method == Method::height)
        heights_ = std::make_unique<HeightMips>(maps, source_.width(), source_.height());
}

// Levels below options_.reduce stay without texels: nothing is fitted there.
void Chain::allocate(std::vector<Level>& levels, int first) const
{
    const int count = levelCount(source_.width(), source_.height());
    for (int number = 0; number < count; ++number) {
        const int width = levelSize(source_.width(), number), height = levelSize(source_.height(), number);
        levels.push_back({width, height, {}});
        if (number >= first)
            levels.back().texels.resize(size_t(width) * size_t(height) * kChannels);
    }
}

std::vector<Level> Chain::run()
{
    const int count = levelCount(source_.width(), source_.height()), reduce = options_.reduce;
    if (reduce < 0 || reduce >= count)
        throw Error(fmt::format("reduce {}: a {} x {} map has {} levels; drop fewer", reduce, source_.width(),
                                source_.height(), count));
    allocate(levels_, std::max(1, reduce));
    if (reduce == 0)
        levels_[0] = baseLevel();
    if (options_.method == Method::fit && options_.model == Model::blinnPhong)
        allocate(shadows_, std::max(1, reduce));
    int number = std::max(1, reduce);
    std::unique_ptr<CoarseCells> cells;
    if (count > kFirstCoarseLevel)
        cells = std::make_unique<CoarseCells>(*this, std::max(kFirstCoarseLevel, reduce));
    for (; number < (cells ? cells->firstLevel() : count); ++number)
        fineLevel(number);
    if (cells)
        cells->averageCells();
    for (; number < count; ++number) {
        if (heights_)
            heights_->setLevel(levels_[size_t(number)].width, levels_[size_t(number)].height);
        cells->solveLevel(number);
    }
    levels_.erase(levels_.begin(), levels_.begin() + reduce);
    return std::move(levels_);
}

// Level 0 is the input's own lobes: nothing to fit, no error.
Level Chain::baseLevel() const
{
    Level level{source_.width(), source_.height(), {}};
    level.texels.resize(size_t(level.width) * size_t(level.height) * kChannels);
    tbb::parallel_for(tbb::blocked_range<int>(0, level.height, 8), [&](const auto& rows) {
        Lobes lobes;
        lobes.resize(size_t(level.width));
        for (int y = rows.begin(); y < rows.end(); ++y) {
            source_.read(y, 0, level.width, lobes, 0);
            float* t = level.texels.data() + size_t(y) * size_t(level.width) * kChannels;
            for (size_t x = 0; x < size_t(level.width); ++x, t += kChannels) {
                const float values[kChannels] = {lobes.nx[x],    lobes.ny[x],    lobes.sxx[x],
                                                 lobes.sxy[x],   lobes.syy[x],   lobes.ks[0][x],
                                                 lobes.ks[1][x], lobes.ks[2][x], lobes.kd[0][x],
                                                 lobes.kd[1][x], lobes.kd[2][x], 0.0f};
                // Kd of a level is the vector average of Kd N along N: at level 0 Kd itself.
                std::copy(values, values + kChannels, t);
            }
        }
    });
    return level;
}

void Chain::advance(size_t units) const
{
    if (progress_)
        progress_->advance(units);
}

TexelTask Chain::makeTask(int number, int x, int y, const Moments& mean)
{
    TexelTask task;
    task.mean = mean;
    Level& level = levels_[size_t(number)];
    task.texel = level.texels.data() + (size_t(y) * size_t(level.width) + size_t(x)) * kChannels;
    if (options_.method != Method::fit) {
        glm::vec3 normal(0.0f, 0.0f, 1.0f);
        if (heights_)
            normal = heights_->normal(x, y);
        task.shape = closedFormShape(options_.method, mean, normal);
        return task;
    }
    // The finer level's lobes under this texel; level 1 sits on the input itself. An isotropic chain
    // takes them from the anisotropic fits beside it, which say more about G and make both models
    // search from the same guesses.
    const bool shadowed = !shadows_.empty();
    if (shadowed)
        task.shadow = shadows_[size_t(number)].texels.data() +
                      (size_t(y) * size_t(level.width) + size_t(x)) * kChannels;
    const Level& finer = (shadowed && number > 1 ? shadows_ : levels_)[size_t(number - 1)];
    if (finer.texels.empty())
        return task;
    const Footprint fx(x, level.width, finer.width), fy(y, level.height, finer.height);
    const double area = (fx.end - fx.begin) * (fy.end - fy.begin);
    for (int j = fy.first; j < fy.last; ++j)
        for (int i = fx.first; i < fx.last; ++i) {
            const float* t = finer.at(i, j);
            const float ks = float(luminance({t[kKsR], t[kKsG], t[kKsB]}));
            task.children[size_t(task.childCount++)] = {
                {t[kNx], t[kNy], t[kSxx], t[kSxy], t[kSyy]}, ks, float(fx.weight(i) * fy.weight(j) / area)};
        }
    return task;
}

void Chain::fineLevel(int number)
{
    const Level& level = levels_[size_t(number)];
    if (heights_)
        heights_->setLevel(level.width, level.height);
    const int tile = std::max(1, 64 >> number);
    const int across = (level.width + tile - 1) / tile, down = (level.height + tile - 1) / tile;
    tbb::parallel_for(tbb::blocked_range<int>(0, across * down), [&](const auto& range) {
        FineTile worker(*this);
        for (int i = range.begin(); i < range.end(); ++i)
            worker.run(number, i % across * tile, i / across * tile, tile);
    });
}

} // namespace lumel::baker
