#include "coarse.h"
#include "footprint.h"
#include "normals.h"
#include "profile.h"
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace lumel::baker {

namespace {

constexpr size_t kMostCells = 65536;
constexpr size_t kMostBytes = size_t(256) << 20;

// Index of the border at `at` among ascending borders.
int borderIndex(const std::vector<double>& cuts, double at)
{
    return int(std::lower_bound(cuts.begin(), cuts.end(), at - 1e-6) - cuts.begin());
}

} // namespace

CoarseCells::CoarseCells(Chain& chain, int firstLevel)
    : chain_(chain), firstLevel_(firstLevel), channels_(chain.source_.colouredSpecular() ? 3 : 1)
{
    const int levels = int(chain.levels_.size());
    if (!chain_.usesLists_)
        survey();
    const size_t cellBytes = chain_.usesLists_ ? LobeList::kMost * sizeof(ListedLobe)
                                               : mostNodes_ * size_t(channels_) * sizeof(float);
    const auto tooMany = [&] {
        cutsX_ = borders(chain.source_.width(), cellLevel(firstLevel_), levels);
        cutsY_ = borders(chain.source_.height(), cellLevel(firstLevel_), levels);
        const size_t cells = (cutsX_.size() - 1) * (cutsY_.size() - 1);
        return cells > kMostCells || cells * cellBytes > kMostBytes;
    };
    while (tooMany() && firstLevel_ < levels - 1)
        ++firstLevel_;
    across_ = int(cutsX_.size()) - 1;
    down_ = int(cutsY_.size()) - 1;
    cells_.resize(size_t(across_) * size_t(down_));
}

std::vector<double> CoarseCells::borders(int size, int firstLevel, int levels)
{
    std::vector<double> cuts;
    for (int number = firstLevel; number < levels; ++number) {
        const int count = levelSize(size, number);
        for (int x = 0; x <= count; ++x)
            cuts.push_back(x < count ? Footprint(x, count, size).begin : double(size));
    }
    std::sort(cuts.begin(), cuts.end());
    cuts.erase(std::unique(cuts.begin(), cuts.end(), [](double a, double b) { return b - a < 1e-7; }),
               cuts.end());
    return cuts;
}

// The lobes of a cell.
void CoarseCells::gather(int cell, Lobes& lobes, std::vector<Member>& members) const
{
    const Footprint fx(cutsX_[size_t(cell % across_)], cutsX_[size_t(cell % across_) + 1]);
    const Footprint fy(cutsY_[size_t(cell / across_)], cutsY_[size_t(cell / across_) + 1]);
    const StepTimer timer(chain_.options_.profile, Step::input);
    const int width = fx.last - fx.first;
    lobes.resize(size_t(width) * size_t(fy.last - fy.first));
    members.clear();
    for (int j = fy.first; j < fy.last; ++j) {
        const size_t row = size_t(j - fy.first) * size_t(width);
        chain_.source_.read(j, fx.first, fx.last, lobes, row);
        for (int i = fx.first; i < fx.last; ++i)
            members.push_back({uint32_t(row + size_t(i - fx.first)), fx.weight(i) * fy.weight(j)});
    }
}

// Where on the disc lobes are, and how narrow.
void CoarseCells::survey()
{
    struct Part {
        glm::vec2 lower{1e30f}, upper{-1e30f}; // in Lambert's map, with the lobes' supports
        double energy = 0.0, energyNarrow = 0.0, ks = 0.0;
    };
    const Source& source = chain_.source_;
    std::vector<Part> parts(size_t(source.height())); // one per row: the same sums on any number of threads
    tbb::parallel_for(tbb::blocked_range<int>(0, source.height()), [&](const auto& rows) {
        const StepTimer timer(chain_.options_.profile, Step::input);
        Lobes lobes;
        lobes.resize(size_t(source.width()));
        for (int y = rows.begin(); y < rows.end(); ++y) {
            Part& part = parts[size_t(y)];
            source.read(y, 0, source.width(), lobes, 0);
            float det = 0.0f, lowest = 0.0f, energy = 0.0f;
            double narrow = 0.0;
            for (size_t m = 0; m < lobes.size(); ++m) {
                const glm::vec2 l = lambert(lobes.nx[m], lobes.ny[m], lobes.nz[m]);
                if (m == 0 || lobes.covariance(m) != lobes.covariance(m - 1)) {
                    det = lobes.sxx[m] * lobes.syy[m] - lobes.sxy[m] * lobes.sxy[m];
                    lowest = lowestPower(lobes, m);
                    energy = 1.0f / std::sqrt(det);
                    narrow = double(energy) / (double(det) * double(lowest));
                }
                const float radius = supportRadius(lobes.nz[m], lowest);
                part.lower = glm::min(part.lower, l - radius);
                part.upper = glm::max(part.upper, l + radius);
                part.energy += double(energy);
                part.energyNarrow += narrow;
                part.ks += double(lobes.ks[0][m]) + double(lobes.ks[1][m]) + double(lobes.ks[2][m]);
            }
        }
    });
    Part all;
    for (const Part& part : parts) {
        all.lower = glm::min(all.lower, part.lower);
        all.upper = glm::max(all.upper, part.upper);
        all.energy += part.energy;
        all.energyNarrow += part.energyNarrow;
        all.ks += part.ks;
    }
    isBlack_ = all.ks <= 0.0;
    const double power = all.energyNarrow / all.energy;
    if (power <= kDiscRulePower) {
        nodes_.rule = &discRule(power);
        mostNodes_ = nodes_.rule->size();
        return;
    }
    constexpr double kMostNodes = 8192;
    const glm::dvec2 size =
        glm::min(glm::dvec2(all.upper), std::sqrt(2.0)) - glm::max(glm::dvec2(all.lower), -std::sqrt(2.0));
    const double ideal = kSpacing / std::sqrt(power);
    const double spacing = std::max(ideal, std::sqrt(size.x * size.y / kMostNodes));
    nodes_.spacing = float(spacing);
    mostNodes_ = size_t(size.x * size.y / (spacing * spacing)) + 1;
    canShare_ = source.constantPower() && spacing == ideal;
}

void CoarseCells::gatherCells()
{
    tbb::parallel_for(tbb::blocked_range<int>(0, across_ * down_), [&](const auto& range) {
        const StepTimer timer(chain_.options_.profile, Step::sums);
        Averager averager(chain_.source_);
        Lobes lobes;
        std::vector<Member> members;
        for (int cell = range.begin(); cell < range.end(); ++cell) {
            gather(cell, lobes, members);
            if (chain_.usesLists_)
                Averager::list(lobes, members, cells_[size_t(cell)]);
            else
                averager.gather(lobes, members, &nodes_, isBlack_, cells_[size_t(cell)]);
        }
    });
}

void CoarseCells::coarsen(int level)
{
    const int levels = int(chain_.levels_.size());
    std::vector<double> newX = borders(chain_.source_.width(), level, levels);
    std::vector<double> newY = borders(chain_.source_.height(), level, levels);
    const int newAcross = int(newX.size()) - 1, newDown = int(newY.size()) - 1;
    std::vector<Cell> merged(size_t(newAcross) * size_t(newDown));
    tbb::parallel_for(tbb::blocked_range<int>(0, newDown), [&](const auto& rows) {
        const StepTimer timer(chain_.options_.profile, Step::sums);
        for (int j = rows.begin(); j < rows.end(); ++j)
            for (int i = 0; i < newAcross; ++i) {
                Cell& cell = merged[size_t(j) * size_t(newAcross) + size_t(i)];
                const int y1 = borderIndex(cutsY_, newY[size_t(j) + 1]),
                          x1 = borderIndex(cutsX_, newX[size_t(i) + 1]);
                for (int y = borderIndex(cutsY_, newY[size_t(j)]); y < y1; ++y)
                    for (int x = borderIndex(cutsX_, newX[size_t(i)]); x < x1; ++x)
                        cell.merge(cells_[size_t(y) * size_t(across_) + size_t(x)], 1.0, channels_);
                cell.shortenList();
            }
    });
    cells_ = std::move(merged);
    cutsX_ = std::move(newX);
    cutsY_ = std::move(newY);
    across_ = newAcross;
    down_ = newDown;
}

// The cells of one axis under texel t of a level, with their shares of it.
std::vector<TentShare> CoarseCells::shares(int t, int levelTexels, int size,
                                           const std::vector<double>& cuts) const
{
    std::vector<TentShare> result;
    const int count = int(cuts.size()) - 1;
    if (chain_.options_.reconstruction == Reconstruction::bilinear) {
        tentShares(
            t, levelTexels, size, chain_.maps_.wrap, count, [&](int i) { return cuts[size_t(i)]; },
            [&](double at) {
                return int(std::upper_bound(cuts.begin(), cuts.end(), at + 1e-6) - cuts.begin()) - 1;
            },
            result);
        for (TentShare& share : result)
            share.cell = wrapped(share.cell, count, Wrap::repeat);
        return result;
    }
    const Footprint f(t, levelTexels, size);
    for (int i = borderIndex(cuts, f.begin); i < borderIndex(cuts, f.end); ++i)
        result.push_back({i, float((cuts[size_t(i) + 1] - cuts[size_t(i)]) / (f.end - f.begin))});
    return result;
}

// The cells under a texel.
void CoarseCells::addTexel(int number, int x, int y, Solver& solver) const
{
    const Level& level = chain_.levels_[size_t(number)];
    Cell cell;
    const auto sharesX = shares(x, level.width, chain_.source_.width(), cutsX_);
    for (const TentShare& sy : shares(y, level.height, chain_.source_.height(), cutsY_))
        for (const TentShare& sx : sharesX) {
            const Cell& part = cells_[size_t(sy.cell) * size_t(across_) + size_t(sx.cell)];
            cell.merge(part, double(sx.share) * sy.share / part.sum.weight, channels_);
        }
    cell.shortenList();
    TexelTask task = chain_.makeTask(number, x, y, cell);
    if (task.childCount == 0)
        task.addChild(task.mean, 1.0);
    solver.add(task, cell);
}

void CoarseCells::solveLevel(int number)
{
    coarsen(cellLevel(number));
    const Level& level = chain_.levels_[size_t(number)];
    const int total = level.width * level.height;
    constexpr int kBatch = 64;
    tbb::parallel_for(tbb::blocked_range<int>(0, (total + kBatch - 1) / kBatch), [&](const auto& range) {
        const StepTimer timer(chain_.options_.profile, Step::sums);
        Solver solver(chain_.options_, chain_.source_);
        for (int batch = range.begin(); batch < range.end(); ++batch) {
            const int end = std::min((batch + 1) * kBatch, total);
            for (int t = batch * kBatch; t < end; ++t)
                addTexel(number, t % level.width, t / level.width, solver);
            solver.solve();
            chain_.advance(number, size_t(end - batch * kBatch));
        }
    });
}

} // namespace lumel::baker
