#include "ggx_average.h"
#include "shared/limits.h"

namespace lumel::baker {
namespace {

constexpr size_t kPart = GgxNodes::kCount / 3;
const glm::vec3 kLuminance(0.2126f, 0.7152f, 0.0722f);
constexpr float kGoldenAngle = 2.39996323f; // turns of a Fibonacci lattice

// Of k in [0, kPart): each run of a power of two is spread evenly over [0, 1).
float radicalInverse(size_t k)
{
    float value = 0.0f;
    for (float digit = 0.5f; k > 0; k >>= 1, digit *= 0.5f)
        value += digit * float(k & 1);
    return value + 0.5f / kPart;
}

} // namespace

glm::vec3 luminanceOf(const glm::mat3& vectors)
{
    return vectors * kLuminance;
}

float luminanceOf(glm::vec3 colour)
{
    return glm::dot(kLuminance, colour);
}

// Calls use(x, y, area) for the level-0 texels under the texel; areas sum to 1.
template<class Use>
void GgxAverage::forTexels(const Use& use) const
{
    const float whole = float((columns_.end - columns_.begin) * (rows_.end - rows_.begin));
    for (int y = rows_.first; y < rows_.last; ++y)
        for (int x = columns_.first; x < columns_.last; ++x)
            use(x, y, rows_.weight(y) * columns_.weight(x) / whole);
}

GgxMeans GgxAverage::means(int x, int y, int width, int height)
{
    columns_ = Footprint(x, width, base_.width);
    rows_ = Footprint(y, height, base_.height);
    glm::dvec3 f0(0.0), normal(0.0);
    glm::dmat3 diffuse(0.0);
    double strength = 0.0, squared = 0.0, blackSquared = 0.0, rough[2] = {};
    forTexels([&](int i, int j, float area) {
        const GgxTexel& t = base_.at(i, j);
        const double product = double(t.shape.alphaT) * t.shape.alphaB, weight = area * luminanceOf(t.f0);
        f0 += glm::dvec3(t.f0) * double(area);
        for (int c = 0; c < 3; ++c)
            diffuse[c] += glm::dvec3(t.shape.normal) * double(area * t.diffuse[c]);
        normal += glm::dvec3(t.shape.normal) * double(area);
        strength += weight;
        squared += weight * product;
        blackSquared += area * product;
        rough[0] += area * std::sqrt(t.shape.alphaT);
        rough[1] += area * std::sqrt(t.shape.alphaB);
    });
    GgxMeans means;
    means.f0 = f0;
    means.diffuse = diffuse;
    means.isBlack = strength < 1e-12;
    means.strength = means.isBlack ? 1.0f : float(strength);
    means.alphaSquared = float(means.isBlack ? blackSquared : squared / strength);
    const float mean = float(0.5 * (rough[0] + rough[1]));
    means.averaged.normal = glm::normalize(normal);
    means.averaged.tangent =
        glm::normalize(glm::vec3(1.0f, 0.0f, 0.0f) - means.averaged.normal * means.averaged.normal.x);
    means.averaged.alphaT = means.averaged.alphaB = mean * mean;
    return means;
}

// Nodes of the average: from lobes picked in proportion to what they reflect.
void GgxAverage::place(const GgxMeans& means, const GgxShape& broad)
{
    size_t placed = 0;
    float passed = 0.0f;
    const GgxTexel* last = nullptr;
    const auto draw = [&](const GgxTexel& texel) {
        const float u = radicalInverse(placed);
        nodes_.set(placed, ggxHalfVector(texel.shape, u, kGoldenAngle * float(placed)));
        ++placed;
    };
    forTexels([&](int i, int j, float area) {
        const GgxTexel& texel = base_.at(i, j);
        passed += area * (means.isBlack ? 1.0f : luminanceOf(texel.f0)) / means.strength;
        while (placed < kPart && (float(placed) + 0.5f) / kPart < passed)
            draw(texel);
        last = &texel;
    });
    while (placed < kPart) // lost to rounding
        draw(*last);
    for (size_t k = 0; k < kPart; ++k) {
        const float u = (float(k) + 0.5f) / kPart, angle = kGoldenAngle * float(k), r = std::sqrt(u);
        nodes_.set(kPart + k, ggxHalfVector(broad, u, angle));
        nodes_.set(2 * kPart + k, {r * std::cos(angle), r * std::sin(angle), std::sqrt(1.0f - u)});
    }
}

void GgxAverage::sum(const GgxMeans& means, const GgxShape& near)
{
    GgxShape broad = near;
    broad.alphaT = std::min(2.0f * near.alphaT, 1.0f);
    broad.alphaB = std::min(2.0f * near.alphaB, 1.0f);
    place(means, broad);
    GgxNodes::Values average{}, density{}, ignored{};
    forTexels([&](int i, int j, float area) {
        const float weight = means.isBlack ? area : area * luminanceOf(base_.at(i, j).f0);
        nodes_.add(base_.lobeAt(i, j), weight, average, density);
    });
    for (float& value : density)
        value = value / means.strength + 1.0f / shared::kPi;
    nodes_.add(GgxLobe(broad), 1.0f, ignored, density);
    GgxNodes::display(average, luminanceOf(means.diffuse), shown_);
    square_ = 0.0;
    for (size_t i = 0; i < GgxNodes::kCount; ++i) {
        weights_[i] = nodes_.frequency(i) / (kPart * density[i]);
        square_ += double(weights_[i]) * shown_[i] * shown_[i];
    }
}

double GgxAverage::error(const GgxMeans& means, const GgxShape& shape)
{
    const glm::vec3 diffuse = shape.normal * luminanceOf(means.diffuseAlong(shape.normal));
    nodes_.display(GgxLobe(shape), means.strength, diffuse, values_);
    float sum = 0.0f;
    for (size_t i = 0; i < GgxNodes::kCount; ++i) {
        const float difference = shown_[i] - values_[i];
        sum += weights_[i] * difference * difference;
    }
    return square_ > 0.0 ? double(sum) / square_ : 0.0;
}

} // namespace lumel::baker
