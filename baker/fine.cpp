#include "fine.h"
#include "footprint.h"
#include "normals.h"

namespace lumel::baker {

bool sameLobe(const Lobes& lobes, const std::vector<Member>& members, Shape& shape)
{
    const size_t f = members.front().lobe;
    for (const Member& member : members) {
        const size_t m = member.lobe;
        if (lobes.nx[m] != lobes.nx[f] || lobes.ny[m] != lobes.ny[f] || lobes.sxx[m] != lobes.sxx[f] ||
            lobes.sxy[m] != lobes.sxy[f] || lobes.syy[m] != lobes.syy[f])
            return false;
    }
    shape = {lobes.nx[f], lobes.ny[f], lobes.sxx[f], lobes.sxy[f], lobes.syy[f]};
    return true;
}

FineTile::FineTile(Chain& chain)
    : chain_(chain), solver_(chain.options_, chain.source_.colouredSpecular()),
      averager_(chain.source_.isotropic(), chain.source_.colouredSpecular())
{
}

// Level-0 texels from `begin` to `end` on an axis, under texels [from, to) of `coarseSize`.
void FineTile::span(int from, int to, int coarseSize, int size, int& begin, int& end) const
{
    begin = Footprint(from, coarseSize, size).first;
    end = Footprint(to - 1, coarseSize, size).last;
    if (chain_.options_.reconstruction == Reconstruction::bilinear) {
        const int reach = (size + 2 * coarseSize - 1) / (2 * coarseSize) + 1; // half a texel
        begin -= reach;
        end += reach;
        if (chain_.maps_.wrap == Wrap::clamp) {
            begin = std::max(begin, 0);
            end = std::min(end, size);
        }
    }
}

void FineTile::readLobes(int number, int x0, int y0, int x1, int y1)
{
    const Level& level = chain_.levels_[size_t(number)];
    const Source& source = chain_.source_;
    int endX = 0, endY = 0;
    span(x0, x1, level.width, source.width(), originX_, endX);
    span(y0, y1, level.height, source.height(), originY_, endY);
    rectWidth_ = endX - originX_;
    lobes_.resize(size_t(rectWidth_) * size_t(endY - originY_));
    for (int y = originY_; y < endY; ++y) {
        const int row = wrapped(y, source.height(), Wrap::repeat);
        for (int x = originX_; x < endX;) { // runs up to the border of the map
            const int column = wrapped(x, source.width(), Wrap::repeat);
            const int run = std::min(endX - x, source.width() - column);
            source.read(row, column, column + run, lobes_,
                        size_t(y - originY_) * size_t(rectWidth_) + size_t(x - originX_));
            x += run;
        }
    }
}

// The lobes under a texel with their shares.
void FineTile::gather(const Level& level, int x, int y)
{
    const int width = chain_.source_.width(), height = chain_.source_.height();
    members_.clear();
    const auto add = [&](int i, int j, double share) {
        const size_t lobe = size_t(j - originY_) * size_t(rectWidth_) + size_t(i - originX_);
        members_.push_back({uint32_t(lobe), float(share)});
    };
    if (chain_.options_.reconstruction == Reconstruction::bilinear) {
        const auto shares = [&](int t, int coarseSize, int size, std::vector<TentShare>& out) {
            tentShares(
                t, coarseSize, size, chain_.maps_.wrap, size, [](int i) { return double(i); },
                [](double at) { return int(std::floor(at + 1e-7)); }, out);
        };
        shares(x, level.width, width, sharesX_);
        shares(y, level.height, height, sharesY_);
        for (const TentShare& sy : sharesY_)
            for (const TentShare& sx : sharesX_)
                add(sx.cell, sy.cell, double(sx.share) * sy.share);
        return;
    }
    const Footprint fx(x, level.width, width), fy(y, level.height, height);
    const double area = (fx.end - fx.begin) * (fy.end - fy.begin);
    for (int j = fy.first; j < fy.last; ++j)
        for (int i = fx.first; i < fx.last; ++i)
            add(i, j, double(fx.weight(i)) * fy.weight(j) / area);
}

void FineTile::addTexel(int number, int x, int y)
{
    const Level& level = chain_.levels_[size_t(number)];
    gather(level, x, y);
    Moments sum;
    for (const Member& member : members_)
        sum.add(lobes_, member.lobe, member.share);
    TexelTask task = chain_.makeTask(number, x, y, sum.mean());
    Shape same;
    task.uniform = chain_.options_.method == Method::fit && sameLobe(lobes_, members_, same);
    if (task.uniform) { // nothing to fit: its error is 0 without looking
        task.shape = same;
        nodes_.clear();
        nodes_.pad();
        averager_.average(lobes_, {}, false, nodes_);
        solver_.add(task, nodes_, averager_.g());
        return;
    }
    if (task.childCount == 0 && chain_.options_.method == Method::fit)
        addQuadrants(task);
    lattice_.plan(lobes_, members_, task.mean, nodes_);
    averager_.average(lobes_, members_, luminance(task.mean.ks) <= 0.0, nodes_);
    solver_.add(task, nodes_, averager_.g());
}

// No finer level was fitted: the LEAN lobes of the texel's quarters stand in for its children.
void FineTile::addQuadrants(TexelTask& task) const
{
    const auto columnOf = [&](const Member& m) { return m.lobe % uint32_t(rectWidth_); };
    const auto rowOf = [&](const Member& m) { return m.lobe / uint32_t(rectWidth_); };
    const uint32_t middleX = (columnOf(members_.front()) + columnOf(members_.back()) + 1) / 2;
    const uint32_t middleY = (rowOf(members_.front()) + rowOf(members_.back()) + 1) / 2;
    Moments quarters[4];
    for (const Member& m : members_)
        quarters[(rowOf(m) < middleY ? 0 : 2) + (columnOf(m) < middleX ? 0 : 1)].add(lobes_, m.lobe, m.share);
    for (const Moments& quarter : quarters)
        if (quarter.weight > 0.0)
            task.addChild(quarter.mean(), quarter.weight);
}

void FineTile::run(int number, int x0, int y0, int size)
{
    const Level& level = chain_.levels_[size_t(number)];
    const int x1 = std::min(x0 + size, level.width), y1 = std::min(y0 + size, level.height);
    readLobes(number, x0, y0, x1, y1);
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
            addTexel(number, x, y);
    solver_.solve();
    chain_.advance((size_t(x1 - x0) * size_t(y1 - y0)) << (2 * number));
}

} // namespace lumel::baker
