#include "lobe_list.h"
#include "shared/lobe.h"
#include <queue>

namespace lumel::baker {
namespace {

// A lobe on the disc and its weight: what it reflects, or a little, so that a black list has any.
struct Item {
    double weight, x, y;
    Sym2 covariance;
    uint32_t lobe;
};

Item itemOf(const ListedLobe& l, uint32_t index)
{
    const Shape& s = l.shape;
    const double weight = double(l.mass()) + 1e-9 * double(l.area);
    return {weight, s.nx, s.ny, DiscFrame({s.nx, s.ny, l.nz}).toDisc({s.sxx, s.sxy, s.syy}), index};
}

// Weighted means.
struct DiscMoments {
    double weight = 0.0, x = 0.0, y = 0.0;
    Sym2 spread, covariance; // of the normals; of the lobes
    double widths = 0.0;     // variance of the lobes' covariances, relative to their mean

    explicit DiscMoments(std::span<const Item> items)
    {
        Sym2 outer;
        double squares = 0.0;
        for (const Item& i : items) {
            const Sym2& c = i.covariance;
            weight += i.weight;
            x += i.weight * i.x;
            y += i.weight * i.y;
            outer = outer + Sym2{i.x * i.x, i.x * i.y, i.y * i.y} * i.weight;
            covariance = covariance + c * i.weight;
            squares += i.weight * (c.xx * c.xx + 2.0 * c.xy * c.xy + c.yy * c.yy);
        }
        const double f = 1.0 / weight;
        x *= f;
        y *= f;
        covariance = covariance * f;
        spread = outer * f + Sym2{x * x, x * y, y * y} * -1.0;
        const Sym2& c = covariance;
        widths = std::max(0.0, squares * f / (c.xx * c.xx + 2.0 * c.xy * c.xy + c.yy * c.yy) - 1.0);
    }
};

Shape shapeOf(const DiscMoments& m)
{
    const glm::vec3 n = shared::lobeNormal(glm::vec2(m.x, m.y));
    const Sym2 s = clampPowers(DiscFrame(glm::dvec3(n)).fromDisc(m.spread + m.covariance));
    return {n.x, n.y, float(s.xx), float(s.xy), float(s.yy)};
}

// A part of a list, and what it loses as one lobe.
struct Group {
    std::span<Item> items;
    DiscMoments moments;
    double normals = 0.0; // square of the normals' variance, relative to the lobes'
    double loss = 0.0;

    explicit Group(std::span<Item> of) : items(of), moments(of)
    {
        if (items.size() == 1)
            return;
        const Sym2 p = moments.covariance.inverse(), &c = moments.spread;
        const double variance = std::max(0.0, p.xx * c.xx + 2.0 * p.xy * c.xy + p.yy * c.yy);
        normals = variance * variance;
        // The lobe matches all moments up to the second; E goes with the square of the fourth cumulant, and
        // is of the group's own energy.
        const double cumulant = normals + 1.5 * moments.widths;
        loss = moments.weight * moments.weight * std::sqrt(p.det()) * cumulant * cumulant;
    }
    bool operator<(const Group& o) const { return loss < o.loss; }

    // By width, or at the mean along the axis of largest spread.
    std::pair<Group, Group> split() const
    {
        const Sym2& c = moments.spread;
        const double angle = 0.5 * std::atan2(2.0 * c.xy, c.xx - c.yy), ax = std::cos(angle),
                     ay = std::sin(angle);
        const bool byWidth = 1.5 * moments.widths > normals;
        const double at =
            byWidth ? moments.covariance.xx + moments.covariance.yy : ax * moments.x + ay * moments.y;
        const auto middle = std::partition(items.begin(), items.end(), [&](const Item& i) {
            return (byWidth ? i.covariance.xx + i.covariance.yy : ax * i.x + ay * i.y) < at;
        });
        size_t count = size_t(middle - items.begin());
        if (count == 0 || count == items.size()) // no difference there
            count = items.size() / 2;
        return {Group(items.first(count)), Group(items.subspan(count))};
    }
};

// One lobe of this shape that reflects as much.
template<class Range>
ListedLobe merged(const Range& lobes, const Shape& shape)
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

std::vector<Item> itemsOf(const std::vector<ListedLobe>& lobes)
{
    std::vector<Item> items;
    items.reserve(lobes.size());
    for (const ListedLobe& lobe : lobes)
        items.push_back(itemOf(lobe, uint32_t(items.size())));
    return items;
}

} // namespace

void ListedLobe::store(Lobes& lobes, size_t i) const
{
    lobes.nx[i] = shape.nx;
    lobes.ny[i] = shape.ny;
    lobes.nz[i] = nz;
    lobes.sxx[i] = shape.sxx;
    lobes.sxy[i] = shape.sxy;
    lobes.syy[i] = shape.syy;
    for (int c = 0; c < 3; ++c)
        lobes.ks[c][i] = ks[c];
}

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
    std::vector<Item> items = itemsOf(lobes_);
    std::priority_queue<Group> groups;
    groups.emplace(items);
    while (groups.size() < kMost && groups.top().loss > 0.0) {
        const auto [a, b] = groups.top().split();
        groups.pop();
        groups.push(a);
        groups.push(b);
    }
    std::vector<ListedLobe> fewer, part;
    for (; !groups.empty(); groups.pop()) {
        const Group& group = groups.top();
        part.clear();
        for (const Item& item : group.items)
            part.push_back(lobes_[item.lobe]);
        fewer.push_back(part.size() == 1 ? part.front() : merged(part, shapeOf(group.moments)));
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
    return shapeOf(DiscMoments(itemsOf(lobes_)));
}

MixtureTerm unitTerm(const Shape& s)
{
    const float nz = std::sqrt(std::max(1e-4f, 1.0f - s.nx * s.nx - s.ny * s.ny));
    return termOf({s, nz, 1.0f, {1.0f, 1.0f, 1.0f}}, 1.0f, false);
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
            mass / area * std::sqrt(plus)};
}

} // namespace lumel::baker
