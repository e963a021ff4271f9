#include "inspect.h"
#include "footprint.h"
#include "moments.h"
#include "report_average.h"
#include "report_grid.h"
#include "solver.h"

namespace lumel::baker {
namespace {

constexpr int kPictureSide = 48;

Moments momentsOf(const Source& source, const Level& level, int x, int y)
{
    const Footprint fx(x, level.width, source.width()), fy(y, level.height, source.height());
    Moments sum;
    Lobes row;
    row.resize(size_t(fx.last - fx.first));
    for (int j = fy.first; j < fy.last; ++j) {
        source.read(j, fx.first, fx.last, row, 0);
        for (size_t i = 0; i < row.size(); ++i)
            sum.add(row, i, double(fx.weight(fx.first + int(i))) * fy.weight(j));
    }
    return sum.mean();
}

// The relative squared error of `f` as an estimate of `g`.
double errorOf(const DiscGrid& grid, const std::vector<float>& f, const std::vector<float>& g)
{
    std::vector<float> difference(f.size());
    for (size_t i = 0; i < f.size(); ++i)
        difference[i] = f[i] - g[i];
    const double energy = grid.integral(g.data(), g.data());
    return energy > 0.0 ? grid.integral(difference.data(), difference.data()) / energy : 0.0;
}

// The square of the disc where the average is above a thousandth of its peak.
void frameAverage(const DiscGrid& grid, const std::vector<float>& g, TexelLobes& result)
{
    const float peak = *std::max_element(g.begin(), g.end());
    double x0 = 1.0, x1 = -1.0, y0 = 1.0, y1 = -1.0;
    for (size_t i = 0; i < g.size(); ++i)
        if (grid.area()[i] > 0.0f && g[i] >= 1e-3f * peak) {
            x0 = std::min(x0, double(grid.x()[i]));
            x1 = std::max(x1, double(grid.x()[i]));
            y0 = std::min(y0, double(grid.y()[i]));
            y1 = std::max(y1, double(grid.y()[i]));
        }
    result.peak = std::max(double(peak), 1e-12);
    result.centreX = x0 <= x1 ? 0.5 * (x0 + x1) : 0.0;
    result.centreY = y0 <= y1 ? 0.5 * (y0 + y1) : 0.0;
    result.half = std::clamp(0.6 * std::max(x1 - x0, y1 - y0), 0.05, 1.0);
    if (result.half > 0.7)
        result.centreX = result.centreY = 0.0, result.half = 1.0;
}

// Bilinear lookups in the grid; 0 beyond the rim.
std::vector<float> crop(const DiscGrid& grid, const std::vector<float>& g, const TexelLobes& view)
{
    std::vector<float> picture(size_t(kPictureSide) * kPictureSide, -1.0f);
    const double step = 2.0 * view.half / kPictureSide;
    for (int j = 0; j < kPictureSide; ++j)
        for (int i = 0; i < kPictureSide; ++i) {
            const double x = view.centreX - view.half + (i + 0.5) * step;
            const double y = view.centreY + view.half - (j + 0.5) * step;
            if (x * x + y * y >= 1.0)
                continue;
            const double u = std::clamp((x + 1.0) / grid.spacing() - 0.5, 0.0, grid.side() - 1.001);
            const double v = std::clamp((y + 1.0) / grid.spacing() - 0.5, 0.0, grid.side() - 1.001);
            const size_t at = size_t(v) * size_t(grid.side()) + size_t(u);
            const double a = u - std::floor(u), b = v - std::floor(v);
            const double low = (1.0 - a) * g[at] + a * g[at + 1];
            const double high = (1.0 - a) * g[at + size_t(grid.side())] + a * g[at + size_t(grid.side()) + 1];
            picture[size_t(j) * kPictureSide + size_t(i)] = float((1.0 - b) * low + b * high);
        }
    return picture;
}

// The lobe with the Ks that serves it best: the projection of the average.
std::vector<float> scaledToFit(const DiscGrid& grid, std::vector<float> lobe, const std::vector<float>& g)
{
    const double norm = grid.integral(lobe.data(), lobe.data());
    const double ks = norm > 0.0 ? grid.integral(g.data(), lobe.data()) / norm : 0.0;
    for (float& value : lobe)
        value *= float(ks);
    return lobe;
}

} // namespace

struct TexelInspector::Data {
    explicit Data(Maps given) : maps(std::move(given)), source(maps), grid(gridSide(narrowness(source))) {}
    Maps maps;
    Source source;
    DiscGrid grid;
};

TexelInspector::TexelInspector(Maps maps) : data_(std::make_unique<Data>(std::move(maps))) {}

TexelInspector::~TexelInspector() = default;

TexelLobes TexelInspector::look(const std::vector<Level>& sizes, size_t level, int x, int y,
                                const float* texel, const float* second) const
{
    const DiscGrid& grid = data_->grid;
    std::vector<float> g(grid.size()), f(grid.size()), lean(grid.size());
    Averages(data_->source, sizes, grid, 0).get(level, x, y, g.data());
    for (const float* t : {texel, second}) // both begin alike
        if (t)
            grid.add({t[kNx], t[kNy], t[kSxx], t[kSxy], t[kSyy]},
                     float(luminance({t[kKsR], t[kKsG], t[kKsB]})), f.data());
    grid.add(leanShape(momentsOf(data_->source, sizes[level], x, y)), 1.0f, lean.data());
    lean = scaledToFit(grid, std::move(lean), g);
    TexelLobes result;
    frameAverage(grid, g, result);
    result.side = kPictureSide;
    result.average = {crop(grid, g, result), 0.0};
    result.fit = {crop(grid, f, result), errorOf(grid, f, g)};
    result.lean = {crop(grid, lean, result), errorOf(grid, lean, g)};
    return result;
}

} // namespace lumel::baker
