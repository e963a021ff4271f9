#include "fine.h"
#include "footprint.h"

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

void FineTile::readLobes(int number, int x0, int y0, int x1, int y1)
{
    const Level& level = chain_.levels_[size_t(number)];
    const Source& source = chain_.source_;
    originX_ = Footprint(x0, level.width, source.width()).first;
    originY_ = Footprint(y0, level.height, source.height()).first;
    const int endX = Footprint(x1 - 1, level.width, source.width()).last;
    const int endY = Footprint(y1 - 1, level.height, source.height()).last;
    rectWidth_ = endX - originX_;
    lobes_.resize(size_t(rectWidth_) * size_t(endY - originY_));
    for (int y = originY_; y < endY; ++y)
        source.read(y, originX_, endX, lobes_, size_t(y - originY_) * size_t(rectWidth_));
}

void FineTile::addTexel(int number, int x, int y)
{
    const Level& level = chain_.levels_[size_t(number)];
    const Footprint fx(x, level.width, chain_.source_.width()), fy(y, level.height, chain_.source_.height());
    const double area = (fx.end - fx.begin) * (fy.end - fy.begin);
    Moments sum;
    members_.clear();
    for (int j = fy.first; j < fy.last; ++j)
        for (int i = fx.first; i < fx.last; ++i) {
            const size_t lobe = size_t(j - originY_) * size_t(rectWidth_) + size_t(i - originX_);
            const double covered = double(fx.weight(i)) * fy.weight(j);
            sum.add(lobes_, lobe, covered);
            members_.push_back({uint32_t(lobe), float(covered / area)});
        }
    TexelTask task = chain_.makeTask(number, x, y, sum.mean());
    Shape same;
    task.uniform = chain_.options_.method == Method::fit && sameLobe(lobes_, members_, same);
    if (task.uniform)
        task.shape = same;
    if (task.childCount == 0)
        addQuadrants(fx, fy, task);
    lattice_.plan(lobes_, members_, task.mean, nodes_);
    averager_.average(lobes_, members_, luminance(task.mean.ks) <= 0.0, nodes_);
    solver_.add(task, nodes_, averager_.g());
}

// No finer level was fitted: the LEAN lobes of the texel's quarters stand in for its children.
void FineTile::addQuadrants(const Footprint& fx, const Footprint& fy, TexelTask& task) const
{
    Moments quarters[4];
    const double middleX = 0.5 * (fx.begin + fx.end), middleY = 0.5 * (fy.begin + fy.end);
    size_t k = 0;
    for (int j = fy.first; j < fy.last; ++j)
        for (int i = fx.first; i < fx.last; ++i, ++k)
            quarters[(j + 0.5 < middleY ? 0 : 2) + (i + 0.5 < middleX ? 0 : 1)].add(lobes_, members_[k].lobe,
                                                                                    members_[k].share);
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
