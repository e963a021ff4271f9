// Area-weighted sums over the lobes under a texel, and the lobes that follow from them in closed form.
#pragma once
#include "bake.h"
#include "source.h"

namespace lumel::baker {

// A lobe's shape: disc coordinates of its normal and covariance in the normal's frame.
struct Shape {
    float nx = 0.0f, ny = 0.0f;
    float sxx = 1.0f, sxy = 0.0f, syy = 1.0f;
};

// Symmetric 2x2 matrix.
struct Sym2 {
    double xx = 0.0, xy = 0.0, yy = 0.0;
    double det() const { return xx * yy - xy * xy; }
    Sym2 inverse() const
    {
        const double d = 1.0 / det();
        return {yy * d, -xy * d, xx * d};
    }
    Sym2 operator+(const Sym2& o) const { return {xx + o.xx, xy + o.xy, yy + o.yy}; }
    Sym2 operator*(double s) const { return {xx * s, xy * s, yy * s}; }
};

// J = [Tu.xy Tv.xy]: lower triangular, takes a step in the normal's tangent plane to the disc.
struct DiscFrame {
    double a, b, c; // J = [a 0; b c]
    explicit DiscFrame(glm::dvec3 n)
    {
        const double r = std::sqrt(1.0 - n.x * n.x);
        a = r;
        b = -n.x * n.y / r;
        c = n.z / r;
    }
    Sym2 toDisc(const Sym2& s) const
    {
        const double p = b * s.xx + c * s.xy, q = b * s.xy + c * s.yy; // second row of J S
        return {a * a * s.xx, a * p, b * p + c * q};
    }
    Sym2 fromDisc(const Sym2& s) const
    {
        const double xx = s.xx / (a * a), xy = (s.xy / a - b * xx) / c;
        return {xx, xy, (s.yy - b * b * xx - 2.0 * b * c * xy) / (c * c)};
    }
};

struct Moments {
    double weight = 0.0; // area in level-0 texels
    glm::dvec3 normal{0.0};
    Sym2 normalNormal;         // N.xy N.xy^T
    Sym2 discCovariance;       // J S J^T
    Sym2 precision;            // P
    double energy = 0.0;       // sqrt(det P): energies of lobes of equal Ks are proportional to it
    double energyNarrow = 0.0; // sum of energy * largest power: how narrow the lobes that matter are
    double maxPower = 0.0;
    glm::dvec3 ks{0.0};
    glm::dvec3 kdNormal[3] = {}; // Kd N for each colour channel

    void add(const Lobes& lobes, size_t i, double area);
    void add(const Moments& other, double factor = 1.0);
    Moments mean() const; // divided by weight
};

// Closed forms; `mean` is Moments::mean().
Shape averageShape(const Moments& mean);
// Toksvig 2005, "Mipmapping Normal Maps": the mean normal's length as a measure of spread.
Shape toksvigShape(const Moments& mean);
// Olano and Baker 2010, "LEAN Mapping": covariance of the normals plus the mean covariance of the lobes.
Shape leanShape(const Moments& mean);

Shape isotropicShape(const Shape& shape); // same normal and sqrt(det S)
Sym2 clampPowers(const Sym2& covariance); // eigenvalues of S^-1 into [kMinPower, kMaxPower]
float scalarPower(const Shape& shape);    // sqrt(det P)
// Do searches from both end in the same place? They differ by less than a thousandth of the lobe's least
// width.
bool isAlike(const Shape& a, const Shape& b);
glm::dvec3 normalOf(const Shape& shape);
// The vector average of Kd N, along a normal.
glm::vec3 diffuseAlong(const glm::dvec3& normal, const Moments& mean);

} // namespace lumel::baker
