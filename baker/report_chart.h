// The report's line drawings, as SVG text.
#pragma once
#include "report_measure.h"

namespace lumel::baker {

const char* methodColour(const std::string& label);
std::string formatError(double error);
// Mean E against level, one line per method, logarithmic.
std::string errorChart(const Measurement& report);
// The landscape's picture with axes, the minimiser's path and the fit.
std::string landscapeChart(const Landscape& landscape, const StoredLobe& fit);

} // namespace lumel::baker
