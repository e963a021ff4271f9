#include "ggx_lobe.h"
#include "baker/fit_kernel.h"
#include "shared/limits.h"
#include <algorithm>
#include <cmath>

namespace lumel::baker {
namespace {

constexpr float kGoldenAngle = 2.39996323f; // turns of a Fibonacci lattice

// Of k in [0, kPart): each run of a power of two is spread evenly over [0, 1).
float radicalInverse(size_t k)
{
    float value = 0.0f;
    for (float digit = 0.5f; k > 0; k >>= 1, digit *= 0.5f)
        value += digit * float(k & 1);
    return value + 0.5f / GgxNodes::kPart;
}

// One direction a node, in proportion to its cosine: a light may come from anywhere (Roberts 2018, "The
// Unreasonable Effectiveness of Quasirandom Sequences": multiples of powers of the plastic number).
glm::vec3 lightOf(size_t i)
{
    const float u = std::fmod(0.5f + 0.7548777f * float(i), 1.0f);
    const float angle = 2.0f * shared::kPi * std::fmod(0.5f + 0.5698403f * float(i), 1.0f);
    return {std::sqrt(u) * std::cos(angle), std::sqrt(u) * std::sin(angle), std::sqrt(1.0f - u)};
}

void setDraw(GgxDraws& draws, size_t k, const GgxShape& shape)
{
    for (int c = 0; c < 3; ++c) {
        draws.normal[c][k] = shape.normal[c];
        draws.tangent[c][k] = shape.tangent[c];
    }
    draws.alphaT[k] = shape.alphaT;
    draws.alphaB[k] = shape.alphaB;
}

} // namespace

const GgxKernels& ggxKernels()
{
    switch (kernels().lanes) {
    case 1:
        return kGgxScalar;
#ifdef LUMEL_X86_KERNELS
    case 8:
        return kGgxAvx2;
    case 16:
        return kGgxAvx512;
#endif
    default:
        return kGgxBaseline;
    }
}

GgxTerm ggxTerm(const GgxShape& shape, float strength)
{
    const glm::vec3 n = shape.normal, t = shape.tangent, b = glm::cross(n, t);
    const float pt = 1.0f / (shape.alphaT * shape.alphaT), pb = 1.0f / (shape.alphaB * shape.alphaB);
    const auto entry = [&](int i, int j) { return n[i] * n[j] + pt * t[i] * t[j] + pb * b[i] * b[j]; };
    return {
        {entry(0, 0), entry(1, 1), entry(2, 2), 2.0f * entry(0, 1), 2.0f * entry(0, 2), 2.0f * entry(1, 2)},
        {n.x, n.y, n.z},
        strength / (shared::kPi * shape.alphaT * shape.alphaB)};
}

// Uniform numbers u give half vectors in proportion to D(h) (n.h): slope^2 = alpha^2 u / (1 - u).
GgxNodes::GgxNodes()
{
    for (size_t k = 0; k < kPart; ++k) {
        const float even = (float(k) + 0.5f) / kPart, angle = kGoldenAngle * float(k);
        const float cosine = std::cos(angle), sine = std::sin(angle);
        for (const size_t at : {k, kPart + k}) {
            const float u = at < kPart ? radicalInverse(k) : even, slope = std::sqrt(u / (1.0f - u));
            draws_.slopeT[at] = slope * cosine;
            draws_.slopeB[at] = slope * sine;
        }
        const size_t i = 2 * kPart + k;
        const float r = std::sqrt(even);
        const glm::vec3 h{r * cosine, r * sine, std::sqrt(1.0f - even)};
        const float products[] = {h.x * h.x, h.y * h.y, h.z * h.z, h.x * h.y, h.x * h.z, h.y * h.z};
        for (size_t p = 0; p < 6; ++p)
            arrays_.products[p][i] = products[p];
        for (int c = 0; c < 3; ++c)
            arrays_.h[c][i] = h[c];
        arrays_.inverseZ[i] = 1.0f / h.z;
    }
    for (size_t i = 0; i < kCount; ++i)
        for (int c = 0; c < 3; ++c)
            arrays_.light[c][i] = lightOf(i)[c];
}

void GgxNodes::place(const Lobes& lobes, const GgxShape& broad)
{
    for (size_t k = 0; k < kPart; ++k) {
        setDraw(draws_, k, *lobes[k]);
        setDraw(draws_, kPart + k, broad);
    }
    ggxKernels().place(draws_, arrays_);
}

void GgxNodes::add(std::span<const GgxTerm> terms, Values& values, Values& densities) const
{
    constexpr size_t kChunk = 512; // terms that stay in the nearest cache
    for (size_t i = 0; i < terms.size(); i += kChunk)
        ggxKernels().add(arrays_, &terms[i], int(std::min(kChunk, terms.size() - i)), values.data(),
                         densities.data());
}

void GgxNodes::display(const Values& specular, glm::vec3 diffuse, Values& shown) const
{
    ggxKernels().display(arrays_, specular.data(), &diffuse.x, shown.data());
}

double GgxNodes::weigh(const Values& densities, const Values& shown, Values& weights) const
{
    return ggxKernels().weigh(arrays_, densities.data(), shown.data(), weights.data());
}

double GgxNodes::error(const GgxTerm& lobe, glm::vec3 diffuse, const Values& shown,
                       const Values& weights) const
{
    return ggxKernels().error(arrays_, lobe, &diffuse.x, shown.data(), weights.data());
}

} // namespace lumel::baker
