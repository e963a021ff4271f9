// Errors measured independently: how far the fit and every closed form are from the exact average
// reflectance, level by level, by brute force on a sample of texels, without the nodes that the fits were
// made with.
#pragma once
#include "bake.h"
#include "moments.h"
#include <functional>
#include <memory>

namespace lumel::baker {

class DiscGrid;

inline constexpr int kReportTexels = 256; // most texels measured per level

// A texel's lobe, or two, as some method stored it; Ks is the luminance.
struct StoredLobe {
    Shape shape;
    double ks = 0.0;
    double error = 0.0;        // E: integral of (G - F)^2 over the disc / integral of G^2
    double kd = 0.0;           // luminance
    double diffuseError = 0.0; // see report_diffuse.h
    Shape second;              // the other lobe, if it has any Ks
    double secondKs = 0.0;
    glm::dvec2 diffuseNormal{0.0}; // x and y
    // g += scale * F.
    void addTo(const DiscGrid& grid, float scale, float* g) const;
};

struct MeasuredTexel {
    int x = 0, y = 0;
    std::vector<StoredLobe> lobes; // one per method
};

struct ErrorFigures {
    double mean = 0.0, p95 = 0.0, worst = 0.0; // over the measured texels; p95 by nearest rank
};

// The error as a function of (power, Ks) with the fit's normal and proportions held, and the minimiser's
// path to the fit on it.
struct Landscape {
    struct Step {
        double power, ks, error;
    };
    int columns = 0, rows = 0;
    double powerFrom = 1.0, powerTo = 1.0; // first and last column; logarithmic between
    double ksTo = 1.0;                     // Ks of the top row's upper edge; the bottom is 0
    std::vector<float> logError;           // ln(1 + E), row 0 = highest Ks
    std::vector<Step> path;                // accepted points, start first; empty when nothing was fitted
    std::string start;                     // what the path starts from
};

// A texel that the report shows.
struct Exhibit {
    std::string rank; // "best", "median", "worst"
    MeasuredTexel texel;
    std::vector<float> average; // G on the grid
    Landscape landscape;
};

struct MeasuredLevel {
    int number = 0; // in the file
    int above = 0;  // the input: number + reduce
    int width = 0, height = 0;
    std::vector<int> sample;           // texels measured: y * width + x
    std::vector<ErrorFigures> figures; // one per method
    std::vector<ErrorFigures> diffuse; // of the diffuse term
    std::vector<Exhibit> exhibits;     // best, median, worst; fewer on the smallest levels
};

struct Measurement {
    int width = 0, height = 0;        // of the maps
    int threads = 0;                  // used
    bool box = true;                  // fitted for the averages over texels that are measured here
    std::vector<std::string> methods; // [0] is what was baked; then the closed forms, with their best Ks
    size_t oneLobe = 0;               // the method of one lobe whose landscape is shown
    bool meanKs = false;              // what was baked is a closed form that states its mean Ks
    int gridSide = 0;                 // points per side of the grid that E is summed on
    double narrowestDeviation = 0.0;  // of the level-0 lobes on the disc, all but a hundredth
    std::vector<MeasuredLevel> levels;
    std::shared_ptr<const DiscGrid> grid;
};

// Measures `baked`, the result of bake(maps, options), and every closed form that these maps allow, given the
// Ks of least error; each closed form's chain is shown to `seen` once. `progress` counts measureUnits().
using SeeChain = std::function<void(const ReflectanceMips&)>;
Measurement measure(const Maps& maps, const Options& options, const ReflectanceMips& baked,
                    const SeeChain& seen = {}, Progress* progress = nullptr);
size_t measureUnits(const Maps& maps, const Options& options);

} // namespace lumel::baker
