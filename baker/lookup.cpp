#include "lookup.h"
#include "averager.h"
#include "footprint.h"
#include "normals.h"
#include "solver.h"
#include <random>

namespace lumel::baker {
namespace {

// Blends the channels of the four texels around (u, v), in texels.
void blend(const Level& level, Wrap wrap, double u, double v, float* out)
{
    const double x = u - 0.5, y = v - 0.5;
    const int i = int(std::floor(x)), j = int(std::floor(y));
    const float a = float(x - i), b = float(y - j);
    const int i0 = wrapped(i, level.width, wrap), i1 = wrapped(i + 1, level.width, wrap);
    const int j0 = wrapped(j, level.height, wrap), j1 = wrapped(j + 1, level.height, wrap);
    for (int c = 0; c < kChannels; ++c)
        out[c] = (1 - b) * ((1 - a) * level.at(i0, j0)[c] + a * level.at(i1, j0)[c]) +
                 b * ((1 - a) * level.at(i0, j1)[c] + a * level.at(i1, j1)[c]);
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

    double error(const float* texel)
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
        toUnknowns({texel[kNx], texel[kNy], texel[kSxx], texel[kSxy], texel[kSyy]}, job.maxLog, job.unknowns);
        std::vector<float> scratch((4 * nodes_.size() + 64) * kMaxLanes);
        float overlap = 0.0f, norm = 1.0f;
        kernels().evaluate(job, &overlap, &norm, nullptr, scratch.data());
        const double ks = luminance({texel[kKsR], texel[kKsG], texel[kKsB]});
        return (energy - 2.0 * ks * overlap + ks * ks * norm) / energy;
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
        float texel[kChannels];
        blend(l, maps.wrap, u, v, texel);
        sum += groundTruth.error(texel);
        ++counted;
    }
    return counted > 0 ? sum / counted : 0.0;
}

} // namespace lumel::baker
