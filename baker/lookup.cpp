#include "lookup.h"
#include "averager.h"
#include "footprint.h"
#include "normals.h"
#include "shared/lobe.h"
#include "solver.h"
#include <random>

namespace lumel::baker {
namespace {

struct Blended {
    Shape shape;
    double ks = 0.0; // luminance
};

// Moments of lobes on the disc, weighted by what they reflect: Ks, Ks mu, Ks (S + mu mu^T).
class BlendedMoments {
public:
    // First or second lobe of a texel: both begin alike.
    void add(const float* t, double share)
    {
        const double ks = share * luminance({t[kKsR], t[kKsG], t[kKsB]});
        const glm::dvec3 n(shared::lobeNormal(glm::vec2(t[kNx], t[kNy])));
        ks_ += ks;
        x_ += ks * n.x;
        y_ += ks * n.y;
        second_ =
            second_ +
            (DiscFrame(n).toDisc({t[kSxx], t[kSxy], t[kSyy]}) + Sym2{n.x * n.x, n.x * n.y, n.y * n.y}) * ks;
    }
    Blended lobe() const
    {
        if (ks_ <= 0.0)
            return {};
        const double x = x_ / ks_, y = y_ / ks_;
        const glm::vec3 n = shared::lobeNormal(glm::vec2(float(x), float(y)));
        const Sym2 disc = second_ * (1.0 / ks_) + Sym2{x * x, x * y, y * y} * -1.0;
        const Sym2 s = clampPowers(DiscFrame(glm::dvec3(n)).fromDisc(disc));
        return {{n.x, n.y, float(s.xx), float(s.xy), float(s.yy)}, ks_};
    }

private:
    double ks_ = 0.0, x_ = 0.0, y_ = 0.0;
    Sym2 second_;
};

// Both lobes of the four texels around (u, v), in texels.
std::array<Blended, 2> blend(const Level& level, Wrap wrap, double u, double v)
{
    const int i = int(std::floor(u - 0.5)), j = int(std::floor(v - 0.5));
    const double a = u - 0.5 - i, b = v - 0.5 - j;
    BlendedMoments moments[2];
    for (int k = 0; k < 4; ++k) {
        const int x = wrapped(i + k % 2, level.width, wrap), y = wrapped(j + k / 2, level.height, wrap);
        const double share = (k % 2 ? a : 1.0 - a) * (k / 2 ? b : 1.0 - b);
        moments[0].add(level.at(x, y), share);
        if (!level.second.empty())
            moments[1].add(level.secondAt(x, y), share);
    }
    return {moments[0].lobe(), moments[1].lobe()};
}

class GroundTruth {
public:
    explicit GroundTruth(const Maps& maps) : maps_(maps), source_(maps), averager_(source_) {}

    // Averages the box of level-0 texels; false where there is no reflectance.
    bool gather(const Footprint& fx, const Footprint& fy)
    {
        const int width = fx.last - fx.first;
        lobes_.resize(size_t(width) * size_t(fy.last - fy.first));
        members_.clear();
        for (int j = fy.first; j < fy.last; ++j)
            for (int i = fx.first; i < fx.last; ++i) {
                const size_t at = size_t(j - fy.first) * size_t(width) + size_t(i - fx.first);
                const int x = wrapped(i, source_.width(), maps_.wrap);
                source_.read(wrapped(j, source_.height(), maps_.wrap), x, x + 1, lobes_, at);
                members_.push_back({uint32_t(at), fx.weight(i) * fy.weight(j)});
            }
        averager_.gather(lobes_, members_, nullptr, false, cell_);
        if (cell_.uniform)
            averager_.average(lobes_, members_, nullptr, false, cell_);
        nodes_.clear();
        for (auto& channel : g_)
            channel.clear();
        cell_.patch.appendTo(nodes_, g_, float(1.0 / cell_.sum.weight), averager_.channels());
        for (size_t k = 0; averager_.channels() == 3 && k < nodes_.size(); ++k)
            g_[0][k] = float(luminance({g_[0][k], g_[1][k], g_[2][k]}));
        return luminance(cell_.sum.ks) > 0.0;
    }

    double error(const std::array<Blended, 2>& lobes)
    {
        const std::vector<float>& g = g_[0];
        std::vector<float> weight(nodes_.size());
        double energy = 0.0;
        for (size_t k = 0; k < nodes_.size(); ++k) {
            weight[k] = nodes_.area[k] * g[k];
            energy += double(weight[k]) * g[k];
        }
        FitJob job;
        job.nodes = {int(nodes_.size()), nodes_.x.data(), nodes_.y.data(), nodes_.z.data(), weight.data()};
        double left = energy;
        for (const Blended& lobe : lobes) {
            toUnknowns(lobe.shape, job.maxLog, job.unknowns);
            float overlap = 0.0f, norm = 1.0f;
            kernels().evaluate(job, &overlap, &norm, nullptr);
            left += lobe.ks * (lobe.ks * norm - 2.0 * overlap);
        }
        float cross = 0.0f;
        const MixtureTerm first = unitTerm(lobes[0].shape);
        kernels().mixtureOverlaps(&first, 1, unitTerm(lobes[1].shape), &cross);
        return (left + 2.0 * lobes[0].ks * lobes[1].ks * cross) / energy;
    }

    const Source& source() const { return source_; }

private:
    const Maps& maps_;
    Source source_;
    Averager averager_;
    Lobes lobes_;
    std::vector<Member> members_;
    NodeSet nodes_;
    std::vector<float> g_[3];
    Cell cell_;
};

} // namespace

double lookupError(const Maps& maps, const ReflectanceMips& mips, size_t level, int samples)
{
    GroundTruth groundTruth(maps);
    const Level& l = mips.levels[level];
    const double scaleX = double(groundTruth.source().width()) / l.width;
    const double scaleY = double(groundTruth.source().height()) / l.height;
    std::mt19937 random(1);
    const auto place = [&](int size) { return double(random()) / 4294967296.0 * size; };
    double sum = 0.0;
    int counted = 0;
    for (int i = 0; i < samples; ++i) {
        const double u = place(l.width), v = place(l.height);
        if (!groundTruth.gather(Footprint((u - 0.5) * scaleX, (u + 0.5) * scaleX),
                                Footprint((v - 0.5) * scaleY, (v + 0.5) * scaleY)))
            continue;
        sum += groundTruth.error(blend(l, maps.wrap, u, v));
        ++counted;
    }
    return counted > 0 ? sum / counted : 0.0;
}

} // namespace lumel::baker
