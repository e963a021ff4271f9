#include "ggx_average.h"
#include "shared/limits.h"

namespace lumel::baker {
namespace {

constexpr size_t kPart = GgxNodes::kPart;
const glm::vec3 kLuminance(0.2126f, 0.7152f, 0.0722f);
// Level-0 lobes that a texel's average is the sum of, so that its time is bounded; of more, one in each of so
// many cells. With 1024, E of BoomBox's level 7 rises by a third, with 65536 it changes less than with other
// nodes.
constexpr int kMostLobes = 1 << 16;

// Any number of a cell: the same one in each export.
uint32_t scrambled(uint32_t x, uint32_t y)
{
    uint32_t h = x * 0x9e3779b1u ^ (y * 0x85ebca77u + 0xc2b2ae3du);
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    return h ^ (h >> 15);
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

// The same with one texel of each cell and the cell's area: stratified, so that what repeats is not missed.
template<class Use>
void GgxAverage::forSomeTexels(const Use& use) const
{
    const int width = columns_.last - columns_.first, height = rows_.last - rows_.first;
    int side = 1;
    while ((width / side) * (height / side) > kMostLobes)
        ++side;
    if (side == 1)
        return forTexels(use);
    const float whole = float((columns_.end - columns_.begin) * (rows_.end - rows_.begin));
    for (int y = rows_.first; y < rows_.last; y += side)
        for (int x = columns_.first; x < columns_.last; x += side) {
            const int w = std::min(side, columns_.last - x), h = std::min(side, rows_.last - y);
            const uint32_t any = scrambled(uint32_t(x), uint32_t(y));
            use(x + int((any & 0xffffu) % uint32_t(w)), y + int((any >> 16) % uint32_t(h)),
                float(w * h) / whole);
        }
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

// The lobes of the average.
void GgxAverage::collect(const GgxMeans& means)
{
    terms_.clear();
    shapes_.clear();
    strengths_.clear();
    float all = 0.0f;
    forSomeTexels([&](int x, int y, float area) {
        const GgxTexel& texel = base_.at(x, y);
        const float strength = means.isBlack ? area : area * luminanceOf(texel.f0);
        terms_.push_back(base_.lobeAt(x, y));
        shapes_.push_back(&texel.shape);
        strengths_.push_back(strength);
        all += strength;
    });
    // What was left out does not change what is reflected in all.
    const size_t texels = size_t(columns_.last - columns_.first) * size_t(rows_.last - rows_.first);
    const float scale = terms_.size() < texels && all > 0.0f ? means.strength / all : 1.0f;
    for (size_t i = 0; i < terms_.size(); ++i) {
        strengths_[i] *= scale;
        terms_[i].scale *= strengths_[i];
    }
}

// In proportion to what they reflect.
GgxNodes::Lobes GgxAverage::pick(const GgxMeans& means) const
{
    GgxNodes::Lobes lobes;
    size_t picked = 0;
    float passed = 0.0f;
    for (size_t i = 0; i < shapes_.size(); ++i) {
        passed += strengths_[i] / means.strength;
        while (picked < kPart && (float(picked) + 0.5f) / kPart < passed)
            lobes[picked++] = shapes_[i];
    }
    while (picked < kPart) // lost to rounding
        lobes[picked++] = shapes_.back();
    return lobes;
}

void GgxAverage::sum(const GgxMeans& means, const GgxShape& near)
{
    GgxShape broad = near;
    broad.alphaT = std::min(2.0f * near.alphaT, 1.0f);
    broad.alphaB = std::min(2.0f * near.alphaB, 1.0f);
    collect(means);
    nodes_.place(pick(means), broad);
    GgxNodes::Values average{}, density{}, ignored{};
    nodes_.add(terms_, average, density);
    for (float& value : density)
        value = value / means.strength + 1.0f / shared::kPi;
    const GgxTerm term = ggxTerm(broad);
    nodes_.add({&term, 1}, ignored, density);
    for (float& value : density)
        value *= kPart;
    nodes_.display(average, luminanceOf(means.diffuse), shown_);
    square_ = nodes_.weigh(density, shown_, weights_);
}

double GgxAverage::error(const GgxMeans& means, const GgxShape& shape) const
{
    const glm::vec3 diffuse = shape.normal * luminanceOf(means.diffuseAlong(shape.normal));
    const double sum = nodes_.error(ggxTerm(shape, means.strength), diffuse, shown_, weights_);
    return square_ > 0.0 ? sum / square_ : 0.0;
}

} // namespace lumel::baker
