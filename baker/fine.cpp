#include "fine.h"
#include "footprint.h"
#include <numeric>

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
    : chain_(chain), group_(chain.options_, chain.source_.isotropic(), chain.source_.colouredSpecular())
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

void FineTile::prepare(int number, int x, int y, Texel& texel)
{
    const Level& level = chain_.levels_[size_t(number)];
    const Footprint fx(x, level.width, chain_.source_.width()), fy(y, level.height, chain_.source_.height());
    const double area = (fx.end - fx.begin) * (fy.end - fy.begin);
    Moments sum;
    texel.members.clear();
    for (int j = fy.first; j < fy.last; ++j)
        for (int i = fx.first; i < fx.last; ++i) {
            const size_t lobe = size_t(j - originY_) * size_t(rectWidth_) + size_t(i - originX_);
            const double covered = double(fx.weight(i)) * fy.weight(j);
            sum.add(lobes_, lobe, covered);
            texel.members.push_back({uint32_t(lobe), float(covered / area)});
        }
    texel.task = chain_.makeTask(number, x, y, sum.mean());
    Shape same;
    texel.task.uniform = chain_.options_.method == Method::fit && sameLobe(lobes_, texel.members, same);
    if (texel.task.uniform)
        texel.task.shape = same;
    Lattice::plan(lobes_, texel.members.data(), texel.members.size(), texel.task.mean, texel.nodes);
}

void FineTile::run(int number, int x0, int y0, int size)
{
    const Level& level = chain_.levels_[size_t(number)];
    const int x1 = std::min(x0 + size, level.width), y1 = std::min(y0 + size, level.height);
    readLobes(number, x0, y0, x1, y1);
    const size_t count = size_t(x1 - x0) * size_t(y1 - y0);
    if (texels_.size() < count)
        texels_.resize(count);
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
            prepare(number, x, y, texels_[size_t(y - y0) * size_t(x1 - x0) + size_t(x - x0)]);
    // Texels with about as many nodes share a group: its lanes walk their nodes together.
    order_.resize(count);
    std::iota(order_.begin(), order_.end(), size_t(0));
    std::stable_sort(order_.begin(), order_.end(),
                     [&](size_t a, size_t b) { return texels_[a].nodes.size() < texels_[b].nodes.size(); });
    std::array<std::vector<Member>, kMaxLanes> members;
    for (size_t first = 0; first < count; first += size_t(group_.lanes())) {
        const int lanes = int(std::min(count - first, size_t(group_.lanes())));
        group_.begin(lanes, texels_[order_[first + size_t(lanes) - 1]].nodes.size());
        for (int lane = 0; lane < lanes; ++lane) {
            Texel& texel = texels_[order_[first + size_t(lane)]];
            group_.setNodes(lane, texel.nodes);
            group_.setTask(lane, texel.task);
            members[size_t(lane)].swap(texel.members);
        }
        group_.average(lobes_, members.data());
        group_.finish();
    }
    chain_.advance((count << (2 * number)));
}

} // namespace lumel::baker
