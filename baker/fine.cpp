#include "fine.h"
#include "footprint.h"
#include "normals.h"
#include "profile.h"

namespace lumel::baker {

FineTile::FineTile(Chain& chain, const CoarseCells* cells)
    : chain_(chain), shared_(cells ? cells->sharedNodes() : nullptr), isBlack_(cells && cells->isBlack()),
      solver_(chain.options_, chain.source_), averager_(chain.source_)
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
    const StepTimer timer(chain_.options_.profile, Step::input);
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

// The lobes under a texel with their areas, or with their shares of a tent.
void FineTile::gatherMembers(const Level& level, int x, int y)
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
    for (int j = fy.first; j < fy.last; ++j)
        for (int i = fx.first; i < fx.last; ++i)
            add(i, j, double(fx.weight(i)) * fy.weight(j));
}

void FineTile::fill(int number, int x, int y, bool isCell, Cell& cell)
{
    if (haveFiner_) {
        const Cell* below =
            &finer_.cells[size_t(2 * y - finer_.y0) * size_t(finer_.width) + size_t(2 * x - finer_.x0)];
        const Cell* quad[4] = {below, below + 1, below + finer_.width, below + finer_.width + 1};
        const auto isShared = [&](const Cell* c) {
            return chain_.usesLists_ ||
                   (c->patch.nodes == *shared_ && (isBlack_ || luminance(c->sum.ks) > 0.0));
        };
        if (std::all_of(quad, quad + 4, isShared)) {
            cell.clear();
            for (const Cell* c : quad)
                cell.merge(*c, 1.0, averager_.channels());
            cell.shortenList();
            return;
        }
    }
    gatherMembers(chain_.levels_[size_t(number)], x, y);
    if (chain_.usesLists_) {
        averager_.list(lobes_, members_, cell);
        return;
    }
    const bool share =
        shared_ && (isCell || !averager_.reachesRim(lobes_, members_, chain_.source_.maxPower()));
    averager_.gather(lobes_, members_, share ? shared_ : nullptr, isBlack_, cell);
}

void FineTile::addTexel(int number, int x, int y, Cell& cell)
{
    fill(number, x, y, false, cell);
    TexelTask task = chain_.makeTask(number, x, y, cell);
    if (task.childCount == 0 && !task.fixed)
        addChildren(number, x, y, task);
    task.list = cell.list.empty() || &cell == &single_ ? nullptr : &cell.list;
    solver_.add(task, cell);
}

// No finer level was fitted: the lobes themselves, or where they are many, the LEAN lobes of the texel's
// quarters stand in for its children.
void FineTile::addChildren(int number, int x, int y, TexelTask& task)
{
    gatherMembers(chain_.levels_[size_t(number)], x, y);
    if (members_.size() <= size_t(TexelTask::kMostChildren)) {
        for (const Member& m : members_) {
            const size_t i = m.lobe;
            const auto ks = float(luminance({lobes_.ks[0][i], lobes_.ks[1][i], lobes_.ks[2][i]}));
            task.children[size_t(task.childCount++)] = {
                {lobes_.nx[i], lobes_.ny[i], lobes_.sxx[i], lobes_.sxy[i], lobes_.syy[i]},
                ks,
                float(m.area / task.mean.weight)};
        }
        return;
    }
    const auto columnOf = [&](const Member& m) { return m.lobe % uint32_t(rectWidth_); };
    const auto rowOf = [&](const Member& m) { return m.lobe / uint32_t(rectWidth_); };
    const uint32_t middleX = (columnOf(members_.front()) + columnOf(members_.back()) + 1) / 2;
    const uint32_t middleY = (rowOf(members_.front()) + rowOf(members_.back()) + 1) / 2;
    Moments quarters[4];
    for (const Member& m : members_)
        quarters[(rowOf(m) < middleY ? 0 : 2) + (columnOf(m) < middleX ? 0 : 1)].add(lobes_, m.lobe, m.area);
    for (const Moments& quarter : quarters)
        if (quarter.weight > 0.0)
            task.addChild(quarter.mean(), quarter.weight);
}

void FineTile::run(int number, int x0, int y0, int size)
{
    const StepTimer timer(chain_.options_.profile, Step::sums);
    const Level& level = chain_.levels_[size_t(number)];
    const int x1 = std::min(x0 + size, level.width), y1 = std::min(y0 + size, level.height);
    haveFiner_ = false;
    readLobes(number, x0, y0, x1, y1);
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x)
            addTexel(number, x, y, single_);
    solver_.solve();
    chain_.advance(number, size_t(x1 - x0) * size_t(y1 - y0));
}

void FineTile::runNested(int top, int x0, int y0, int size, CoarseCells& cells)
{
    const StepTimer timer(chain_.options_.profile, Step::sums);
    const Level& last = chain_.levels_[size_t(top)];
    const int x1 = std::min(x0 + size, last.width), y1 = std::min(y0 + size, last.height);
    const int first = std::max(1, chain_.options_.reduce);
    readLobes(top, x0, y0, x1, y1);
    haveFiner_ = false;
    for (int number = first; number <= top; ++number) {
        const int scale = 1 << (top - number);
        current_.x0 = x0 * scale;
        current_.y0 = y0 * scale;
        current_.width = (x1 - x0) * scale;
        const int height = (y1 - y0) * scale;
        current_.cells.resize(std::max(current_.cells.size(), size_t(current_.width) * size_t(height)));
        size_t i = 0;
        for (int y = current_.y0; y < current_.y0 + height; ++y)
            for (int x = current_.x0; x < current_.x0 + current_.width; ++x, ++i)
                if (number < top)
                    addTexel(number, x, y, current_.cells[i]);
                else
                    fill(number, x, y, true, cells.at(x, y));
        if (number < top)
            solver_.solve();
        chain_.advance(number, number < top ? i : 0);
        std::swap(finer_, current_);
        haveFiner_ = true;
    }
}

} // namespace lumel::baker
