#include "quadrature.h"
#include "fit_kernel.h"
#include "shared/limits.h"
#include <array>

namespace lumel::baker {
namespace {

struct Gauss {
    std::vector<double> x, w; // on [0, 1]
};

Gauss gaussLegendre(int n)
{
    Gauss g;
    for (int i = 0; i < n; ++i) {
        double x = std::cos(double(shared::kPi) * (i + 0.75) / (n + 0.5)), slope = 1.0;
        for (int step = 0; step < 8; ++step) { // Newton on Legendre's polynomial
            double p0 = 1.0, p1 = x;
            for (int k = 2; k <= n; ++k) {
                const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
                p0 = p1;
                p1 = p2;
            }
            slope = n * (x * p1 - p0) / (x * x - 1.0);
            x -= p1 / slope;
        }
        g.x.push_back(0.5 * (x + 1.0));
        g.w.push_back(1.0 / ((1.0 - x * x) * slope * slope));
    }
    return g;
}

// The whole disc: dx dy = z dz dphi.
NodeSet makeDiscRule(int rings, int spokes)
{
    const Gauss gauss = gaussLegendre(rings);
    NodeSet nodes;
    for (int i = 0; i < rings; ++i) {
        const double z = gauss.x[size_t(i)], r = std::sqrt(1.0 - z * z);
        const int count = std::max(6, int(std::ceil(spokes * std::min(1.0, 1.15 * r))));
        for (int j = 0; j < count; ++j) {
            const double phi = 2.0 * 3.14159265358979 * (j + 0.5 * (i & 1)) / count;
            const double area = gauss.w[size_t(i)] * z * 2.0 * 3.14159265358979 / count;
            nodes.add(float(r * std::cos(phi)), float(r * std::sin(phi)), float(z), float(area));
        }
    }
    nodes.pad();
    return nodes;
}

// Runs of lattice points within `radius` of a lattice point. A lobe's centre lies up to 0.71 spacings off it.
Stencil makeStencil(float radius)
{
    Stencil stencil;
    const int reach = int(radius);
    for (int y = -reach; y <= reach; ++y) {
        const int half = int(std::sqrt(std::max(0.0f, radius * radius - float(y * y))));
        stencil.runs.push_back({y, -half, 2 * half + 1});
    }
    stencil.place();
    return stencil;
}

// Is the rule as good for a lobe of covariance S? It errs by exp(-pi^2 w^T S w) for the points w != 0 of the
// dual lattice: those of Z^2 and k (x, y) / step beside them. None of the latter may be worse than the best
// of the former.
bool resolves(const Sublattice& sub, const LatticeCovariance& s)
{
    const float enough = std::min(1.0f, s.least);
    for (int k = 1; k < sub.step; ++k)
        for (int j = -1; j <= 0; ++j)
            for (int i = -1; i <= 0; ++i) {
                const float x = float(k * sub.x % sub.step) / float(sub.step) + float(i);
                const float y = float(k * sub.y % sub.step) / float(sub.step) + float(j);
                if (s.xx * x * x + 2.0f * s.xy * x * y + s.yy * y * y < enough)
                    return false;
            }
    return true;
}

} // namespace

Sublattice sublatticeFor(const std::vector<LatticeCovariance>& lobes)
{
    // All of step 4, by rows, columns, diagonals and knight's moves, then those of step 2.
    static constexpr std::array<Sublattice, 9> kSublattices = {
        {{4, 1, 0}, {4, 0, 1}, {4, 1, 1}, {4, 1, 3}, {4, 1, 2}, {4, 2, 1}, {2, 1, 0}, {2, 0, 1}, {2, 1, 1}}};
    for (const Sublattice& sub : kSublattices)
        if (std::ranges::all_of(lobes, [&](const LatticeCovariance& s) { return resolves(sub, s); }))
            return sub;
    return {};
}

void Stencil::place()
{
    lower = upper = glm::ivec2(0);
    size_t count = 0;
    for (const Run& run : runs) {
        lower = glm::min(lower, glm::ivec2(run.x, run.y));
        upper = glm::max(upper, glm::ivec2(run.x + (run.count - 1) * run.stride + 1, run.y + 1));
        count += size_t(run.count);
    }
    const size_t vectors = (count + kMaxLanes - 1) / kMaxLanes;
    x.resize(vectors * kMaxLanes);
    y.resize(vectors * kMaxLanes);
    float *toX = x.data(), *toY = y.data();
    for (const Run& run : runs)
        for (int i = 0; i < run.count; ++i) {
            *toX++ = float(run.x + i * run.stride);
            *toY++ = float(run.y);
        }
    std::fill(toX, x.data() + x.size(), 0.0f);
    std::fill(toY, y.data() + y.size(), 0.0f);
}

const NodeSet& discRule(double power)
{
    static const NodeSet small = makeDiscRule(7, 14);
    static const NodeSet medium = makeDiscRule(12, 26);
    static const NodeSet large = makeDiscRule(24, 56);
    return power <= 1.5 ? small : power <= kDiscRulePower ? medium : large;
}

const Stencil& stencilFor(float radius)
{
    constexpr float kOff = 0.5f;        // spacings from a lobe's centre to the lattice point, typically 0.38
    constexpr float kStepsPerPoint = 2; // radii differ by half a spacing
    constexpr int kCount = int(kStepsPerPoint * kMostReach) - 1;
    static const std::array<Stencil, kCount> stencils = [] {
        std::array<Stencil, kCount> all;
        for (int i = 0; i < kCount; ++i)
            all[size_t(i)] = makeStencil(float(i + 2) / kStepsPerPoint);
        return all;
    }();
    const int index = int(std::ceil((std::min(radius, 100.0f) + kOff) * kStepsPerPoint)) - 2;
    return stencils[size_t(std::clamp(index, 0, kCount - 1))];
}

void NodeSet::clear()
{
    for (auto* v : {&x, &y, &z, &area})
        v->clear();
}

void NodeSet::resize(size_t count)
{
    for (auto* v : {&x, &y, &z, &area})
        v->resize(count);
}

void NodeSet::add(float nx, float ny, float nz, float nodeArea)
{
    x.push_back(nx);
    y.push_back(ny);
    z.push_back(nz);
    area.push_back(nodeArea);
}

void NodeSet::pad()
{
    do
        add(0.0f, 0.0f, 1.0f, 0.0f);
    while (size() % kMaxLanes != 0);
}

} // namespace lumel::baker
