#include "report_landscape.h"
#include "shared/limits.h"
#include "solver.h"

namespace lumel::baker {
namespace {

constexpr int kColumns = 120, kRows = 80;
constexpr int kMostEvaluations = 40; // what the baker allows itself (SearchSettings)

// The baker's search on one texel's average, stopped after any number of evaluations.
class Tracer {
public:
    Tracer(const DiscGrid& grid, const std::vector<float>& g, bool isotropic, float maxPower)
        : energy_(grid.integral(g.data(), g.data())), isotropic_(isotropic),
          maxLog_(0.5f * std::log(1.1f * maxPower - kBase))
    {
        const float peak = *std::max_element(g.begin(), g.end());
        for (size_t k = 0; k < g.size(); ++k)
            if (grid.area()[k] > 0.0f && g[k] > 1e-6f * peak)
                addNode(grid.x()[k], grid.y()[k], grid.z()[k], grid.area()[k] * g[k]);
        while (weight_.size() % kMaxLanes != 0)
            addNode(0.0f, 0.0f, 1.0f, 0.0f);
    }

    // The best point after `evaluations` from `start`. The search is deterministic, so growing numbers of
    // evaluations give the points it accepts one after the other.
    Landscape::Step after(int evaluations, const Shape& start)
    {
        FitJob job;
        job.nodes = {int(weight_.size()), x_.data(), y_.data(), z_.data(), weight_.data()};
        job.energy = float(energy_);
        job.maxLog = maxLog_;
        toUnknowns(isotropic_ ? isotropicShape(start) : start, maxLog_, job.unknowns);
        SearchSettings settings;
        settings.isotropic = isotropic_;
        settings.maxEvaluations = evaluations;
        FitJob* jobs[] = {&job};
        kernels().minimise(jobs, 1, settings);
        bool clamped = false;
        const Shape shape = fromUnknowns(job.unknowns, maxLog_, clamped);
        // The error with the best Ks is 1 - <G, f>^2 / (<G, G> <f, f>), that Ks <G, f> / <f, f>.
        const double explained = std::max(0.0, 1.0 - double(job.error));
        return {scalarPower(shape), std::sqrt(explained * energy_ / double(job.norm)), double(job.error)};
    }

private:
    void addNode(float x, float y, float z, float weight)
    {
        x_.push_back(x);
        y_.push_back(y);
        z_.push_back(z);
        weight_.push_back(weight);
    }

    double energy_;
    bool isotropic_;
    float maxLog_;
    std::vector<float> x_, y_, z_, weight_;
};

void tracePath(Tracer& tracer, const std::vector<PathStart>& starts, double fitError, Landscape& land)
{
    const PathStart* chosen = &starts.front();
    double furthest = -1.0, nearest = 1e30;
    for (const PathStart& start : starts) {
        const double miss = std::abs(tracer.after(kMostEvaluations, start.shape).error - fitError);
        const double first = tracer.after(1, start.shape).error;
        const bool arrives = miss < 0.02 * fitError + 1e-4;
        if (arrives ? first > furthest : furthest < 0.0 && miss < nearest) {
            chosen = &start;
            furthest = arrives ? first : furthest;
            nearest = miss;
        }
    }
    land.start = chosen->name;
    for (int evaluations = 1; evaluations <= kMostEvaluations; ++evaluations) {
        const Landscape::Step step = tracer.after(evaluations, chosen->shape);
        if (land.path.empty() || step.error < land.path.back().error)
            land.path.push_back(step);
    }
}

// Axes that hold the whole path and the fit, with a margin.
void chooseAxes(const StoredLobe& fit, Landscape& land)
{
    double least = scalarPower(fit.shape), most = least, ks = fit.ks;
    for (const Landscape::Step& step : land.path) {
        least = std::min(least, step.power);
        most = std::max(most, step.power);
        ks = std::max(ks, step.ks);
    }
    land.powerFrom = std::max(double(shared::kMinPower), least / 3.0);
    land.powerTo = std::min(double(shared::kMaxPower), std::max(3.0 * most, 10.0 * land.powerFrom));
    land.powerTo = std::max(land.powerTo, 2.0 * land.powerFrom);
    land.ksTo = std::max(1.7 * ks, 1e-6);
}

} // namespace

Landscape landscapeOf(const DiscGrid& grid, const std::vector<float>& average, const StoredLobe& fit,
                      const std::vector<PathStart>& starts, bool isotropic, float maxPower)
{
    Landscape land;
    const double energy = grid.integral(average.data(), average.data());
    if (energy <= 0.0)
        return land;
    if (!starts.empty()) {
        Tracer tracer(grid, average, isotropic, maxPower);
        tracePath(tracer, starts, fit.error, land);
    }
    chooseAxes(fit, land);
    land.columns = kColumns;
    land.rows = kRows;
    land.logError.resize(size_t(kColumns) * kRows);
    std::vector<float> f(grid.size());
    for (int i = 0; i < kColumns; ++i) {
        const double power = land.powerFrom * std::pow(land.powerTo / land.powerFrom, (i + 0.5) / kColumns);
        const float widen = float(scalarPower(fit.shape) / power);
        std::fill(f.begin(), f.end(), 0.0f);
        grid.add(
            {fit.shape.nx, fit.shape.ny, widen * fit.shape.sxx, widen * fit.shape.sxy, widen * fit.shape.syy},
            1.0f, f.data());
        // E is a parabola in Ks.
        const double gf = grid.integral(average.data(), f.data()), ff = grid.integral(f.data(), f.data());
        for (int j = 0; j < kRows; ++j) {
            const double ks = land.ksTo * (1.0 - (j + 0.5) / kRows);
            const double error = std::max(0.0, 1.0 + (ks * ks * ff - 2.0 * ks * gf) / energy);
            land.logError[size_t(j) * kColumns + size_t(i)] = float(std::log1p(error));
        }
    }
    return land;
}

} // namespace lumel::baker
