#include "exposure.h"
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace lumel {
namespace {

constexpr double kDarkest = 0.50, kBrightest = 0.95; // shares of the pixels
constexpr double kMiddleGrey = 0.18;
constexpr double kStepsAStop = 8.0;

// log2 of the middle of a bin, which divides its octave evenly.
double logOfBin(size_t bin)
{
    const double octave = std::floor(double(bin) / 8.0), eighths = double(bin % 8) + 0.5;
    return shared::kMeterFirstOctave + octave + std::log2(1.0 + eighths / 8.0);
}

double litPixels(const LuminanceHistogram& histogram)
{
    double sum = 0.0;
    for (size_t bin = 1; bin < histogram.size(); ++bin)
        sum += double(histogram[bin]);
    return sum;
}

} // namespace

std::optional<float> luminancePercentile(const LuminanceHistogram& histogram, double share)
{
    const double wanted = share * litPixels(histogram);
    double before = 0.0;
    for (size_t bin = 1; bin < histogram.size(); ++bin) {
        before += double(histogram[bin]);
        if (histogram[bin] > 0 && before >= wanted)
            return float(std::exp2(logOfBin(bin)));
    }
    return std::nullopt;
}

// Reinhard, Stark, Shirley and Ferwerda 2002, "Photographic Tone Reproduction for Digital Images", eq. 1,
// over a part of the pixels.
std::optional<float> keyLuminance(const LuminanceHistogram& histogram)
{
    const double all = litPixels(histogram), from = kDarkest * all, to = kBrightest * all;
    double before = 0.0, sum = 0.0, weight = 0.0;
    for (size_t bin = 1; bin < histogram.size(); ++bin) {
        const double after = before + double(histogram[bin]);
        const double part = std::max(std::min(after, to) - std::max(before, from), 0.0);
        sum += part * logOfBin(bin);
        weight += part;
        before = after;
    }
    return weight > 0.0 ? std::optional(float(std::exp2(sum / weight))) : std::nullopt;
}

float automaticExposure(const LuminanceHistogram& histogram)
{
    const auto key = keyLuminance(histogram);
    if (!key)
        return 1.0f;
    const double stops = std::round(kStepsAStop * std::log2(kMiddleGrey / double(*key))) / kStepsAStop;
    char text[32];
    std::snprintf(text, sizeof text, "%.3g", std::exp2(stops));
    return std::strtof(text, nullptr);
}

bool needsExposure(const LuminanceHistogram& histogram)
{
    const auto middle = luminancePercentile(histogram, 0.50), bright = luminancePercentile(histogram, 0.95);
    return middle && bright && (*middle > 1.0f || *bright < 0.02f);
}

void ExposureAdaptation::aim(float exposure)
{
    constexpr double kSmall = 1.5 / kStepsAStop; // stops
    const double log = std::log2(double(exposure));
    if (aim_ && std::abs(log - *aim_) < kSmall)
        return;
    aim_ = log;
    exact_ = exposure;
    if (!now_)
        now_ = aim_;
}

float ExposureAdaptation::advance(double seconds)
{
    constexpr double kTimeConstant = 0.5;  // seconds
    constexpr double kUnseen = 1.0 / 64.0; // stops
    if (!aim_)
        return 1.0f;
    *now_ += (*aim_ - *now_) * (1.0 - std::exp(-std::max(seconds, 0.0) / kTimeConstant));
    if (std::abs(*now_ - *aim_) < kUnseen)
        now_ = aim_;
    return arrived() ? exact_ : float(std::exp2(*now_));
}

} // namespace lumel
