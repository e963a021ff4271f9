// How good a bake is: errors of the fit and of every closed form, as numbers and as pictures.
#pragma once
#include "report_measure.h"
#include <filesystem>

namespace lumel::baker {

// As the baker states them, over all texels.
struct MethodErrors {
    std::string method;
    double mean = 0.0, p95 = 0.0, worst = 0.0;
};

struct LevelReport {
    int level = 0; // above the input
    int width = 0, height = 0;
    std::vector<MethodErrors> methods; // the bake itself first
    // Mean error of bilinear lookups in chains fitted for the box and for bilinear reconstruction; negative
    // where a texel covers too many lobes to measure it.
    double boxLookup = -1.0, bilinearLookup = -1.0;
};

struct Report {
    std::string model, source;
    double seconds = 0.0; // of the bake
    double peakMiB = 0.0; // of the process so far
    std::vector<LevelReport> levels;
    std::string name;     // what was baked, for headings
    Measurement measured; // the same measured by brute force
};

// Bakes every closed form that the maps allow (height needs a height map) and compares. `seconds` is
// what baking `mips` took. `progress` counts measureUnits().
Report makeReport(const Maps& maps, const Options& options, const ReflectanceMips& mips, double seconds,
                  Progress* progress = nullptr);

// The fields are listed in baker/README.md.
std::string reportJson(const Report& report);

// Self-contained page: the numbers, and for best, median and worst texel of each level the exact average,
// the fit and the closed forms on the half-angle disc, with the error over (power, Ks) and the
// minimiser's path through it.
std::string reportHtml(const Report& report);

// Writes the report that the extension asks for, .json or .html.
void writeReport(const std::filesystem::path& file, const Report& report);

} // namespace lumel::baker
