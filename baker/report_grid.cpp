#include "report_grid.h"
#include <array>
#include <mutex>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace lumel::baker {
namespace {

constexpr int kLeastSide = 96; // the rim needs some, however broad the lobes
constexpr int kMostSide = 512; // 1 MiB a picture of the disc
constexpr double kReach = 5.5; // deviations to where a lobe is 3e-7 of its peak
constexpr int kBinsPerOctave = 16;
constexpr int kBins = 12 * kBinsPerOctave; // deviations from 2^-12 to 1

struct Deviations {
    double least, most;
};

// Square roots of the eigenvalues.
Deviations deviations(const Sym2& s)
{
    const double mean = 0.5 * (s.xx + s.yy), half = 0.5 * (s.xx - s.yy);
    const double radius = std::sqrt(half * half + s.xy * s.xy);
    return {std::sqrt(std::max(mean - radius, 1e-9)), std::sqrt(mean + radius)};
}

struct Widths {
    std::array<size_t, kBins> bins{};
    double least = 1.0;
    size_t total = 0;

    void add(double deviation)
    {
        least = std::min(least, deviation);
        const int bin = int(std::floor((12.0 + std::log2(deviation)) * kBinsPerOctave));
        ++bins[size_t(std::clamp(bin, 0, kBins - 1))];
        ++total;
    }
    void merge(const Widths& o)
    {
        for (size_t i = 0; i < bins.size(); ++i)
            bins[i] += o.bins[i];
        least = std::min(least, o.least);
        total += o.total;
    }
};

// Area of the disc within the cell around (x, y), and its centroid, from 8 x 8 points.
double clippedCell(double width, double& x, double& y)
{
    constexpr int kSub = 8;
    double sumX = 0.0, sumY = 0.0;
    int inside = 0;
    for (int j = 0; j < kSub; ++j)
        for (int i = 0; i < kSub; ++i) {
            const double px = x + width * ((i + 0.5) / kSub - 0.5), py = y + width * ((j + 0.5) / kSub - 0.5);
            if (px * px + py * py >= 1.0)
                continue;
            sumX += px;
            sumY += py;
            ++inside;
        }
    if (inside == 0)
        return 0.0;
    x = sumX / inside;
    y = sumY / inside;
    return width * width * inside / (kSub * kSub);
}

} // namespace

Narrowness narrowness(const Source& source)
{
    Widths all;
    std::mutex mutex;
    tbb::parallel_for(tbb::blocked_range<int>(0, source.height(), 16), [&](const auto& rows) {
        Widths widths;
        Lobes lobes;
        lobes.resize(size_t(source.width()));
        for (int y = rows.begin(); y < rows.end(); ++y) {
            source.read(y, 0, source.width(), lobes, 0);
            for (size_t i = 0; i < lobes.size(); ++i) {
                const DiscFrame frame({lobes.nx[i], lobes.ny[i], lobes.nz[i]});
                widths.add(deviations(frame.toDisc({lobes.sxx[i], lobes.sxy[i], lobes.syy[i]})).least);
            }
        }
        std::lock_guard lock(mutex);
        all.merge(widths);
    });
    Narrowness narrow;
    narrow.least = all.least;
    size_t narrower = 0;
    int bin = 0;
    while (bin < kBins && (narrower += all.bins[size_t(bin)]) * 100 <= all.total)
        ++bin;
    narrow.firstPercentile = std::max(all.least, std::exp2(double(bin) / kBinsPerOctave - 12.0));
    return narrow;
}

int gridSide(const Narrowness& narrow)
{
    const double spacing = std::min(0.6 * narrow.firstPercentile, 1.6 * narrow.least);
    return int(std::clamp(std::ceil(2.0 / spacing), double(kLeastSide), double(kMostSide)));
}

DiscGrid::DiscGrid(int side) : side_((side + kMaxLanes - 1) / kMaxLanes * kMaxLanes), kernels_(kernels())
{
    const double width = spacing();
    for (int j = 0; j < side_; ++j)
        for (int i = 0; i < side_; ++i) {
            double x = -1.0 + (i + 0.5) * width, y = -1.0 + (j + 0.5) * width;
            const double area = clippedCell(width, x, y);
            // Points off the disc have no area; they take the rim's values, so that pictures interpolate.
            const double r2 = x * x + y * y, pull = r2 > 1.0 ? 1.0 / std::sqrt(r2) : 1.0;
            x_.push_back(float(x * pull));
            y_.push_back(float(y * pull));
            z_.push_back(float(std::sqrt(std::max(0.0, 1.0 - r2))));
            area_.push_back(float(area));
        }
}

void DiscGrid::add(const Shape& shape, float scale, float* g) const
{
    const double nz =
        std::sqrt(std::max(1e-6, 1.0 - double(shape.nx) * shape.nx - double(shape.ny) * shape.ny));
    const Sym2 s{shape.sxx, shape.sxy, shape.syy};
    const Sym2 p = s.inverse(), disc = DiscFrame({shape.nx, shape.ny, nz}).toDisc(s);
    const LobeTerm term{shape.nx,
                        shape.ny,
                        float(nz),
                        float(p.xx),
                        float(p.xy),
                        float(p.yy),
                        scale * float(std::sqrt(p.det()))};
    const bool isotropic = shape.sxy == 0.0f && shape.sxx == shape.syy;
    // h = c N + a Tu + b Tv with |(a, b)| <= reach: c shrinks from 1, so the box leans to the centre.
    const double reach = std::min(1.0, kReach * deviations(s).most);
    const double c = std::sqrt(1.0 - reach * reach);
    const auto range = [&](double n, double deviation, int& first, int& last) {
        const double half = std::min(1.0, kReach * deviation);
        const double low = std::min(n, n * c) - half, high = std::max(n, n * c) + half;
        first = std::clamp(int(std::floor((low + 1.0) / spacing())), 0, side_ - 1);
        last = std::clamp(int(std::floor((high + 1.0) / spacing())), 0, side_ - 1);
    };
    int x0, x1, y0, y1;
    range(shape.nx, std::sqrt(disc.xx), x0, x1);
    range(shape.ny, std::sqrt(disc.yy), y0, y1);
    x0 -= x0 % kMaxLanes;
    const int count = (x1 - x0) / kMaxLanes * kMaxLanes + kMaxLanes;
    for (int j = y0; j <= y1; ++j) {
        const size_t at = size_t(j) * size_t(side_) + size_t(x0);
        kernels_.average(&term, 1, isotropic, {count, &x_[at], &y_[at], &z_[at], nullptr}, g + at);
    }
}

double DiscGrid::integral(const float* f, const float* g) const
{
    double sum = 0.0;
    for (size_t k = 0; k < area_.size(); ++k)
        sum += double(area_[k]) * f[k] * g[k];
    return sum;
}

} // namespace lumel::baker
