#include "inspection.h"
#include "baker/footprint.h"
#include "baker/moments.h"
#include "baker/report_average.h"
#include "baker/report_grid.h"
#include "baker/solver.h"
#include "scene/material_maps.h"

namespace lumel::ui {
namespace {

using namespace baker;

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
void frameAverage(const DiscGrid& grid, const std::vector<float>& g, Inspection& result)
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
std::vector<float> crop(const DiscGrid& grid, const std::vector<float>& g, const Inspection& view)
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

} // namespace

// What a material's texels are averaged from; decoding images again for each texel would take longer.
struct Inspector::Maps {
    Maps(const scene::Scene& scene, size_t material)
        : maps(scene::reflectanceMaps(scene, scene.materials[material])), source(maps),
          grid(gridSide(narrowness(source))), material(material)
    {
    }
    baker::Maps maps;
    Source source;
    DiscGrid grid;
    size_t material;
};

Inspector::~Inspector()
{
    if (thread_.joinable())
        thread_.join();
}

void Inspector::look(std::shared_ptr<const scene::Scene> scene,
                     std::shared_ptr<const std::vector<scene::BakedMaterial>> baked, const Texel& texel)
{
    if (thread_.joinable() || (last_ == texel && lastScene_ == baked.get()))
        return;
    if (lastScene_ != baked.get())
        maps_.reset();
    last_ = texel;
    lastScene_ = baked.get();
    done_ = false;
    thread_ = std::thread([this, scene, baked, texel] {
        result_ = {};
        try {
            work(*scene, *baked, texel);
        } catch (const std::exception&) { // maps that cannot be read: there is nothing to show
            result_ = {};
        }
        done_ = true;
    });
}

bool Inspector::take(Inspection& inspection)
{
    if (!done_)
        return false;
    thread_.join();
    done_ = false;
    inspection = result_;
    return true;
}

void Inspector::work(const scene::Scene& scene, const std::vector<scene::BakedMaterial>& baked,
                     const Texel& texel)
{
    if (!maps_ || maps_->material != texel.material)
        maps_ = std::make_shared<Maps>(scene, texel.material);
    const Maps& m = *maps_;
    const auto& levels = baked[texel.material].reflectance.levels;
    const Level& level = levels[size_t(texel.level)];
    const float* stored = level.at(texel.x, texel.y);
    result_.texel = texel;
    result_.material = scene.materials[texel.material].name;
    result_.width = level.width;
    result_.height = level.height;
    std::copy_n(stored, kChannels, result_.baked.begin());

    std::vector<float> g(m.grid.size()), f(m.grid.size()), lean(m.grid.size());
    Averages(m.source, levels, m.grid, 0).get(size_t(texel.level), texel.x, texel.y, g.data());
    m.grid.add({stored[kNx], stored[kNy], stored[kSxx], stored[kSxy], stored[kSyy]},
               float(luminance({stored[kKsR], stored[kKsG], stored[kKsB]})), f.data());
    m.grid.add(leanShape(momentsOf(m.source, level, texel.x, texel.y)), 1.0f, lean.data());
    // With the Ks of least error: the projection of the average.
    const double norm = m.grid.integral(lean.data(), lean.data());
    const double ks = norm > 0.0 ? m.grid.integral(g.data(), lean.data()) / norm : 0.0;
    for (float& value : lean)
        value *= float(ks);
    frameAverage(m.grid, g, result_);
    result_.side = kPictureSide;
    result_.average = {crop(m.grid, g, result_), 0.0};
    result_.fit = {crop(m.grid, f, result_), errorOf(m.grid, f, g)};
    result_.lean = {crop(m.grid, lean, result_), errorOf(m.grid, lean, g)};
    result_.valid = true;
}

} // namespace lumel::ui
