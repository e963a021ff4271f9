#include "ggx_lobe.h"
#include "shared/limits.h"
#include <cmath>

namespace lumel::baker {

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

void GgxNodes::evaluate(const GgxLobe& lobe, Values& values) const
{
    for (size_t i = 0; i < kCount; ++i)
        values[i] = at(lobe, i).value;
}

} // namespace lumel::baker
