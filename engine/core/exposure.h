// Automatic exposure: from the histogram of a picture's luminances (shared/meter.h) to what they are
// multiplied by.
#pragma once
#include "shared/meter.h"
#include <array>
#include <optional>

namespace lumel {

using LuminanceHistogram = std::array<uint32_t, shared::kMeterBins>;

// The luminance below which `share` of the pixels are. Black ones, which nothing lights, do not count;
// nothing where all are.
std::optional<float> luminancePercentile(const LuminanceHistogram& histogram, double share);

// The log-average luminance between the 50th and the 95th percentile: neither deep shadows nor highlights
// decide.
std::optional<float> keyLuminance(const LuminanceHistogram& histogram);

// What brings the key luminance to middle grey, in steps of 1/8 stop, with the three digits that are printed.
// 1 for a black picture.
float automaticExposure(const LuminanceHistogram& histogram);

// At exposure 1, would the picture be nearly white (more than half of it beyond the display's white) or
// nearly black (95 % of it below 0.02)?
bool needsExposure(const LuminanceHistogram& histogram);

// An exposure that follows another with a time constant of half a second (eye adaptation).
class ExposureAdaptation {
public:
    // Small changes of what is wanted do not count.
    void aim(float exposure);
    float advance(double seconds);
    bool arrived() const { return now_ == aim_; }
    void reset() { aim_ = now_ = std::nullopt; }

private:
    std::optional<double> aim_, now_; // log2
    float exact_ = 1.0f;              // what was aimed at
};

} // namespace lumel
