// The report's pictures: lobes in false colour on the disc of half vectors, and error landscapes.
#pragma once
#include "report_grid.h"
#include "report_measure.h"

namespace lumel::baker {

// What part of the disc a row of pictures shows, and the value of the top of its colours.
struct View {
    double x = 0.0, y = 0.0, half = 1.0; // centre and half the side of the square
    double peak = 1.0;
};
// The part where the average and every method's lobe are.
View viewOf(const DiscGrid& grid, const Exhibit& exhibit);

// PNG pictures as data URIs.
std::string averagePicture(const DiscGrid& grid, const std::vector<float>& average, const View& view);
std::string lobePicture(const StoredLobe& lobe, const View& view);
std::string landscapePicture(const Landscape& landscape);

// Reflectance to colour position: logarithmic so that the foot of a lobe shows, 1 at the peak.
double scalePosition(double valueOverPeak);
std::string scalePicture();              // the colours of reflectance, 0 to twice the peak
inline constexpr double kScaleEnd = 2.0; // times the peak: where the colours end

} // namespace lumel::baker
