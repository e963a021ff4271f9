#include "lobe_list.h"
#include "shared/lobe.h"
#include <queue>

namespace lumel::baker {
namespace {

using Span = std::span<ListedLobe>;

// Weighted moments on the disc. Lobes that reflect nothing count a little, so that a black list has any.
struct DiscMoments {
    double weight = 0.0;
    glm::dvec2 mean{0.0};
    Sym2 outer, covariance; // of the normals about the origin; of the lobes

    explicit DiscMoments(std::span<const ListedLobe> lobes)
    {
        for (const ListedLobe& l : lobes) {
            const Shape& s = l.shape;
            const double w = double(l.mass()) + 1e-9 * double(l.area), x = s.nx, y = s.ny;
            weight += w;
            mean += w * glm::dvec2(x, y);
            outer = outer + Sym2{x * x, x * y, y * y} * w;
            covariance = covariance + DiscFrame({x, y, l.nz}).toDisc({s.sxx, s.sxy, s.syy}) * w;
        }
        const double f = 1.0 / weight;
        mean *= f;
        outer = outer * f;
        covariance = covariance * f;
    }
    // Of the normals.
    Sym2 spread() const
    {
        return outer + Sym2{mean.x * mean.x, mean.x * mean.y, mean.y * mean.y} * -1.0;
    }
};

Shape shapeOf(const DiscMoments& m)
{
    const glm::vec3 n = shared::lobeNormal(glm::vec2(m.mean));
    const Sym2 s = clampPowers(DiscFrame(glm::dvec3(n)).fromDisc(m.spread() + m.covariance));
    return {n.x, n.y, float(s.xx), float(s.xy), float(s.yy)};
}

ListedLobe merged(std::span<const ListedLobe> lobes, const Shape& shape)
{
    ListedLobe one{};
    one.shape = shape;
    one.nz = std::sqrt(std::max(1e-4f, 1.0f - shape.nx * shape.nx - shape.ny * shape.ny));
    for (const ListedLobe& l : lobes) {
        one.area += l.area;
        for (int c = 0; c < 3; ++c)
            one.ks[c] += l.area * l.ks[c];
    }
    for (float& ks : one.ks)
        ks /= one.area;
    return one;
}

// A part of a list, and how far its lobes are from one: what splits first.
struct Group {
    Span lobes;
    double distance;
    bool operator<(const Group& o) const { return distance < o.distance; }
};

Group makeGroup(Span lobes)
{
    if (lobes.size() == 1)
        return {lobes, 0.0};
    const DiscMoments m(lobes);
    const Sym2 p = m.covariance.inverse(), c = m.spread();
    const double trace = p.xx * c.xx + 2.0 * p.xy * c.xy + p.yy * c.yy;
    return {lobes, m.weight * trace};
}

// At the mean along the axis of largest spread.
std::pair<Group, Group> split(const Group& group)
{
    const DiscMoments m(group.lobes);
    const Sym2 c = m.spread();
    const double angle = 0.5 * std::atan2(2.0 * c.xy, c.xx - c.yy);
    const glm::dvec2 axis(std::cos(angle), std::sin(angle));
    const double at = glm::dot(axis, m.mean);
    const auto middle = std::partition(group.lobes.begin(), group.lobes.end(), [&](const ListedLobe& l) {
        return glm::dot(axis, glm::dvec2(l.shape.nx, l.shape.ny)) < at;
    });
    size_t count = size_t(middle - group.lobes.begin());
    if (count == 0 || count == group.lobes.size()) // equal normals
        count = group.lobes.size() / 2;
    return {makeGroup(group.lobes.first(count)), makeGroup(group.lobes.subspan(count))};
}

} // namespace

void LobeList::add(const Lobes& lobes, size_t i, float area)
{
    lobes_.push_back({{lobes.nx[i], lobes.ny[i], lobes.sxx[i], lobes.sxy[i], lobes.syy[i]},
                      lobes.nz[i],
                      area,
                      {lobes.ks[0][i], lobes.ks[1][i], lobes.ks[2][i]}});
}

void LobeList::append(const LobeList& other, float factor)
{
    const size_t first = lobes_.size();
    lobes_.insert(lobes_.end(), other.lobes_.begin(), other.lobes_.end());
    for (size_t i = first; i < lobes_.size(); ++i)
        lobes_[i].area *= factor;
}

void LobeList::reduce()
{
    if (lobes_.size() <= kMost)
        return;
    std::priority_queue<Group> groups;
    groups.push(makeGroup(lobes_));
    while (groups.size() < kMost) {
        const auto [a, b] = split(groups.top());
        groups.pop();
        groups.push(a);
        groups.push(b);
    }
    std::vector<ListedLobe> fewer;
    for (; !groups.empty(); groups.pop()) {
        const Span lobes = groups.top().lobes;
        fewer.push_back(lobes.size() == 1 ? lobes.front() : merged(lobes, shapeOf(DiscMoments(lobes))));
    }
    lobes_ = std::move(fewer);
}

void LobeList::merge(const Shape& shape)
{
    lobes_.front() = merged(lobes_, shape);
    lobes_.resize(1);
}

Shape LobeList::matchedShape() const
{
    return shapeOf(DiscMoments(lobes_));
}

MixtureTerm termOf(const ListedLobe& l, float area, bool isBlack)
{
    const Shape& s = l.shape;
    const float det = s.sxx * s.syy - s.sxy * s.sxy, plus = 1.0f / (1.0f + s.sxx + s.syy + det);
    const float mass = isBlack ? l.area : l.mass();
    return {s.nx,
            s.ny,
            l.nz,
            (s.sxx + det) * plus,
            s.sxy * plus,
            (s.syy + det) * plus,
            mass / area * std::sqrt(std::max(l.nz, 0.0f) * plus)};
}

} // namespace lumel::baker
