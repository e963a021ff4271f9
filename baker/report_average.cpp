#include "report_average.h"
#include "solver.h"
#include <tbb/parallel_for.h>

namespace lumel::baker {
namespace {
constexpr size_t kMostFloats = size_t(64) << 20; // for the cells

Averages::AddLobe reflectanceOn(const DiscGrid& grid)
{
    return [&grid](const Lobes& l, size_t i, float weight, float* g) {
        const double ks = luminance({l.ks[0][i], l.ks[1][i], l.ks[2][i]});
        grid.add({l.nx[i], l.ny[i], l.sxx[i], l.sxy[i], l.syy[i]}, weight * float(ks), g);
    };
}
} // namespace

Averages::Averages(const Source& source, const std::vector<Level>& levels, const DiscGrid& grid,
                   int sharedTexels)
    : Averages(source, levels, grid.size(), reflectanceOn(grid), sharedTexels)
{
}

Averages::Averages(const Source& source, const std::vector<Level>& levels, size_t points, AddLobe add,
                   int sharedTexels)
    : source_(source), levels_(levels), points_(points), add_(std::move(add)), firstShared_(levels.size())
{
    for (size_t next = levels.size(); next-- > 0; firstShared_ = next) {
        const size_t cells = (borders(source.width(), next, &Level::width).size() - 1) *
                             (borders(source.height(), next, &Level::height).size() - 1);
        if (levels[next].width * levels[next].height > sharedTexels || cells * points_ > kMostFloats)
            break;
    }
    if (firstShared_ < levels.size())
        sumCells();
}

void Averages::get(size_t level, int x, int y, float* g) const
{
    std::fill(g, g + points_, 0.0f);
    const Footprint fx(x, levels_[level].width, source_.width());
    const Footprint fy(y, levels_[level].height, source_.height());
    const double area = (fx.end - fx.begin) * (fy.end - fy.begin);
    if (level < firstShared_) {
        addRectangle(fx, fy, float(1.0 / area), g);
        return;
    }
    const auto at = [](const std::vector<double>& cuts, double border) {
        return size_t(std::lower_bound(cuts.begin(), cuts.end(), border - 1e-6) - cuts.begin());
    };
    for (size_t j = at(cutsY_, fy.begin); j < at(cutsY_, fy.end); ++j)
        for (size_t i = at(cutsX_, fx.begin); i < at(cutsX_, fx.end); ++i) {
            const float* cell = cells_.data() + (j * (cutsX_.size() - 1) + i) * points_;
            for (size_t k = 0; k < points_; ++k)
                g[k] += cell[k];
        }
    for (size_t k = 0; k < points_; ++k)
        g[k] /= float(area);
}

// Borders of the texels of all levels from `firstLevel` on, on one axis, ascending.
std::vector<double> Averages::borders(int size, size_t firstLevel, int Level::*extent) const
{
    std::vector<double> cuts;
    for (size_t l = firstLevel; l < levels_.size(); ++l)
        for (int x = 0; x < levels_[l].*extent; ++x) {
            const Footprint f(x, levels_[l].*extent, size);
            cuts.insert(cuts.end(), {f.begin, f.end});
        }
    std::sort(cuts.begin(), cuts.end());
    const auto same = [](double a, double b) { return b - a < 1e-6; };
    cuts.erase(std::unique(cuts.begin(), cuts.end(), same), cuts.end());
    return cuts;
}

void Averages::addRectangle(const Footprint& fx, const Footprint& fy, float scale, float* g) const
{
    Lobes row;
    row.resize(size_t(fx.last - fx.first));
    for (int y = fy.first; y < fy.last; ++y) {
        source_.read(y, fx.first, fx.last, row, 0);
        for (size_t i = 0; i < row.size(); ++i)
            add_(row, i, fx.weight(fx.first + int(i)) * fy.weight(y) * scale, g);
    }
}

void Averages::sumCells()
{
    cutsX_ = borders(source_.width(), firstShared_, &Level::width);
    cutsY_ = borders(source_.height(), firstShared_, &Level::height);
    const size_t across = cutsX_.size() - 1, count = across * (cutsY_.size() - 1);
    cells_.assign(count * points_, 0.0f);
    tbb::parallel_for(size_t(0), count, [&](size_t c) {
        const size_t i = c % across, j = c / across;
        addRectangle({cutsX_[i], cutsX_[i + 1]}, {cutsY_[j], cutsY_[j + 1]}, 1.0f,
                     cells_.data() + c * points_);
    });
}

} // namespace lumel::baker
