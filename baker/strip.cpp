#include "strip.h"
#include <cmath>

namespace lumel::baker {
namespace {

constexpr float kStripReach = 40.0f;             // spacings to either side, at most
constexpr int kRowsAside = int(kStripReach) + 2; // the longest strip's and what surrounds it
constexpr float kPad = 0.5f; // spacings beyond the lobe's own extent, as of round stencils

// The extent of an outline in each row of the lattice.
class OutlineRows {
public:
    OutlineRows() { extents_.fill({1e30f, -1e30f}); }
    void edge(glm::vec2 a, glm::vec2 b)
    {
        if (a.y > b.y)
            std::swap(a, b);
        const float slope = (b.x - a.x) / std::max(b.y - a.y, 1e-6f);
        const int first = int(std::ceil(std::max(a.y, float(-kRowsAside))));
        const int last = int(std::floor(std::min(b.y, float(kRowsAside))));
        for (int y = first; y <= last; ++y) {
            const float x = a.x + (float(y) - a.y) * slope;
            glm::vec2& extent = extents_[size_t(y + kRowsAside)];
            extent.x = std::min(extent.x, x);
            extent.y = std::max(extent.y, x);
        }
    }
    void toRuns(Stencil& stencil) const
    {
        stencil.clear();
        for (int y = -kRowsAside; y <= kRowsAside; ++y) {
            const glm::vec2 extent = extents_[size_t(y + kRowsAside)];
            if (extent.x > extent.y)
                continue;
            const int from = int(std::ceil(std::max(extent.x, float(-kRowsAside))));
            const int to = int(std::floor(std::min(extent.y, float(kRowsAside))));
            if (from <= to)
                stencil.runs.push_back({y, from, to - from + 1});
        }
        stencil.place();
    }

private:
    std::array<glm::vec2, 2 * kRowsAside + 1> extents_; // from and to
};

} // namespace

Strip::Strip(const Lobes& lobes, size_t m) : normal(lobes.nx[m], lobes.ny[m], lobes.nz[m])
{
    const float xx = lobes.sxx[m], xy = lobes.sxy[m], yy = lobes.syy[m];
    const float mean = 0.5f * (xx + yy), half = 0.5f * (xx - yy), radius = std::sqrt(half * half + xy * xy);
    most = mean + radius;
    least = (xx * yy - xy * xy) / most;
    const float angle = 0.5f * std::atan2(xy, half), c = std::cos(angle), s = std::sin(angle);
    const float r = std::sqrt(std::max(1e-4f, 1.0f - normal.x * normal.x));
    const glm::vec3 u = (glm::vec3(1.0f, 0.0f, 0.0f) - normal * normal.x) / r;
    const glm::vec3 v = glm::vec3(0.0f, normal.z, -normal.y) / r;
    along = c * u + s * v;
    across = c * v - s * u;
    length = std::asin(std::min(1.0f, kMargin * std::sqrt(most)));
    width = std::asin(std::min(1.0f, kMargin * std::sqrt(least)));
}

// At the normal. The length counts as less than it is: along a great circle the direction in the map changes,
// and fits need not lie as the lobes do.
LatticeCovariance Strip::covariance(float spacing) const
{
    constexpr float kShare = 0.25f, kMostRatio = 4.0f;
    const float scale = std::sqrt(2.0f / (1.0f + normal.z));
    const auto onMap = [&](const glm::vec3& step) {
        return scale * (glm::vec2(step) - glm::vec2(normal) * (0.5f * step.z / (1.0f + normal.z)));
    };
    const float across2 = least / (spacing * spacing);
    const float along2 =
        std::min(kShare * kShare * most / (spacing * spacing), kMostRatio * kMostRatio * across2);
    const glm::vec2 u = onMap(along), v = onMap(across);
    return {along2 * u.x * u.x + across2 * v.x * v.x, along2 * u.x * u.y + across2 * v.x * v.y,
            along2 * u.y * u.y + across2 * v.y * v.y, across2};
}

// At an angle from the normal.
Strip::Outline Strip::outlineAt(float angle, glm::vec3 middle, float spacing, glm::vec2 centre) const
{
    const float share = angle / length;
    const float side = width * std::sqrt(std::max(0.0f, 1.0f - share * share)) + kPad * spacing;
    const float out = side * (1.0f - side * side / 6.0f), up = std::sqrt(1.0f - out * out); // sine and cosine
    Outline points;
    for (int i = 0; i < 2; ++i) {
        const glm::vec3 h = middle * up + across * (i == 0 ? out : -out);
        points[size_t(i)] = lambert(h.x, h.y, std::max(h.z, -0.9f)) / spacing - centre;
    }
    return points;
}

void Strip::fill(float spacing, glm::vec2 centre, bool boxOnly, Stencil& stencil) const
{
    // Sines of where the outline bends are close to the ends: it is half an ellipse in the angles.
    constexpr int kSide = 7;
    constexpr float kSteps[kSide] = {0.0f, 0.258819f, 0.5f, 0.707107f, 0.866025f, 0.965926f, 1.0f};
    const float scale = std::sqrt(2.0f / (1.0f + normal.z)); // how much Lambert's map shrinks radially, there
    const float reach = std::min(length + kPad * spacing, kStripReach * spacing * scale);
    if (boxOnly) {
        stencil.lower = stencil.upper = glm::ivec2(0);
        for (const float end : {-reach, reach}) {
            const glm::vec3 tip = normal * std::cos(end) + along * std::sin(end);
            const glm::vec2 at = lambert(tip.x, tip.y, std::max(tip.z, -0.9f)) / spacing - centre;
            const glm::ivec2 point(glm::clamp(at, -float(kRowsAside), float(kRowsAside)));
            stencil.lower = glm::min(stencil.lower, point);
            stencil.upper = glm::max(stencil.upper, point + 1);
        }
        return;
    }
    OutlineRows rows;
    Outline before[2];
    before[0] = before[1] = outlineAt(0.0f, normal, spacing, centre);
    for (int i = 1; i < kSide; ++i) {
        const float angle = reach * kSteps[i], sine = std::sin(angle), cosine = std::cos(angle);
        for (int end = 0; end < 2; ++end) {
            const glm::vec3 middle = normal * cosine + along * (end == 0 ? sine : -sine);
            const Outline now = outlineAt(angle, middle, spacing, centre);
            for (size_t side = 0; side < 2; ++side)
                rows.edge(before[end][side], now[side]);
            if (i == kSide - 1)
                rows.edge(now[0], now[1]);
            before[end] = now;
        }
    }
    rows.toRuns(stencil);
}

} // namespace lumel::baker
