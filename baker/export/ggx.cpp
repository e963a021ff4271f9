#include "ggx.h"
#include "baker/footprint.h"
#include "baker/moments.h"
#include "ggx_average.h"
#include "shared/energy.h"
#include "shared/lobe.h"
#include <mutex>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace lumel::baker {
namespace {

// Averaged maps with less error are kept: all lobes are alike.
constexpr double kAlike = 1e-6;
// A roughness of 0.045, below which half floats and many engines give up (Filament).
constexpr float kSharpest = 0.002f;
// Cosine between normals that 8 bits hardly tell apart.
constexpr float kSameNormal = 0.99999f;

// Axes of a covariance in the frame of its normal: deviation along and across, and the tangent along.
struct Axes {
    float along, across; // variances
    glm::vec3 tangent;
};

Axes axesOf(glm::vec3 normal, glm::vec3 covariance)
{
    const glm::vec2 variances = shared::lobeVariances(covariance);
    const float angle = 0.5f * std::atan2(2.0f * covariance.y, covariance.x - covariance.z);
    const glm::vec3 u = shared::lobeTangentU(normal), v = glm::cross(normal, u);
    return {variances.x, variances.y, u * std::cos(angle) + v * std::sin(angle)};
}

// A texel's lobe; of two, the one with their moments, weighted by what they reflect, then both.
std::vector<Shape> bakedShapes(const Level& level, int x, int y)
{
    const float* t = level.at(x, y);
    const Shape first{t[kNx], t[kNy], t[kSxx], t[kSxy], t[kSyy]};
    const float* s = level.second.empty() ? nullptr : level.secondAt(x, y);
    const float other = s ? luminanceOf({s[kKs2R], s[kKs2G], s[kKs2B]}) : 0.0f;
    if (other <= 0.0f)
        return {first};
    const float own = luminanceOf({t[kKsR], t[kKsG], t[kKsB]}), w = other / (own + other);
    const Shape second{s[kN2x], s[kN2y], s[kS2xx], s[kS2xy], s[kS2yy]};
    const auto onDisc = [](const Shape& shape) {
        return DiscFrame(normalOf(shape)).toDisc({shape.sxx, shape.sxy, shape.syy});
    };
    const double dx = second.nx - first.nx, dy = second.ny - first.ny, spread = double(w) * (1.0 - w);
    const Sym2 covariance =
        onDisc(first) * (1.0 - w) + onDisc(second) * double(w) + Sym2{dx * dx, dx * dy, dy * dy} * spread;
    Shape both{first.nx + w * float(dx), first.ny + w * float(dy), 1.0f, 0.0f, 1.0f};
    const Sym2 own2 = clampPowers(DiscFrame(normalOf(both)).fromDisc(covariance));
    both.sxx = float(own2.xx);
    both.sxy = float(own2.xy);
    both.syy = float(own2.yy);
    return {both, first, second};
}

// The lobe at level 0, as it is.
GgxTexel baseTexel(const float* t)
{
    const glm::vec3 covariance(t[kSxx], t[kSxy], t[kSyy]);
    GgxTexel texel;
    texel.shape.normal = shared::lobeNormal({t[kNx], t[kNy]});
    const Axes axes = axesOf(texel.shape.normal, covariance);
    texel.shape.tangent = axes.tangent;
    texel.shape.alphaT = alphaOfVariance(axes.along);
    texel.shape.alphaB = alphaOfVariance(axes.across);
    texel.f0 = shared::reflectanceOf({t[kKsR], t[kKsG], t[kKsB]}, covariance);
    texel.diffuse = {t[kKdR], t[kKdG], t[kKdB]};
    return texel;
}

bool isIsotropic(const GgxShape& shape)
{
    return shape.alphaT < 1.002f * shape.alphaB; // halves round
}

// Beyond the limits of powers, the roughness is that of the source.
void unclamp(GgxTexel& texel, const Image& roughness, glm::vec2 at)
{
    const int x = std::min(int(at.x * float(roughness.width)), roughness.width - 1);
    const int y = std::min(int(at.y * float(roughness.height)), roughness.height - 1);
    const float alpha = std::pow(*roughness.at(x, y), 2.0f), own = texel.shape.alphaT;
    const bool isLimit = own < 1.01f * alphaOfVariance(1.0f / shared::kMaxPower) ||
                         own > 0.99f * alphaOfVariance(1.0f / shared::kMinPower);
    if (isIsotropic(texel.shape) && isLimit)
        texel.shape.alphaT = texel.shape.alphaB = std::clamp(alpha, kSharpest, 1.0f);
}

GgxBase baseOf(const Level& level, const Image* roughness)
{
    GgxBase base{level.width, level.height, {}, {}, true};
    const size_t count = size_t(level.width) * size_t(level.height);
    base.texels.resize(count);
    base.lobes.resize(count);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 4096), [&](const auto& range) {
        for (size_t i = range.begin(); i < range.end(); ++i) {
            base.texels[i] = baseTexel(&level.texels[i * kChannels]);
            if (roughness)
                unclamp(base.texels[i], *roughness,
                        {(float(i % size_t(level.width)) + 0.5f) / float(level.width),
                         (float(i / size_t(level.width)) + 0.5f) / float(level.height)});
            base.lobes[i] = ggxTerm(base.texels[i].shape);
        }
    });
    base.isIsotropic = std::ranges::all_of(base.texels, [](const auto& t) { return isIsotropic(t.shape); });
    return base;
}

// Least of a function of a factor in [1/4, 4]: three points around it, then two parabolas, in its logarithm.
template<class Error>
float bestFactor(const Error& error)
{
    const auto at = [&](float x) { return error(std::exp(x)); };
    float step = 0.46f, x = 0.0f, e = at(x), low = at(-step), high = at(step);
    const auto shift = [&](float direction, float& ahead, float& behind) {
        while (ahead < e && std::abs(x) < 3.0f * step) {
            x += direction * step;
            behind = std::exchange(e, ahead);
            ahead = at(x + direction * step);
        }
    };
    shift(1.0f, high, low);
    shift(-1.0f, low, high);
    for (int i = 0; i < 2; ++i) {
        const float curvature = low - 2.0f * e + high;
        if (curvature <= 0.0f)
            break;
        const float vertex = x + step * std::clamp(0.5f * (low - high) / curvature, -1.0f, 1.0f);
        const float there = at(vertex);
        if (there >= e)
            break;
        x = vertex;
        e = there;
        if (i == 0) {
            step *= 0.25f;
            low = at(x - step);
            high = at(x + step);
        }
    }
    return std::exp(x);
}

float clampAlpha(float alpha)
{
    return std::clamp(alpha, kSharpest, 1.0f);
}

GgxShape stretched(const GgxShape& shape, float along, float across)
{
    GgxShape result = shape;
    result.alphaT = clampAlpha(shape.alphaT * along);
    result.alphaB = clampAlpha(shape.alphaB * across);
    return result;
}

class LevelFit {
public:
    LevelFit(const GgxBase& base, const Level& level, const GgxOptions& options)
        : average_(base), level_(level), options_(options)
    {
    }

    struct Errors {
        float own = 0.0f, converted = 0.0f, averaged = 0.0f;
    };

    GgxTexel texel(int x, int y, Errors& errors)
    {
        const GgxMeans means = average_.means(x, y, level_.width, level_.height);
        const std::vector<Shape> baked = bakedShapes(level_, x, y);
        GgxTexel result;
        result.f0 = means.f0;
        result.shape = start(means, baked.front());
        average_.sum(means, result.shape);
        const auto error = [&](const GgxShape& shape) { return average_.error(means, shape); };
        const double averaged = error(means.averaged);
        GgxShape converted = result.shape; // of the baked normal
        converted.alphaT = converted.alphaB = std::sqrt(2.0f / (scalarPower(baked.front()) + 2.0f));
        errors = {float(averaged), float(error(converted)), float(averaged)};
        if (averaged < kAlike)
            result.shape = means.averaged;
        else
            errors.own = float(search(error, means, std::span(baked).subspan(1), result.shape));
        result.diffuse = means.diffuseAlong(result.shape.normal);
        return result;
    }

private:
    // What the normals spread adds to the mean square of alpha: twice the variance of their slopes
    // (Beckmann's alpha; Filament adds it likewise to mean roughness).
    GgxShape start(const GgxMeans& means, const Shape& baked) const
    {
        GgxShape shape;
        shape.normal = glm::vec3(normalOf(baked));
        const Axes axes = axesOf(shape.normal, {baked.sxx, baked.sxy, baked.syy});
        shape.tangent = axes.tangent;
        const auto alpha = [&](float variance) {
            const float own = alphaOfVariance(variance);
            return clampAlpha(std::sqrt(0.5f * (own * own + std::max(means.alphaSquared, own * own))));
        };
        if (options_.anisotropic) {
            shape.alphaT = alpha(axes.along);
            shape.alphaB = alphaOfVariance(axes.across);
        } else {
            shape.alphaT = shape.alphaB = alpha(std::sqrt(axes.along * axes.across));
        }
        return shape;
    }

    // Along the baked normal, along the mean one and along those of two lobes: one GGX lobe may do best at
    // the peak of the stronger. Returns the error.
    template<class Error>
    double search(const Error& error, const GgxMeans& means, std::span<const Shape> lobes,
                  GgxShape& shape) const
    {
        scale(error, shape);
        GgxShape other = shape;
        other.normal = means.averaged.normal;
        other.tangent = glm::normalize(shape.tangent - other.normal * glm::dot(other.normal, shape.tangent));
        double least = error(shape);
        const auto take = [&](const GgxShape& candidate) {
            if (const double e = error(candidate); e < least) {
                least = e;
                shape = candidate;
            }
        };
        if (glm::dot(other.normal, shape.normal) < kSameNormal) {
            scale(error, other);
            take(other);
        }
        for (const Shape& lobe : lobes) {
            GgxShape own = start(means, lobe);
            scale(error, own);
            take(own);
        }
        take(means.averaged);
        return least;
    }

    template<class Error>
    void scale(const Error& error, GgxShape& shape) const
    {
        const auto both = [&](float f) { return float(error(stretched(shape, f, f))); };
        float f = bestFactor(both);
        shape = stretched(shape, f, f);
        if (!options_.anisotropic)
            return;
        const auto ratio = [&](float r) { return float(error(stretched(shape, r, 1.0f / r))); };
        const float r = bestFactor(ratio);
        shape = stretched(shape, r, 1.0f / r);
        f = bestFactor(both);
        shape = stretched(shape, f, f);
        if (shape.alphaT < shape.alphaB) {
            std::swap(shape.alphaT, shape.alphaB);
            shape.tangent = glm::cross(shape.normal, shape.tangent);
        }
    }

    GgxAverage average_;
    const Level& level_;
    const GgxOptions& options_;
};

// Level 0, where engines can have its lobes as they are.
GgxLevel plainLevel(const GgxBase& base)
{
    return {base.width, base.height, base.texels, {}};
}

GgxLevel fittedLevel(const GgxBase& base, const Level& level, const GgxOptions& options, Progress* progress)
{
    GgxLevel result{level.width, level.height, {}, {}};
    const size_t count = size_t(level.width) * size_t(level.height);
    const size_t units = size_t(base.width) * size_t(base.height); // of the whole level
    result.texels.resize(count);
    std::vector<LevelFit::Errors> errors(count);
    tbb::enumerable_thread_specific<LevelFit> fits([&] { return LevelFit(base, level, options); });
    std::atomic<size_t> done = 0;
    const size_t grain = std::clamp<size_t>(count / 64, 1, 1024);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, count, grain), [&](const auto& range) {
        checkInterrupted();
        LevelFit& fit = fits.local();
        for (size_t i = range.begin(); i < range.end(); ++i)
            result.texels[i] =
                fit.texel(int(i % size_t(level.width)), int(i / size_t(level.width)), errors[i]);
        const size_t before = done.fetch_add(range.size());
        if (progress)
            progress->advance((before + range.size()) * units / count - before * units / count);
    });
    for (const auto& e : errors) { // in this order whatever the threads
        result.errors.mean += double(e.own) / double(count);
        result.errors.converted += double(e.converted) / double(count);
        result.errors.averaged += double(e.averaged) / double(count);
        result.errors.worst = std::max(result.errors.worst, double(e.own));
    }
    return result;
}

} // namespace

float alphaOfVariance(float variance)
{
    // powerFromRoughness() solved for alpha.
    const float power = 1.0f / std::max(variance, 1e-5f), q = shared::kComparedEnergy;
    const float tangent2 = std::expm1(-2.0f * std::log(1.0f - q) / (power + 2.0f));
    return std::sqrt(tangent2 * (1.0f - q) / q);
}

size_t ggxUnits(const ReflectanceMips& mips)
{
    return mips.levels.size() * size_t(mips.levels.front().width) * size_t(mips.levels.front().height);
}

std::vector<GgxLevel> fitGgx(const ReflectanceMips& mips, const GgxOptions& options, Progress* progress)
{
    std::vector<GgxLevel> levels;
    tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
    arena.execute([&] {
        const GgxBase base = baseOf(mips.levels.front(), options.roughness);
        for (const Level& level : mips.levels) {
            const bool isPlain = levels.empty() && (options.anisotropic || base.isIsotropic);
            levels.push_back(isPlain ? plainLevel(base) : fittedLevel(base, level, options, progress));
            if (isPlain && progress)
                progress->advance(base.texels.size());
        }
    });
    return levels;
}

} // namespace lumel::baker
