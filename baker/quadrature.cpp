#include "quadrature.h"
#include "fit_kernel.h"
#include "shared/limits.h"

namespace lumel::baker {
namespace {

// Spacing and margin in standard deviations of a lobe. Products of two equal lobes have a Fourier
// transform exp(-(w sigma)^2 / 4): at spacing 0.8 sigma the rule's error is 4 exp(-(pi / 0.8)^2) =
// 8e-7, and beyond 2.75 sigma lies exp(-2.75^2) = 5e-4 of it.
constexpr double kSpacing = 1.0;
constexpr double kMargin = 3.0;
// Below this power lobes reach the rim of the disc, where a lattice ends abruptly; the product rule
// (Gauss-Legendre in h.z, trapezoidal in the angle) covers the disc without an edge.
constexpr double kDiscRulePower = 14.0;

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
NodeSet discRule(int rings, int spokes)
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

const NodeSet& discRuleFor(double power)
{
    static const NodeSet small = discRule(7, 14);
    static const NodeSet medium = discRule(12, 26);
    static const NodeSet large = discRule(24, 56);
    return power <= 1.5 ? small : power <= kDiscRulePower ? medium : large;
}

void addNode(double lx, double ly, double area, NodeSet& nodes)
{
    const double r2 = lx * lx + ly * ly;
    const double z = 1.0 - 0.5 * r2;
    if (z <= 1e-3)
        return;
    const double scale = std::sqrt(1.0 - 0.25 * r2);
    nodes.add(float(lx * scale), float(ly * scale), float(z), float(area * z));
}

// Derivative of Lambert's map along a tangent t of the unit vector n.
glm::dvec2 lambertStep(glm::dvec3 n, glm::dvec3 t)
{
    const double g = std::sqrt(2.0 / (1.0 + n.z));
    return g * (glm::dvec2(t) - glm::dvec2(n) * (0.5 * t.z / (1.0 + n.z)));
}

// Covariance of a lobe in Lambert's map.
Sym2 lambertCovariance(glm::dvec3 n, const Sym2& s)
{
    const double r = std::sqrt(1.0 - n.x * n.x);
    const glm::dvec2 u = lambertStep(n, glm::dvec3(r, -n.x * n.y / r, -n.x * n.z / r));
    const glm::dvec2 v = lambertStep(n, glm::dvec3(0.0, n.z / r, -n.y / r));
    const auto entry = [&](int i, int j) {
        return s.xx * u[i] * u[j] + s.xy * (u[i] * v[j] + v[i] * u[j]) + s.yy * v[i] * v[j];
    };
    return {entry(0, 0), entry(0, 1), entry(1, 1)};
}

} // namespace

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
    while (size() == 0 || size() % kMaxLanes != 0)
        add(0.0f, 0.0f, 1.0f, 0.0f);
}

// Lambert coordinates in which the lobes that matter have unit size and the axes follow their spread:
// y = R^T K^T (l - centre), precision = K K^T.
struct Whitening {
    glm::dvec2 centre{0.0};
    double k11, k21, k22;
    glm::dvec2 axis, side;

    glm::dvec2 apply(glm::dvec2 l) const
    {
        const glm::dvec2 d = l - centre, y(k11 * d.x + k21 * d.y, k22 * d.y);
        return {glm::dot(y, axis), glm::dot(y, side)};
    }
    // A step in whitened coordinates as a step in Lambert's.
    glm::dvec2 undo(glm::dvec2 t) const
    {
        const glm::dvec2 y = axis * t.x + side * t.y;
        const double dy = y.y / k22;
        return {(y.x - k21 * dy) / k11, dy};
    }
};

namespace {

Whitening whitenLobes(const Lobes& lobes, const std::vector<Member>& members, double power, double narrow)
{
    // Precision of the lobes in Lambert's map, weighted by energy: the narrow ones decide.
    Sym2 precision, second;
    Whitening w;
    double total = 0.0, share = 0.0;
    for (const Member& member : members) {
        const uint32_t m = member.lobe;
        Sym2 s{lobes.sxx[m], lobes.sxy[m], lobes.syy[m]};
        const double energy = member.share / std::sqrt(s.det());
        // Long lobes: a fit may be shorter than they are, so the lattice is as fine along them as across.
        if (narrow > 1.02 * power)
            s = {1.0 / narrow, 0.0, 1.0 / narrow};
        precision =
            precision + lambertCovariance({lobes.nx[m], lobes.ny[m], lobes.nz[m]}, s).inverse() * energy;
        total += energy;
        const glm::dvec2 l = lambert(lobes.nx[m], lobes.ny[m], lobes.nz[m]);
        w.centre += l * double(member.share);
        second = second + Sym2{l.x * l.x, l.x * l.y, l.y * l.y} * member.share;
        share += member.share;
    }
    precision = precision * (1.0 / total);
    w.centre /= share;
    const glm::dvec2 c = w.centre;
    const Sym2 covariance = second * (1.0 / share) + Sym2{c.x * c.x, c.x * c.y, c.y * c.y} * -1.0;
    w.k11 = std::sqrt(precision.xx);
    w.k21 = precision.xy / w.k11;
    w.k22 = std::sqrt(std::max(precision.yy - w.k21 * w.k21, 1e-12));
    const double cxx =
        w.k11 * w.k11 * covariance.xx + 2 * w.k11 * w.k21 * covariance.xy + w.k21 * w.k21 * covariance.yy;
    const double cxy = w.k22 * (w.k11 * covariance.xy + w.k21 * covariance.yy),
                 cyy = w.k22 * w.k22 * covariance.yy;
    // Principal axis without angles: the longer of two expressions for the same eigenvector.
    const double half = 0.5 * (cxx - cyy), radius = std::sqrt(half * half + cxy * cxy);
    const glm::dvec2 v = half > 0.0 ? glm::dvec2(half + radius, cxy) : glm::dvec2(cxy, radius - half);
    const double length = std::sqrt(glm::dot(v, v));
    w.axis = length > 1e-9 ? v / length : glm::dvec2(1.0, 0.0);
    w.side = {-w.axis.y, w.axis.x};
    return w;
}

// Does some lobe reach the rim?
bool reachesRim(const Lobes& lobes, const std::vector<Member>& members, double narrow)
{
    for (const Member& member : members) {
        const double nz = lobes.nz[member.lobe], r2 = 1.0 - nz * nz;
        if (r2 > 0.5 && narrow * std::log(r2) > -7.0)
            return true;
    }
    return false;
}

// floor and ceil without a library call: SSE2 has no instruction for them.
int floorInt(float v)
{
    const int i = int(v);
    return i - (v < float(i));
}
int ceilInt(float v)
{
    return -floorInt(-v);
}

} // namespace

void Lattice::plan(const Lobes& lobes, const std::vector<Member>& members, const Moments& mean,
                   NodeSet& nodes)
{
    const double power = mean.energyPower / mean.energy, narrow = mean.energyNarrow / mean.energy;
    if (narrow <= kDiscRulePower || (narrow <= 80.0 && reachesRim(lobes, members, narrow))) {
        nodes = discRuleFor(narrow);
        return;
    }
    const Whitening whitening = whitenLobes(lobes, members, power, narrow);
    glm::vec2 lower(1e30f), upper(-1e30f);
    discs_.clear();
    for (const Member& member : members) {
        const uint32_t m = member.lobe;
        const float wide = 1.0f / lowestPower(lobes, m); // variance along its long side
        const float radius = float(kMargin) * std::clamp(std::sqrt(float(narrow) * wide), 1.0f, 8.0f);
        const glm::vec2 t = whitening.apply(lambert(lobes.nx[m], lobes.ny[m], lobes.nz[m]));
        lower = glm::min(lower, t - radius);
        upper = glm::max(upper, t + radius);
        discs_.push_back(glm::vec3(t, radius));
    }
    const glm::vec2 size = upper - lower;
    const float spacing = std::max(float(kSpacing), std::sqrt(size.x * size.y / float(kMaxNodes)));
    const int n1 = std::max(1, ceilInt(size.x / spacing)), n2 = std::max(1, ceilInt(size.y / spacing));
    const glm::vec2 step = size / glm::vec2(n1, n2);
    cover(lower, step, n1, n2);
    layOut(whitening, lower, step, n1, n2, nodes);
}

// Nodes at the covered lattice points.
void Lattice::layOut(const Whitening& whitening, glm::vec2 lower, glm::vec2 step, int n1, int n2,
                     NodeSet& nodes)
{
    const float area = float(double(step.x) * step.y / (whitening.k11 * whitening.k22));
    const glm::vec2 origin = whitening.centre + whitening.undo(lower + 0.5f * step);
    const glm::vec2 right = whitening.undo({step.x, 0.0}), down = whitening.undo({0.0, step.y});
    nodes.resize(covered_.size());
    size_t count = 0;
    for (int j = 0; j < n2; ++j)
        for (int i = 0; i < n1; ++i) {
            const glm::vec2 l = origin + float(i) * right + float(j) * down;
            nodes.x[count] = l.x;
            nodes.y[count] = l.y;
            // Counted only where it is covered and above the horizon.
            count += covered_[size_t(j) * size_t(n1) + size_t(i)] != 0 && l.x * l.x + l.y * l.y < 1.998f;
        }
    nodes.resize(count);
    for (size_t k = 0; k < count; ++k) {
        const float r2 = nodes.x[k] * nodes.x[k] + nodes.y[k] * nodes.y[k];
        const float scale = std::sqrt(1.0f - 0.25f * r2);
        nodes.x[k] *= scale;
        nodes.y[k] *= scale;
        nodes.z[k] = 1.0f - 0.5f * r2;
        nodes.area[k] = area * nodes.z[k];
    }
    nodes.pad();
}

// Marks the lattice points within some member's disc.
void Lattice::cover(glm::vec2 lower, glm::vec2 step, int n1, int n2)
{
    covered_.assign(size_t(n1) * size_t(n2), 0);
    const glm::vec2 perStep = 1.0f / step;
    for (const glm::vec3& d : discs_) {
        const glm::vec2 at = (glm::vec2(d) - lower) * perStep - 0.5f; // in lattice points
        const float reachY = d.z * perStep.y;
        const int first = std::max(0, ceilInt(at.y - reachY)),
                  last = std::min(n2 - 1, floorInt(at.y + reachY));
        for (int j = first; j <= last; ++j) {
            const float dy = (float(j) - at.y) * step.y;
            const float half = std::sqrt(std::max(0.0f, d.z * d.z - dy * dy)) * perStep.x;
            const int from = std::max(0, ceilInt(at.x - half)), to = std::min(n1 - 1, floorInt(at.x + half));
            unsigned char* row = covered_.data() + size_t(j) * size_t(n1);
            for (int i = from; i <= to; ++i)
                row[i] = 1;
        }
    }
}

void SharedLattice::plan(glm::vec2 lower, glm::vec2 upper, double power, size_t mostNodes)
{
    across_ = down_ = 0;
    nodes_.clear();
    if (power <= kDiscRulePower) {
        nodes_ = discRuleFor(power);
        return;
    }
    const double sigma = 1.0 / std::sqrt(power);
    const double edge = std::sqrt(2.0);
    const glm::dvec2 from = glm::max(glm::dvec2(lower), glm::dvec2(-edge));
    const glm::dvec2 size = glm::min(glm::dvec2(upper), glm::dvec2(edge)) - from;
    const double spacing = std::max(kSpacing * sigma, std::sqrt(size.x * size.y / double(mostNodes)));
    across_ = int(std::ceil(size.x / spacing));
    down_ = int(std::ceil(size.y / spacing));
    stride_ = (across_ + kMaxLanes - 1) / kMaxLanes * kMaxLanes;
    const glm::dvec2 step = size / glm::dvec2(across_, down_);
    for (int j = 0; j < down_; ++j)
        for (int i = 0; i < stride_; ++i) {
            const glm::dvec2 l = from + step * glm::dvec2(i + 0.5, j + 0.5);
            const size_t before = nodes_.size();
            if (i < across_)
                addNode(l.x, l.y, step.x * step.y, nodes_);
            if (nodes_.size() == before) // padding, or off the disc: keeps the rows equally long
                nodes_.add(0.0f, 0.0f, 1.0f, 0.0f);
        }
    from_ = glm::vec2(from);
    step_ = glm::vec2(step);
    nodes_.pad();
}

float supportRadius(float lowestPower)
{
    // Lambert's map stretches lobes by at most sqrt 2, at the rim.
    return std::min(2.9f, float(kMargin) * 1.15f / std::sqrt(lowestPower));
}

} // namespace lumel::baker
