#include "ggx_lobe.h"
#include "shared/limits.h"
#include <cmath>

namespace lumel::baker {
namespace {

// Radiance is about this times F0 D: 1 / (4 n.v) of a view that is not grazing, under a light of
// irradiance 1.
constexpr float kSpecularShare = 0.3f;

// One direction a node, in proportion to its cosine: a light may come from anywhere (Roberts 2018, "The
// Unreasonable Effectiveness of Quasirandom Sequences": multiples of powers of the plastic number).
struct Lights {
    alignas(64) GgxNodes::Values x, y, z;
    Lights()
    {
        for (size_t i = 0; i < GgxNodes::kCount; ++i) {
            const float u = std::fmod(0.5f + 0.7548777f * float(i), 1.0f);
            const float angle = 2.0f * shared::kPi * std::fmod(0.5f + 0.5698403f * float(i), 1.0f);
            x[i] = std::sqrt(u) * std::cos(angle);
            y[i] = std::sqrt(u) * std::sin(angle);
            z[i] = std::sqrt(1.0f - u);
        }
    }
};

// Like tone mapping and the sRGB curve: near a square root, and ever less of a difference above white.
inline float shownOf(float radiance)
{
    return std::sqrt(radiance / (1.0f + radiance));
}

} // namespace

GgxLobe::GgxLobe(const GgxShape& shape) : normal(shape.normal)
{
    const glm::vec3 n = shape.normal, t = shape.tangent, b = glm::cross(n, t);
    const float pt = 1.0f / (shape.alphaT * shape.alphaT), pb = 1.0f / (shape.alphaB * shape.alphaB);
    const auto entry = [&](int i, int j) { return n[i] * n[j] + pt * t[i] * t[j] + pb * b[i] * b[j]; };
    form = {entry(0, 0),        entry(1, 1),        entry(2, 2),
            2.0f * entry(0, 1), 2.0f * entry(0, 2), 2.0f * entry(1, 2)};
    scale = 1.0f / (shared::kPi * shape.alphaT * shape.alphaB);
}

glm::vec3 ggxHalfVector(const GgxShape& shape, float u, float angle)
{
    const float slope = std::sqrt(u / (1.0f - u));
    const glm::vec3 b = glm::cross(shape.normal, shape.tangent);
    return glm::normalize(shape.normal + shape.tangent * (shape.alphaT * slope * std::cos(angle)) +
                          b * (shape.alphaB * slope * std::sin(angle)));
}

void GgxNodes::set(size_t i, glm::vec3 h)
{
    const float products[] = {h.x * h.x, h.y * h.y, h.z * h.z, h.x * h.y, h.x * h.z, h.y * h.z};
    for (size_t p = 0; p < 6; ++p)
        products_[p][i] = products[p];
    x_[i] = h.x;
    y_[i] = h.y;
    z_[i] = h.z;
    inverseZ_[i] = 1.0f / std::max(h.z, 1e-3f);
}

// Of the lobe at node i: its density by half vector, 0 below the horizon, and the cosine to its normal.
inline GgxNodes::AtNode GgxNodes::at(const GgxLobe& lobe, size_t i) const
{
    const auto& f = lobe.form;
    const auto& p = products_;
    const float q =
        f[0] * p[0][i] + f[1] * p[1][i] + f[2] * p[2][i] + f[3] * p[3][i] + f[4] * p[4][i] + f[5] * p[5][i];
    const float cosine = lobe.normal.x * x_[i] + lobe.normal.y * y_[i] + lobe.normal.z * z_[i];
    return {cosine > 0.0f ? lobe.scale / (q * q) : 0.0f, std::max(cosine, 0.0f)};
}

void GgxNodes::add(const GgxLobe& lobe, float weight, Values& values, Values& densities) const
{
    for (size_t i = 0; i < kCount; ++i) {
        const AtNode node = at(lobe, i);
        values[i] += weight * node.value;
        densities[i] += weight * node.value * node.cosine * inverseZ_[i];
    }
}

void GgxNodes::display(const Values& specular, glm::vec3 diffuse, Values& shown)
{
    static const Lights lights;
    diffuse /= shared::kPi;
    for (size_t i = 0; i < kCount; ++i) {
        const float d = diffuse.x * lights.x[i] + diffuse.y * lights.y[i] + diffuse.z * lights.z[i];
        shown[i] = shownOf(kSpecularShare * specular[i] + std::max(d, 0.0f));
    }
}

void GgxNodes::display(const GgxLobe& lobe, float strength, glm::vec3 diffuse, Values& shown) const
{
    Values specular;
    for (size_t i = 0; i < kCount; ++i)
        specular[i] = strength * at(lobe, i).value;
    display(specular, diffuse, shown);
}

void GgxNodes::evaluate(const GgxLobe& lobe, Values& values) const
{
    for (size_t i = 0; i < kCount; ++i)
        values[i] = at(lobe, i).value;
}

} // namespace lumel::baker
