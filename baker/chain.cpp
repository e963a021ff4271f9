#include "chain.h"
#include "coarse.h"
#include "core/error.h"
#include "fine.h"
#include "footprint.h"
#include "lobe_order.h"
#include "profile.h"
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace lumel::baker {
namespace {
// Levels 1 and 2 average the few lobes under each texel at nodes of their own; coarser levels sum the
// averages of finer ones.
constexpr int kFirstCoarseLevel = 3;
constexpr int kBlock = 32; // level-0 texels that are worked on at once, on each axis

// Of a texel, or of its second lobe: both begin alike.
TexelTask::Child childOf(const float* t, float share)
{
    return {
        {t[kNx], t[kNy], t[kSxx], t[kSxy], t[kSyy]}, float(luminance({t[kKsR], t[kKsG], t[kKsB]})), share};
}

bool hasSecondLobe(const Level& level)
{
    for (size_t i = 0; i < level.second.size(); i += kSecondChannels)
        if (level.second[i + kKs2R] + level.second[i + kKs2G] + level.second[i + kKs2B] > 0.0f)
            return true;
    return false;
}

} // namespace

Chain::Chain(const Maps& maps, const Options& options, Progress* progress)
    : maps_(maps), options_(options), progress_(progress), source_(maps),
      fitsPairs_(options.method == Method::fit && options.lobes != LobeCount::one),
      usesLists_(isFitted(options.method) && options.precision > 0.0f && !source_.constantPower())
{
    // For that method, and as a guess that no fit may lose to.
    if (options.method == Method::height || (options.method == Method::fit && !maps.height.empty()))
        heights_ = std::make_unique<HeightMips>(maps, source_.width(), source_.height());
}

// Levels below options_.reduce stay without texels: nothing is fitted there.
void Chain::allocate(std::vector<Level>& levels, int first) const
{
    const int count = levelCount(source_.width(), source_.height());
    for (int number = 0; number < count; ++number) {
        const int width = levelSize(source_.width(), number), height = levelSize(source_.height(), number);
        levels.push_back({width, height, {}, {}});
        if (number >= first)
            levels.back().texels.resize(size_t(width) * size_t(height) * kChannels);
    }
}

void Chain::run(LevelSink& sink)
{
    const int count = levelCount(source_.width(), source_.height()), reduce = options_.reduce;
    if (reduce < 0 || reduce >= count)
        throw Error(fmt::format("reduce {}: a {} x {} map has {} levels; drop fewer", reduce, source_.width(),
                                source_.height(), count));
    const int first = std::max(1, reduce);
    done_ = std::vector<std::atomic<size_t>>(size_t(count));
    for (int number = 1; number < first; ++number) // dropped
        advance(number,
                size_t(levelSize(source_.width(), number)) * size_t(levelSize(source_.height(), number)));
    allocate(levels_, first);
    if (fitsPairs_ || (isFitted(options_.method) && options_.model == Model::blinnPhong))
        allocate(oneLobe_, first);
    if (fitsPairs_) {
        allocatePairs();
        fitLevels(nullptr);
        finishPairs(sink);
        return;
    }
    sink.begin(false);
    if (reduce == 0)
        writeBase(sink);
    fitLevels(&sink);
}

// Each level goes to the sink, if there is one, as soon as it is finished.
void Chain::fitLevels(LevelSink* sink)
{
    const int count = int(levels_.size()), reduce = options_.reduce, first = std::max(1, reduce);
    std::unique_ptr<CoarseCells> cells;
    if (count > kFirstCoarseLevel)
        cells = std::make_unique<CoarseCells>(*this, std::max(kFirstCoarseLevel, reduce));
    const int coarse = cells ? cells->firstLevel() : count;
    if (cells && nests(*cells)) {
        nestedLevels(*cells);
    } else {
        for (int number = first; number < coarse; ++number)
            fineLevel(number);
        if (cells)
            cells->gatherCells();
    }
    if (sink)
        write(*sink, first, coarse);
    for (int number = coarse; number < count; ++number) {
        cells->solveLevel(number);
        if (sink)
            write(*sink, number, number + 1);
    }
}

// The finest level of the output has one lobe.
void Chain::allocatePairs()
{
    for (size_t number = size_t(options_.reduce) + 1; number < levels_.size(); ++number) {
        Level& level = levels_[number];
        const size_t count = size_t(level.width) * size_t(level.height);
        level.second.reserve(count * kSecondChannels);
        for (size_t i = 0; i < count; ++i)
            level.second.insert(level.second.end(), kNoSecondLobe, kNoSecondLobe + kSecondChannels);
    }
}

// Only now is it known whether the output has second lobes.
void Chain::finishPairs(LevelSink& sink)
{
    oneLobe_.clear();
    const bool any = std::ranges::any_of(levels_, hasSecondLobe);
    if (any)
        orderLobes(levels_, maps_.wrap, options_.profile);
    else
        for (Level& level : levels_)
            level.second = {};
    sink.begin(any);
    if (options_.reduce == 0)
        writeBase(sink);
    write(sink, std::max(1, options_.reduce), int(levels_.size()));
}

// Hands over the levels from `from` up to `to`; the last of them stays, for the next to start from.
void Chain::write(LevelSink& sink, int from, int to)
{
    const StepTimer timer(options_.profile, Step::output);
    for (int number = from; number < to; ++number) {
        const Level& level = levels_[size_t(number)];
        sink.rows(number - options_.reduce, level.width, level.height, 0, level.height, level.texels.data(),
                  level.second.empty() ? nullptr : level.second.data());
        for (auto* levels : {&levels_, &oneLobe_})
            if (number > 0 && !levels->empty())
                (*levels)[size_t(number - 1)].texels = (*levels)[size_t(number - 1)].second = {};
    }
}

// Level 0 is the input's own lobes: nothing to fit, no error. A band at a time: it is never needed whole.
void Chain::writeBase(LevelSink& sink) const
{
    const size_t width = size_t(source_.width());
    std::vector<float> band;
    for (int from = 0; from < source_.height(); from += LevelSink::kBand) {
        const int to = std::min(from + LevelSink::kBand, source_.height());
        band.resize(width * size_t(to - from) * kChannels);
        tbb::parallel_for(tbb::blocked_range<int>(from, to, 8), [&](const auto& rows) {
            const StepTimer timer(options_.profile, Step::output);
            Lobes lobes;
            lobes.resize(width);
            for (int y = rows.begin(); y < rows.end(); ++y) {
                source_.read(y, 0, int(width), lobes, 0);
                float* t = band.data() + size_t(y - from) * width * kChannels;
                for (size_t x = 0; x < width; ++x, t += kChannels) {
                    const float values[kChannels] = {lobes.nx[x],    lobes.ny[x],    lobes.sxx[x],
                                                     lobes.sxy[x],   lobes.syy[x],   lobes.ks[0][x],
                                                     lobes.ks[1][x], lobes.ks[2][x], lobes.kd[0][x],
                                                     lobes.kd[1][x], lobes.kd[2][x], 0.0f};
                    std::copy(values, values + kChannels, t);
                }
            }
        });
        if (progress_)
            progress_->advance(0); // Ctrl-C
        const StepTimer timer(options_.profile, Step::output);
        sink.rows(0, source_.width(), source_.height(), from, to - from, band.data(), nullptr);
    }
}

void Chain::advance(int number, size_t texels)
{
    if (!progress_)
        return;
    const size_t whole = size_t(source_.width()) * size_t(source_.height());
    const size_t count =
        size_t(levelSize(source_.width(), number)) * size_t(levelSize(source_.height(), number));
    const size_t before = done_[size_t(number)].fetch_add(texels);
    progress_->advance(whole * (before + texels) / count - whole * before / count);
}

TexelTask Chain::makeTask(int number, int x, int y, const Cell& cell)
{
    TexelTask task;
    task.mean = cell.sum.mean();
    Level& level = levels_[size_t(number)];
    const size_t offset = (size_t(y) * size_t(level.width) + size_t(x)) * kChannels;
    task.texel = level.texels.data() + offset;
    if (!level.second.empty())
        task.second = level.second.data() + offset / kChannels * kSecondChannels;
    const bool both = !oneLobe_.empty();
    if (both)
        task.oneLobe = oneLobe_[size_t(number)].texels.data() + offset;
    task.uniform = cell.uniform && isFitted(options_.method);
    task.fixed = task.uniform || !isFitted(options_.method);
    task.heights = heights_.get();
    task.level = number;
    task.x = x;
    task.y = y;
    if (task.fixed) {
        const glm::vec3 normal = options_.method == Method::height && !task.uniform
                                     ? heights_->normal(number, x, y)
                                     : glm::vec3(0.0f, 0.0f, 1.0f);
        task.shape = task.uniform ? cell.shape : closedFormShape(options_.method, task.mean, normal);
        return task;
    }
    // The finer level's lobes under this texel. An isotropic chain takes them from the anisotropic fits
    // beside it, which say more about G and make both models search from the same guesses; so does a chain
    // with second lobes, whose single lobes then are those of a chain without.
    const Level& finer = (both ? oneLobe_ : levels_)[size_t(number - 1)];
    if (finer.texels.empty())
        return task;
    const Level& pairs = levels_[size_t(number - 1)];
    const Footprint fx(x, level.width, finer.width), fy(y, level.height, finer.height);
    const double area = (fx.end - fx.begin) * (fy.end - fy.begin);
    for (int j = fy.first; j < fy.last; ++j)
        for (int i = fx.first; i < fx.last; ++i) {
            const float share = float(fx.weight(i) * fy.weight(j) / area);
            task.children[size_t(task.childCount++)] = childOf(finer.at(i, j), share);
            if (pairs.second.empty())
                continue;
            task.finerLobes[size_t(task.finerCount++)] = childOf(pairs.at(i, j), share);
            const TexelTask::Child second = childOf(pairs.secondAt(i, j), share);
            if (second.ks > 0.0f)
                task.finerLobes[size_t(task.finerCount++)] = second;
        }
    return task;
}

void Chain::fineLevel(int number)
{
    const Level& level = levels_[size_t(number)];
    const int tile = std::max(1, kBlock >> number);
    const int across = (level.width + tile - 1) / tile, down = (level.height + tile - 1) / tile;
    tbb::parallel_for(tbb::blocked_range<int>(0, across * down), [&](const auto& range) {
        FineTile worker(*this, nullptr);
        for (int i = range.begin(); i < range.end(); ++i)
            worker.run(number, i % across * tile, i / across * tile, tile);
    });
}

// Does every texel up to the cells cover four of the finer level, on nodes that all can share?
bool Chain::nests(CoarseCells& cells) const
{
    const int texels = 1 << cells.firstLevel();
    return (usesLists_ || cells.sharedNodes()) && options_.reconstruction == Reconstruction::box &&
           source_.width() % texels == 0 && source_.height() % texels == 0;
}

void Chain::nestedLevels(CoarseCells& cells)
{
    const int top = cells.firstLevel(), tile = std::max(1, kBlock >> top);
    const Level& level = levels_[size_t(top)];
    const int across = (level.width + tile - 1) / tile, down = (level.height + tile - 1) / tile;
    tbb::parallel_for(tbb::blocked_range<int>(0, across * down), [&](const auto& range) {
        FineTile worker(*this, &cells);
        for (int i = range.begin(); i < range.end(); ++i)
            worker.runNested(top, i % across * tile, i / across * tile, tile, cells);
    });
}

} // namespace lumel::baker
