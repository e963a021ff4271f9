#include "coarse.h"
#include "fine.h"
#include "footprint.h"
#include "normals.h"
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace lumel::baker {

namespace {

constexpr size_t kMostCells = 65536;
constexpr size_t kMostBytes = size_t(256) << 20;
constexpr size_t kMostSharedNodes = 8192;

// Index of the border at `at` among ascending borders.
int borderIndex(const std::vector<double>& cuts, double at)
{
    return int(std::lower_bound(cuts.begin(), cuts.end(), at - 1e-6) - cuts.begin());
}

} // namespace

CoarseCells::CoarseCells(Chain& chain, int firstLevel) : chain_(chain), firstLevel_(firstLevel)
{
    const int levels = int(chain.levels_.size());
    channels_ = chain.source_.colouredSpecular() ? 3 : 1;
    const auto plan = [&] {
        cutsX_ = borders(chain.source_.width(), cellLevel(firstLevel_), levels);
        cutsY_ = borders(chain.source_.height(), cellLevel(firstLevel_), levels);
        return (cutsX_.size() - 1) * (cutsY_.size() - 1);
    };
    while (plan() > kMostCells && firstLevel_ < levels - 1)
        ++firstLevel_;
    across_ = int(cutsX_.size()) - 1;
    down_ = int(cutsY_.size()) - 1;
    cells_.resize(size_t(across_) * size_t(down_));
    gatherMoments();
    planNodes();
    const auto bytes = [&] {
        return cells_.size() * lattice_.nodes().size() * size_t(channels_) * sizeof(float);
    };
    while (bytes() > kMostBytes && firstLevel_ < levels - 1)
        coarsen(cellLevel(++firstLevel_));
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

// The lobes of a cell; shares are areas in level-0 texels.
void CoarseCells::gather(int cell, Lobes& lobes, std::vector<Member>& members) const
{
    const Footprint fx(cutsX_[size_t(cell % across_)], cutsX_[size_t(cell % across_) + 1]);
    const Footprint fy(cutsY_[size_t(cell / across_)], cutsY_[size_t(cell / across_) + 1]);
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

void CoarseCells::gatherMoments()
{
    tbb::parallel_for(tbb::blocked_range<int>(0, across_ * down_), [&](const auto& range) {
        Lobes lobes;
        std::vector<Member> members;
        for (int c = range.begin(); c < range.end(); ++c) {
            Cell& cell = cells_[size_t(c)];
            gather(c, lobes, members);
            for (const Member& m : members) {
                cell.sum.add(lobes, m.lobe, m.share);
                const glm::vec2 l = lambert(lobes.nx[m.lobe], lobes.ny[m.lobe], lobes.nz[m.lobe]);
                const float radius = supportRadius(lowestPower(lobes, m.lobe));
                cell.lower = glm::min(cell.lower, l - radius);
                cell.upper = glm::max(cell.upper, l + radius);
            }
            cell.uniform = sameLobe(lobes, members, cell.shape);
        }
    });
}

void CoarseCells::planNodes()
{
    glm::vec2 lower(1e30f), upper(-1e30f);
    Moments all;
    for (const Cell& cell : cells_) {
        lower = glm::min(lower, cell.lower);
        upper = glm::max(upper, cell.upper);
        all.add(cell.sum);
    }
    black_ = luminance(all.ks) <= 0.0;
    lattice_.plan(lower, upper, all.energyNarrow / all.energy, kMostSharedNodes);
}

void CoarseCells::averageCells()
{
    const size_t stride = lattice_.nodes().size() * size_t(channels_);
    g_.assign(stride * cells_.size(), 0.0f);
    tbb::parallel_for(tbb::blocked_range<int>(0, across_ * down_), [&](const auto& range) {
        Averager averager(chain_.source_.isotropic(), chain_.source_.colouredSpecular());
        Lobes lobes;
        std::vector<Member> members;
        for (int cell = range.begin(); cell < range.end(); ++cell) {
            gather(cell, lobes, members);
            averager.scatter(lobes, members, black_, lattice_, g_.data() + size_t(cell) * stride);
        }
    });
}

void CoarseCells::coarsen(int level)
{
    const int levels = int(chain_.levels_.size());
    std::vector<double> newX = borders(chain_.source_.width(), level, levels);
    std::vector<double> newY = borders(chain_.source_.height(), level, levels);
    const int newAcross = int(newX.size()) - 1, newDown = int(newY.size()) - 1;
    const size_t stride = cells_.empty() ? 0 : g_.size() / cells_.size();
    std::vector<Cell> merged(size_t(newAcross) * size_t(newDown));
    std::vector<float> g(stride * merged.size(), 0.0f);
    tbb::parallel_for(tbb::blocked_range<int>(0, newDown), [&](const auto& rows) {
        for (int j = rows.begin(); j < rows.end(); ++j)
            for (int i = 0; i < newAcross; ++i) {
                const size_t to = size_t(j) * size_t(newAcross) + size_t(i);
                Cell& cell = merged[to];
                const int y1 = borderIndex(cutsY_, newY[size_t(j) + 1]),
                          x1 = borderIndex(cutsX_, newX[size_t(i) + 1]);
                for (int y = borderIndex(cutsY_, newY[size_t(j)]); y < y1; ++y)
                    for (int x = borderIndex(cutsX_, newX[size_t(i)]); x < x1; ++x) {
                        const size_t from = size_t(y) * size_t(across_) + size_t(x);
                        cell.merge(cells_[from]);
                        for (size_t k = 0; k < stride; ++k)
                            g[to * stride + k] += g_[from * stride + k];
                    }
            }
    });
    cells_ = std::move(merged);
    g_ = std::move(g);
    cutsX_ = std::move(newX);
    cutsY_ = std::move(newY);
    across_ = newAcross;
    down_ = newDown;
}

void CoarseCells::Cell::merge(const Cell& other, double factor)
{
    const Shape &a = shape, &b = other.shape;
    const bool same = a.nx == b.nx && a.ny == b.ny && a.sxx == b.sxx && a.sxy == b.sxy && a.syy == b.syy;
    uniform = other.uniform && (sum.weight == 0.0 || (uniform && same));
    shape = other.shape;
    sum.add(other.sum, factor);
    lower = glm::min(lower, other.lower);
    upper = glm::max(upper, other.upper);
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

// Sums the cells under a texel and keeps the nodes where its average reflectance is not negligible.
void CoarseCells::addTexel(int number, int x, int y, Solver& solver) const
{
    const Level& level = chain_.levels_[size_t(number)];
    const NodeSet& shared = lattice_.nodes();
    const size_t count = shared.size(), stride = count * size_t(channels_);
    Cell cell;
    std::vector<float> total(stride, 0.0f);
    for (const TentShare& sy : shares(y, level.height, chain_.source_.height(), cutsY_))
        for (const TentShare& sx : shares(x, level.width, chain_.source_.width(), cutsX_)) {
            const size_t c = size_t(sy.cell) * size_t(across_) + size_t(sx.cell);
            const double factor = double(sx.share) * sy.share / cells_[c].sum.weight;
            cell.merge(cells_[c], factor);
            for (size_t k = 0; k < stride; ++k)
                total[k] += float(factor) * g_[c * stride + k];
        }
    TexelTask task = chain_.makeTask(number, x, y, cell.sum.mean());
    if (task.childCount == 0)
        task.addChild(task.mean, 1.0);
    task.uniform = cell.uniform && chain_.options_.method == Method::fit;
    if (task.uniform)
        task.shape = cell.shape;
    double peak = 0.0;
    for (const float v : total)
        peak = std::max(peak, double(v));
    NodeSet nodes;
    std::vector<float> g[3];
    for (size_t k = 0; k < count; ++k) {
        double here = 0.0;
        for (int c = 0; c < channels_; ++c)
            here = std::max(here, double(total[size_t(c) * count + k]));
        if (here <= 1e-5 * peak)
            continue;
        nodes.add(shared.x[k], shared.y[k], shared.z[k], shared.area[k]);
        for (int c = 0; c < channels_; ++c)
            g[c].push_back(total[size_t(c) * count + k]);
    }
    nodes.pad();
    for (auto& channel : g)
        channel.resize(nodes.size(), 0.0f);
    const float* const pointers[3] = {g[0].data(), g[1].data(), g[2].data()};
    solver.add(task, nodes, pointers);
}

void CoarseCells::solveLevel(int number)
{
    coarsen(cellLevel(number));
    const Level& level = chain_.levels_[size_t(number)];
    const int total = level.width * level.height;
    constexpr int kBatch = 64;
    tbb::parallel_for(tbb::blocked_range<int>(0, (total + kBatch - 1) / kBatch), [&](const auto& range) {
        Solver solver(chain_.options_, chain_.source_.colouredSpecular());
        for (int batch = range.begin(); batch < range.end(); ++batch) {
            const int end = std::min((batch + 1) * kBatch, total);
            for (int t = batch * kBatch; t < end; ++t)
                addTexel(number, t % level.width, t / level.width, solver);
            solver.solve();
            chain_.advance(size_t(end - batch * kBatch) << (2 * number));
        }
    });
}

} // namespace lumel::baker
