#include "moments.h"
#include "normals.h"
#include "shared/lobe.h"

namespace lumel::baker {

void Moments::add(const Lobes& lobes, size_t i, double area)
{
    const glm::dvec3 n(lobes.nx[i], lobes.ny[i], lobes.nz[i]);
    const Sym2 s{lobes.sxx[i], lobes.sxy[i], lobes.syy[i]};
    const Sym2 outer{n.x * n.x, n.x * n.y, n.y * n.y};
    weight += area;
    normal += area * n;
    normalNormal = normalNormal + outer * area;
    double power = 1.0 / s.xx, largest = power; // power = sqrt(det P)
    if (s.xy == 0.0 && s.xx == s.yy) {
        // J J^T = I - N.xy N.xy^T
        discCovariance = discCovariance + (Sym2{1.0, 0.0, 1.0} + outer * -1.0) * (s.xx * area);
        precision = precision + Sym2{power, 0.0, power} * area;
    } else {
        const Sym2 p = s.inverse();
        const double half = 0.5 * (p.xx - p.yy);
        power = std::sqrt(p.det());
        largest = 0.5 * (p.xx + p.yy) + std::sqrt(half * half + p.xy * p.xy);
        discCovariance = discCovariance + DiscFrame(n).toDisc(s) * area;
        precision = precision + p * area;
    }
    energy += area * power;
    maxPower = std::max(maxPower, largest);
    energyNarrow += area * power * largest;
    for (int c = 0; c < 3; ++c) {
        ks[c] += area * lobes.ks[c][i];
        kdNormal[c] += area * double(lobes.kd[c][i]) * n;
    }
}

void Moments::add(const Moments& o, double factor)
{
    weight += factor * o.weight;
    normal += factor * o.normal;
    normalNormal = normalNormal + o.normalNormal * factor;
    discCovariance = discCovariance + o.discCovariance * factor;
    precision = precision + o.precision * factor;
    energy += factor * o.energy;
    energyNarrow += factor * o.energyNarrow;
    maxPower = std::max(maxPower, o.maxPower);
    ks += factor * o.ks;
    for (int c = 0; c < 3; ++c)
        kdNormal[c] += factor * o.kdNormal[c];
}

Moments Moments::mean() const
{
    Moments m = *this;
    const double f = 1.0 / weight;
    m.normal *= f;
    m.normalNormal = m.normalNormal * f;
    m.discCovariance = m.discCovariance * f;
    m.precision = m.precision * f;
    m.energy *= f;
    m.energyNarrow *= f;
    m.ks *= f;
    for (auto& v : m.kdNormal)
        v *= f;
    return m;
}

Sym2 clampPowers(const Sym2& s)
{
    const double mean = 0.5 * (s.xx + s.yy), half = 0.5 * (s.xx - s.yy);
    const double radius = std::sqrt(half * half + s.xy * s.xy);
    const double lowest = 1.0 / double(shared::kMaxPower), highest = 1.0 / double(shared::kMinPower);
    const double big = std::clamp(mean + radius, lowest, highest);
    const double small = std::clamp(mean - radius, lowest, highest);
    if (radius < 1e-12 * mean)
        return {big, 0.0, big};
    const double newMean = 0.5 * (big + small), scale = 0.5 * (big - small) / radius;
    return {newMean + half * scale, s.xy * scale, newMean - half * scale};
}

namespace {

Shape shapeOf(glm::dvec3 meanNormal, const Sym2& covariance)
{
    const glm::vec3 n = aboveHorizon(glm::vec3(meanNormal));
    const Sym2 s = clampPowers(covariance);
    return {n.x, n.y, float(s.xx), float(s.xy), float(s.yy)};
}

} // namespace

Shape averageShape(const Moments& mean)
{
    return shapeOf(mean.normal, mean.precision.inverse());
}

Shape toksvigShape(const Moments& mean)
{
    // p' = p |N| / (|N| + p (1 - |N|)), the same as 1/p' = 1/p + (1 - |N|) / |N|.
    const double length = std::min(1.0, glm::length(mean.normal));
    const double spread = (1.0 - length) / std::max(length, 1e-6);
    return shapeOf(mean.normal, mean.precision.inverse() + Sym2{spread, 0.0, spread});
}

Shape leanShape(const Moments& mean)
{
    const glm::dvec3 m = mean.normal;
    const Sym2 covariance = mean.normalNormal + Sym2{m.x * m.x, m.x * m.y, m.y * m.y} * -1.0;
    // The disc keeps |N.xy| < 1: lift the mean of the disc coordinates to the unit normal above it.
    const glm::vec3 n = shared::lobeNormal(glm::vec2(m));
    const Sym2 s = clampPowers(DiscFrame(glm::dvec3(n)).fromDisc(covariance + mean.discCovariance));
    return {n.x, n.y, float(s.xx), float(s.xy), float(s.yy)};
}

Shape isotropicShape(const Shape& shape)
{
    const float s = std::sqrt(std::max(shape.sxx * shape.syy - shape.sxy * shape.sxy, 1e-8f));
    return {shape.nx, shape.ny, s, 0.0f, s};
}

bool isAlike(const Shape& a, const Shape& b)
{
    constexpr float kAlike = 1e-3f;
    const float least = (a.sxx * a.syy - a.sxy * a.sxy) / (a.sxx + a.syy); // at most the smaller eigenvalue
    const float dx = a.nx - b.nx, dy = a.ny - b.ny, most = kAlike * least;
    return dx * dx + dy * dy <= kAlike * most && std::abs(a.sxx - b.sxx) <= most &&
           std::abs(a.sxy - b.sxy) <= most && std::abs(a.syy - b.syy) <= most;
}

float scalarPower(const Shape& shape)
{
    return 1.0f / std::sqrt(std::max(shape.sxx * shape.syy - shape.sxy * shape.sxy, 1e-8f));
}

glm::dvec3 normalOf(const Shape& shape)
{
    const double nx = shape.nx, ny = shape.ny;
    return {nx, ny, std::sqrt(std::max(0.0, 1.0 - nx * nx - ny * ny))};
}

glm::vec3 diffuseAlong(const glm::dvec3& normal, const Moments& mean)
{
    glm::vec3 kd;
    for (int c = 0; c < 3; ++c)
        kd[c] = float(std::max(0.0, glm::dot(mean.kdNormal[c], normal)));
    return kd;
}

} // namespace lumel::baker
