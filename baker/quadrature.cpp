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

void Lattice::plan(const Lobes& lobes, const std::vector<Member>& members, const Moments& mean,
                   NodeSet& nodes)
{
    const size_t count = members.size();
    const double power = mean.energyPower / mean.energy, narrow = mean.energyNarrow / mean.energy;
    const auto rim = [&] { // does some lobe reach the rim?
        for (size_t i = 0; i < count; ++i) {
            const uint32_t m = members[i].lobe;
            const double r2 = 1.0 - double(lobes.nz[m]) * lobes.nz[m];
            if (r2 > 0.5 && narrow * std::log(r2) > -7.0)
                return true;
        }
        return false;
    };
    if (narrow <= kDiscRulePower || (narrow <= 80.0 && rim())) {
        nodes = discRuleFor(narrow);
        return;
    }
    // Precision of the lobes in Lambert's map, weighted by energy: the narrow ones decide.
    Sym2 precision, covariance;
    glm::dvec2 centre(0.0);
    double total = 0.0, share = 0.0;
    for (size_t i = 0; i < count; ++i) {
        const uint32_t m = members[i].lobe;
        Sym2 s{lobes.sxx[m], lobes.sxy[m], lobes.syy[m]};
        const double energy = 1.0 / std::sqrt(s.det());
        // Long lobes: a fit may be shorter than they are, so the lattice is as fine along them as across.
        if (narrow > 1.02 * power)
            s = {1.0 / narrow, 0.0, 1.0 / narrow};
        const Sym2 p = lambertCovariance({lobes.nx[m], lobes.ny[m], lobes.nz[m]}, s).inverse();
        const double w = members[i].share * energy;
        precision = precision + p * w;
        total += w;
        const glm::dvec2 l = lambert(lobes.nx[m], lobes.ny[m], lobes.nz[m]);
        centre += l * double(members[i].share);
        covariance = covariance + Sym2{l.x * l.x, l.x * l.y, l.y * l.y} * members[i].share;
        share += members[i].share;
    }
    precision = precision * (1.0 / total);
    centre /= share;
    covariance = covariance * (1.0 / share) +
                 Sym2{centre.x * centre.x, centre.x * centre.y, centre.y * centre.y} * -1.0;
    // y = K^T (l - centre), precision = K K^T: lobes have unit size. Then turn to the spread's axes.
    const double k11 = std::sqrt(precision.xx), k21 = precision.xy / k11;
    const double k22 = std::sqrt(std::max(precision.yy - k21 * k21, 1e-12));
    const auto whiten = [&](glm::dvec2 d) { return glm::dvec2(k11 * d.x + k21 * d.y, k22 * d.y); };
    const double cxx = k11 * k11 * covariance.xx + 2 * k11 * k21 * covariance.xy + k21 * k21 * covariance.yy;
    const double cxy = k22 * (k11 * covariance.xy + k21 * covariance.yy), cyy = k22 * k22 * covariance.yy;
    const double angle = 0.5 * std::atan2(2.0 * cxy, cxx - cyy);
    const glm::dvec2 axis(std::cos(angle), std::sin(angle)), side(-axis.y, axis.x);
    glm::dvec2 lower(1e30), upper(-1e30);
    discs_.clear();
    for (size_t i = 0; i < count; ++i) {
        const uint32_t m = members[i].lobe;
        const glm::dvec2 y = whiten(glm::dvec2(lambert(lobes.nx[m], lobes.ny[m], lobes.nz[m])) - centre);
        const double wide = 1.0 / lowestPower(lobes, m); // variance along its long side
        const double radius = kMargin * std::clamp(std::sqrt(narrow * wide), 1.0, 8.0);
        const glm::dvec2 t(glm::dot(y, axis), glm::dot(y, side));
        lower = glm::min(lower, t - radius);
        upper = glm::max(upper, t + radius);
        discs_.push_back(glm::vec3(t, radius));
    }
    const glm::dvec2 size = upper - lower;
    const double spacing = std::max(kSpacing, std::sqrt(size.x * size.y / double(kMaxNodes)));
    const int n1 = std::max(1, int(std::ceil(size.x / spacing))),
              n2 = std::max(1, int(std::ceil(size.y / spacing)));
    const glm::dvec2 step = size / glm::dvec2(n1, n2);
    cover(glm::vec2(lower), glm::vec2(step), n1, n2);
    const double area = step.x * step.y / (k11 * k22);
    nodes.clear();
    for (int j = 0; j < n2; ++j)
        for (int i = 0; i < n1; ++i) {
            if (!covered_[size_t(j) * size_t(n1) + size_t(i)])
                continue;
            const glm::dvec2 t = lower + step * glm::dvec2(i + 0.5, j + 0.5);
            const glm::dvec2 y = axis * t.x + side * t.y;
            const double dy = y.y / k22, dx = (y.x - k21 * dy) / k11;
            addNode(centre.x + dx, centre.y + dy, area, nodes);
        }
    nodes.pad();
}

// Marks the lattice points within some member's disc.
void Lattice::cover(glm::vec2 lower, glm::vec2 step, int n1, int n2)
{
    covered_.assign(size_t(n1) * size_t(n2), 0);
    for (const glm::vec3& d : discs_) {
        const int first = std::max(0, int(std::ceil((d.y - d.z - lower.y) / step.y - 0.5f)));
        const int last = std::min(n2 - 1, int(std::floor((d.y + d.z - lower.y) / step.y - 0.5f)));
        for (int j = first; j <= last; ++j) {
            const float dy = lower.y + (float(j) + 0.5f) * step.y - d.y;
            const float half = std::sqrt(std::max(0.0f, d.z * d.z - dy * dy));
            const int from = std::max(0, int(std::ceil((d.x - half - lower.x) / step.x - 0.5f)));
            const int to = std::min(n1 - 1, int(std::floor((d.x + half - lower.x) / step.x - 0.5f)));
            if (from <= to)
                std::fill_n(covered_.begin() + std::ptrdiff_t(j) * n1 + from, to - from + 1, 1);
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
