#include "strip.h"
#include <cmath>

namespace lumel::baker {
namespace {

constexpr float kStripReach = 40.0f;             // spacings to either side, at most
constexpr int kRowsAside = int(kStripReach) + 2; // the longest strip's and what surrounds it
constexpr float kPad = 0.5f; // spacings beyond the lobe's own extent, as of round stencils

// Rounded down and up, of numbers above -64: a conversion to integers is one instruction, libm's is a call.
int floorOf(float v)
{
    return int(v + 64.0f) - 64;
}
int ceilOf(float v)
{
    return -floorOf(-v);
}

// The extent of an outline in each row of the lattice. Coordinates lie within kRowsAside.
class OutlineRows {
public:
    OutlineRows() { extents_.fill({1e30f, -1e30f}); }
    void edge(glm::vec2 a, glm::vec2 b)
    {
        if (a.y > b.y)
            std::swap(a, b);
        const float slope = (b.x - a.x) / std::max(b.y - a.y, 1e-6f);
        const int first = ceilOf(a.y), last = floorOf(b.y);
        for (int y = first; y <= last; ++y) {
            const float x = a.x + (float(y) - a.y) * slope;
            glm::vec2& extent = extents_[size_t(y + kRowsAside)];
            extent.x = std::min(extent.x, x);
            extent.y = std::max(extent.y, x);
        }
        first_ = std::min(first_, first);
        last_ = std::max(last_, last);
    }
    // The points of a sublattice, which counts from elsewhere: `centre` is the origin here.
    void toRuns(const Sublattice& sub, glm::ivec2 centre, Stencil& stencil) const
    {
        stencil.clear();
        for (int y = first_; y <= last_; ++y) {
            const glm::vec2 extent = extents_[size_t(y + kRowsAside)];
            const Sublattice::Row& row = sub.row(centre.y + y);
            if (extent.x > extent.y || row.stride == 0)
                continue;
            const int from = row.from(centre.x + ceilOf(extent.x)) - centre.x, to = floorOf(extent.y);
            if (from <= to)
                stencil.runs.push_back({y, from, (to - from) / row.stride + 1, row.stride});
        }
        stencil.place();
    }

private:
    std::array<glm::vec2, 2 * kRowsAside + 1> extents_; // from and to
    int first_ = kRowsAside, last_ = -kRowsAside;
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

float Strip::reach(float spacing) const
{
    const float scale = std::sqrt(2.0f / (1.0f + normal.z)); // how much Lambert's map shrinks radially, there
    return std::min(length + kPad * spacing, kStripReach * spacing * scale);
}

void Strip::findBox(float spacing, glm::vec2 centre, Stencil& stencil) const
{
    const float most = reach(spacing);
    stencil.lower = stencil.upper = glm::ivec2(0);
    for (const float end : {-most, most}) {
        const glm::vec3 tip = normal * std::cos(end) + along * std::sin(end);
        const glm::vec2 at = lambert(tip.x, tip.y, std::max(tip.z, -0.9f)) / spacing - centre;
        const glm::ivec2 point(glm::clamp(at, -float(kRowsAside), float(kRowsAside)));
        stencil.lower = glm::min(stencil.lower, point);
        stencil.upper = glm::max(stencil.upper, point + 1);
    }
}

// Points around the strip, in order: along one side and back along the other. Half an ellipse in the angles:
// sines of where it bends are close to the ends.
Strip::Outline Strip::outline(float spacing, glm::vec2 centre) const
{
    constexpr float kSteps[kAlong] = {-1.0f,      -0.965926f, -0.866025f, -0.707107f, -0.5f,
                                      -0.258819f, 0.0f,       0.258819f,  0.5f,       0.707107f,
                                      0.866025f,  0.965926f,  1.0f};
    const float most = reach(spacing), perLength = 1.0f / length, perSpacing = 1.0f / spacing;
    Outline points;
    for (int i = 0; i < kAlong; ++i) { // vectors, as the next loops are
        const float angle = most * kSteps[i], a2 = angle * angle, share = angle * perLength;
        const float side = width * std::sqrt(std::max(0.0f, 1.0f - share * share)) + kPad * spacing;
        // Taylor's series, to 4e-6 at a right angle.
        points.sine[i] =
            angle * (1.0f + a2 * (-1.0f / 6 + a2 * (1.0f / 120 + a2 * (-1.0f / 5040 + a2 / 362880))));
        points.out[i] = side * (1.0f - side * side / 6.0f);
    }
    for (int i = 0; i < kAlong; ++i)
        points.out[2 * kAlong - 1 - i] = -points.out[i];
    for (int i = 0; i < kAlong; ++i)
        points.sine[2 * kAlong - 1 - i] = points.sine[i];
    for (int i = 0; i < 2 * kAlong; ++i) {
        const float sine = points.sine[i], out = points.out[i], up = std::sqrt(1.0f - out * out);
        const float cosine = std::sqrt(std::max(0.0f, 1.0f - sine * sine));
        const float n = cosine * up, a = sine * up;
        const float z = std::max(normal.z * n + along.z * a + across.z * out, -0.9f);
        const float scale = std::sqrt(2.0f / (1.0f + z)) * perSpacing; // as lambert()
        const float x = (normal.x * n + along.x * a + across.x * out) * scale - centre.x;
        const float y = (normal.y * n + along.y * a + across.y * out) * scale - centre.y;
        points.x[i] = std::clamp(x, -float(kRowsAside), float(kRowsAside));
        points.y[i] = std::clamp(y, -float(kRowsAside), float(kRowsAside));
    }
    return points;
}

void Strip::fill(float spacing, glm::vec2 centre, const Sublattice& sub, Stencil& stencil) const
{
    const Outline points = outline(spacing, centre);
    OutlineRows rows;
    glm::vec2 before(points.x[2 * kAlong - 1], points.y[2 * kAlong - 1]);
    for (int i = 0; i < 2 * kAlong; ++i) {
        const glm::vec2 now(points.x[i], points.y[i]);
        rows.edge(before, now);
        before = now;
    }
    rows.toRuns(sub, glm::ivec2(centre), stencil);
}

} // namespace lumel::baker
