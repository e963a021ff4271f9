// A tree of boxes tells which triangles are near each other. Of each triangle, whatever meets its interior is
// cut out: first the triangles before it, which leaves its share of the covered area, then those after it,
// which leaves what only it covers. The difference, summed up, is covered twice or more, exactly and
// for any number of layers.
#include "uv_check.h"
#include <fmt/format.h>
#include <numeric>

namespace lumel::scene {
namespace {

using Vec2 = glm::dvec2;
using Polygon = std::vector<Vec2>; // convex, counter-clockwise

constexpr double kOutside = 1e-4; // how far UVs may leave [0, 1]: under half a lumel of a 4096^2 texture

// Tolerances. A lit texture has at most 4096^2 lumels. Two triangles that sink into each other by less
// than a quarter of one (16-bit UVs at T-junctions do, by 1/65536) share none in practice; but no more
// than a twentieth of the thinner triangle counts as touching, so that fine meshes stacked on each other
// are found. A total of less than one tile of 8 x 8 lumels is let pass: folded slivers that exporters
// leave behind (FlightHelmet's wood has 27 lumels of them) would cost a whole object its lit texture for
// a blemish that no view magnifies beyond 8 x 8 pixels of the finest level.
constexpr double kTouchDepth = 0.25 / 4096.0;
constexpr double kTouchFraction = 0.05;
constexpr double kToleratedArea = 64.0 / (4096.0 * 4096.0);

// Boxes, pairs and pieces looked at before giving up: about a second. Meshes take some 70 a triangle; only
// thousands of triangles through one spot come here, and they overlap.
constexpr size_t kMaxWork = 100'000'000;

struct Triangle {
    std::array<Vec2, 3> p; // counter-clockwise
    Vec2 lower, upper;
    double area;
    double height; // smallest
};

// Twice the signed area. UVs are floats, so the differences are exact in double, and with them the sign.
double cross(Vec2 a, Vec2 b, Vec2 c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Counter-clockwise; area 0 where it has no interior, and so nothing to overlap.
Triangle makeTriangle(std::array<Vec2, 3> p)
{
    Triangle t{.p = p, .lower = {}, .upper = {}, .area = 0.0, .height = 0.0};
    double twice = cross(p[0], p[1], p[2]);
    if (twice < 0.0) {
        std::swap(t.p[1], t.p[2]);
        twice = -twice;
    }
    const double longest = std::max(
        {glm::distance(t.p[0], t.p[1]), glm::distance(t.p[1], t.p[2]), glm::distance(t.p[2], t.p[0])});
    t.area = 0.5 * twice;
    t.height = twice > 0.0 ? twice / longest : 0.0;
    t.lower = glm::min(t.p[0], glm::min(t.p[1], t.p[2]));
    t.upper = glm::max(t.p[0], glm::max(t.p[1], t.p[2]));
    return t;
}

std::vector<Triangle> trianglesOf(const Mesh& mesh)
{
    std::vector<Triangle> triangles;
    triangles.reserve(mesh.indices.size() / 3);
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        const Triangle t = makeTriangle({Vec2(mesh.vertices[mesh.indices[i]].uv),
                                         Vec2(mesh.vertices[mesh.indices[i + 1]].uv),
                                         Vec2(mesh.vertices[mesh.indices[i + 2]].uv)});
        if (t.area > 0.0)
            triangles.push_back(t);
    }
    return triangles;
}

// How far `b` reaches over the edge of `a` that it reaches over least; not positive when that edge
// separates them (separating axis theorem).
double depthInto(const Triangle& a, const Triangle& b)
{
    double least = std::numeric_limits<double>::max();
    for (size_t e = 0; e < 3; ++e) {
        const Vec2 p = a.p[e], q = a.p[(e + 1) % 3];
        const double over = std::max({cross(p, q, b.p[0]), cross(p, q, b.p[1]), cross(p, q, b.p[2])});
        if (over <= 0.0)
            return 0.0;
        least = std::min(least, over / glm::distance(p, q));
    }
    return least;
}

bool interiorsMeet(const Triangle& a, const Triangle& b)
{
    const double touching = std::min(kTouchDepth, kTouchFraction * std::min(a.height, b.height));
    return a.lower.x < b.upper.x && b.lower.x < a.upper.x && a.lower.y < b.upper.y && b.lower.y < a.upper.y &&
           depthInto(a, b) > touching && depthInto(b, a) > touching;
}

// The part of `polygon` on the left of the line p -> q (side = 1) or on its right (side = -1).
Polygon clip(const Polygon& polygon, Vec2 p, Vec2 q, double side)
{
    Polygon result;
    for (size_t i = 0; i < polygon.size(); ++i) {
        const Vec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
        const double da = side * cross(p, q, a), db = side * cross(p, q, b);
        if (da >= 0.0)
            result.push_back(a);
        if ((da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0))
            result.push_back(a + (b - a) * (da / (da - db)));
    }
    return result;
}

double areaOf(const Polygon& polygon)
{
    double twice = 0.0;
    for (size_t i = 1; i + 1 < polygon.size(); ++i)
        twice += cross(polygon[0], polygon[i], polygon[i + 1]);
    return 0.5 * twice;
}

// Cuts `hole` out of all pieces: what lies beyond each edge stays, what is inside of all three goes.
void subtract(std::vector<Polygon>& pieces, const Triangle& hole)
{
    constexpr double kDust = 1e-18; // pieces too small to matter to any sum
    std::vector<Polygon> rest;
    for (Polygon& piece : pieces) {
        for (size_t e = 0; e < 3 && piece.size() >= 3; ++e) {
            const Vec2 p = hole.p[e], q = hole.p[(e + 1) % 3];
            Polygon beyond = clip(piece, p, q, -1.0);
            if (beyond.size() >= 3 && areaOf(beyond) > kDust)
                rest.push_back(std::move(beyond));
            piece = clip(piece, p, q, 1.0);
        }
    }
    pieces = std::move(rest);
}

struct Cut {
    double first; // area that no earlier triangle covers
    double alone; // area that no other triangle covers
};

Cut cutOut(const std::vector<Triangle>& triangles, int index, std::vector<int>& meeting, size_t& work)
{
    const Triangle& t = triangles[size_t(index)];
    Cut cut = {t.area, t.area};
    if (meeting.empty())
        return cut;
    std::sort(meeting.begin(), meeting.end());
    std::vector<Polygon> pieces = {Polygon(t.p.begin(), t.p.end())};
    const auto areaLeft = [&] {
        double sum = 0.0;
        for (const Polygon& piece : pieces)
            sum += areaOf(piece);
        return std::min(sum, t.area);
    };
    bool later = false;
    for (int other : meeting) {
        if (other > index && !later) {
            cut.first = areaLeft();
            later = true;
        }
        if (pieces.empty() || work > kMaxWork)
            break;
        work += 16 * pieces.size(); // a cut costs about that many visits
        subtract(pieces, triangles[size_t(other)]);
    }
    cut.alone = areaLeft();
    if (!later)
        cut.first = cut.alone;
    return cut;
}

// A tree of boxes over the triangles, halved at the median of the longer axis: unlike a grid it does not
// mind charts that are a thousand times finer than others.
class BoxTree {
public:
    explicit BoxTree(const std::vector<Triangle>& triangles) : triangles_(triangles), order_(triangles.size())
    {
        std::iota(order_.begin(), order_.end(), 0);
        if (!order_.empty())
            build(0, int(order_.size()));
    }

    // Calls visit(triangle) for those whose box meets the given one's interior. Returns the steps taken.
    template<class Visit>
    size_t query(Vec2 lower, Vec2 upper, const Visit& visit)
    {
        size_t steps = 0;
        stack_.assign(nodes_.empty() ? 0 : 1, 0);
        while (!stack_.empty()) {
            const Node& node = nodes_[size_t(stack_.back())];
            stack_.pop_back();
            ++steps;
            if (node.lower.x >= upper.x || node.upper.x <= lower.x || node.lower.y >= upper.y ||
                node.upper.y <= lower.y)
                continue;
            if (node.right > 0) {
                stack_.push_back(node.right);
                stack_.push_back(int(&node - nodes_.data()) + 1);
                continue;
            }
            for (int i = node.begin; i < node.end; ++i, ++steps)
                visit(order_[size_t(i)]);
        }
        return steps;
    }

private:
    struct Node {
        Vec2 lower{1e30}, upper{-1e30};
        int begin, end;
        int right = 0; // the left child follows its parent; 0: a leaf
    };
    static constexpr int kLeafSize = 4;

    int build(int begin, int end) // recurses log2(n) deep
    {
        const size_t index = nodes_.size();
        nodes_.push_back({.begin = begin, .end = end});
        Vec2 lower(1e30), upper(-1e30);
        for (int i = begin; i < end; ++i) {
            const Triangle& t = triangles_[size_t(order_[size_t(i)])];
            lower = glm::min(lower, t.lower);
            upper = glm::max(upper, t.upper);
        }
        nodes_[index].lower = lower;
        nodes_[index].upper = upper;
        if (end - begin <= kLeafSize)
            return int(index);
        const int axis = upper.x - lower.x > upper.y - lower.y ? 0 : 1;
        const int middle = begin + (end - begin) / 2;
        std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                         [&](int a, int b) {
                             const Triangle &ta = triangles_[size_t(a)], &tb = triangles_[size_t(b)];
                             return ta.lower[axis] + ta.upper[axis] < tb.lower[axis] + tb.upper[axis];
                         });
        build(begin, middle);
        const int right = build(middle, end);
        nodes_[index].right = right;
        return int(index);
    }

    const std::vector<Triangle>& triangles_;
    std::vector<int> order_;
    std::vector<Node> nodes_;
    std::vector<int> stack_;
};

} // namespace

bool anyOverlap(std::span<const FlatTriangle> flat)
{
    std::vector<Triangle> triangles;
    triangles.reserve(flat.size());
    for (const FlatTriangle& corners : flat)
        if (const Triangle t = makeTriangle(corners); t.area > 0.0)
            triangles.push_back(t);
    BoxTree tree(triangles);
    bool found = false;
    for (int i = 0; i < int(triangles.size()) && !found; ++i) {
        const Triangle& t = triangles[size_t(i)];
        tree.query(t.lower, t.upper, [&](int other) {
            found = found || (other > i && interiorsMeet(t, triangles[size_t(other)]));
        });
    }
    return found;
}

UvOverlap findUvOverlap(const Mesh& mesh)
{
    const std::vector<Triangle> triangles = trianglesOf(mesh);
    BoxTree tree(triangles);
    std::vector<int> meeting; // the ones whose interior meets the current one's
    UvOverlap result;
    size_t work = 0;
    for (int i = 0; i < int(triangles.size()) && work <= kMaxWork; ++i) {
        const Triangle& t = triangles[size_t(i)];
        meeting.clear();
        work += tree.query(t.lower, t.upper, [&](int other) {
            if (other != i && interiorsMeet(t, triangles[size_t(other)]))
                meeting.push_back(other);
        });
        const Cut cut = cutOut(triangles, i, meeting, work);
        result.covered += cut.first;
        result.repeated += cut.first - cut.alone;
    }
    result.complete = work <= kMaxWork;
    return result;
}

std::string findUvProblem(const Mesh& mesh)
{
    bool spansArea = false;
    for (const Vertex& v : mesh.vertices) {
        if (v.uv.x < -kOutside || v.uv.y < -kOutside || v.uv.x > 1.0 + kOutside || v.uv.y > 1.0 + kOutside)
            return "UVs leave [0, 1]";
    }
    for (size_t i = 0; i + 2 < mesh.indices.size() && !spansArea; i += 3)
        spansArea =
            cross(Vec2(mesh.vertices[mesh.indices[i]].uv), Vec2(mesh.vertices[mesh.indices[i + 1]].uv),
                  Vec2(mesh.vertices[mesh.indices[i + 2]].uv)) != 0.0;
    if (!spansArea)
        return "UVs cover no area";
    const UvOverlap overlap = findUvOverlap(mesh);
    if (overlap.complete && overlap.repeated < kToleratedArea)
        return "";
    const double percent = 100.0 * overlap.share();
    return fmt::format("UVs overlap by {}{} %", overlap.complete ? "" : "at least ",
                       percent >= 0.1 ? fmt::format("{:.1f}", percent) : fmt::format("{:.1g}", percent));
}

} // namespace lumel::scene
