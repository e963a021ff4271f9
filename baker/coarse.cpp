#include "coarse.h"
#include "fine.h"
#include "footprint.h"
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace lumel::baker {

CoarseCells::CoarseCells(Chain& chain, int firstLevel) : chain_(chain)
{
    const int levels = int(chain.levels_.size());
    cutsX_ = borders(chain.source_.width(), firstLevel, levels);
    cutsY_ = borders(chain.source_.height(), firstLevel, levels);
    across_ = int(cutsX_.size()) - 1;
    down_ = int(cutsY_.size()) - 1;
    cells_.resize(size_t(across_) * size_t(down_));
    channels_ = chain.source_.colouredSpecular() ? 3 : 1;
    gatherMoments();
    averageCells();
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
                cell.lower = glm::min(cell.lower, l);
                cell.upper = glm::max(cell.upper, l);
            }
            cell.uniform = sameLobe(lobes, members, cell.shape);
        }
    });
}

void CoarseCells::averageCells()
{
    glm::vec2 lower(1e30f), upper(-1e30f);
    Moments all;
    for (const Cell& cell : cells_) {
        lower = glm::min(lower, cell.lower);
        upper = glm::max(upper, cell.upper);
        all.add(cell.sum);
    }
    Lattice::planShared(lower, upper, all.energyPower / all.energy, nodes_);
    const size_t stride = nodes_.size() * size_t(channels_);
    g_.resize(stride * cells_.size());
    // Where the whole map is black, its shape is fitted as if it were white.
    const bool black = luminance(all.ks) <= 0.0;
    tbb::parallel_for(tbb::blocked_range<int>(0, across_ * down_), [&](const auto& range) {
        Averager averager(chain_.source_.isotropic(), chain_.source_.colouredSpecular());
        Lobes lobes;
        std::vector<Member> members;
        for (int cell = range.begin(); cell < range.end(); ++cell) {
            gather(cell, lobes, members);
            averager.average(lobes, members, black, nodes_);
            for (int c = 0; c < channels_; ++c)
                std::copy_n(averager.g()[c], nodes_.size(),
                            g_.begin() + std::ptrdiff_t(size_t(cell) * stride + size_t(c) * nodes_.size()));
        }
    });
}

// Sums the cells under a texel and keeps the nodes where its average reflectance is not negligible.
void CoarseCells::addTexel(int number, int x, int y, Solver& solver) const
{
    const Level& level = chain_.levels_[size_t(number)];
    const Footprint fx(x, level.width, chain_.source_.width()), fy(y, level.height, chain_.source_.height());
    const auto cut = [](const std::vector<double>& cuts, double at) {
        return int(std::lower_bound(cuts.begin(), cuts.end(), at - 1e-6) - cuts.begin());
    };
    const int x0 = cut(cutsX_, fx.begin), x1 = cut(cutsX_, fx.end);
    const int y0 = cut(cutsY_, fy.begin), y1 = cut(cutsY_, fy.end);
    const size_t count = nodes_.size(), stride = count * size_t(channels_);
    Moments sum;
    std::vector<double> total(stride, 0.0);
    bool uniform = true;
    const Cell& front = cells_[size_t(y0) * size_t(across_) + size_t(x0)];
    for (int j = y0; j < y1; ++j)
        for (int i = x0; i < x1; ++i) {
            const size_t c = size_t(j) * size_t(across_) + size_t(i);
            sum.add(cells_[c].sum);
            for (size_t k = 0; k < stride; ++k)
                total[k] += g_[c * stride + k];
            const Shape &a = cells_[c].shape, &b = front.shape;
            uniform = uniform && cells_[c].uniform && a.nx == b.nx && a.ny == b.ny && a.sxx == b.sxx &&
                      a.sxy == b.sxy && a.syy == b.syy;
        }
    TexelTask task = chain_.makeTask(number, x, y, sum.mean());
    task.uniform = uniform && chain_.options_.method == Method::fit;
    if (task.uniform)
        task.shape = front.shape;
    double peak = 0.0;
    for (double v : total)
        peak = std::max(peak, v);
    NodeSet nodes;
    std::vector<float> g[3];
    for (size_t k = 0; k < count; ++k) {
        double here = 0.0;
        for (int c = 0; c < channels_; ++c)
            here = std::max(here, total[size_t(c) * count + k]);
        if (here < 1e-5 * peak)
            continue;
        nodes.add(nodes_.x[k], nodes_.y[k], nodes_.z[k], nodes_.area[k]);
        for (int c = 0; c < channels_; ++c)
            g[c].push_back(float(total[size_t(c) * count + k] / sum.weight));
    }
    nodes.pad();
    for (auto& channel : g)
        channel.resize(nodes.size(), 0.0f);
    const float* const pointers[3] = {g[0].data(), g[1].data(), g[2].data()};
    solver.add(task, nodes, pointers);
}

void CoarseCells::solveLevel(int number)
{
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
