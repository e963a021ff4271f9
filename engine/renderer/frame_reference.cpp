// The reference: what a picture is when enough forward frames, each shifted by a part of a pixel, are added.
#include "core/progress.h"
#include "frame.h"
#include <chrono>

namespace lumel {
namespace {

// Sub-pixel position of sample i, in [-0.5, 0.5): the R2 sequence (Roberts 2018, "The Unreasonable
// Effectiveness of Quasirandom Sequences"), from the plastic number. A square grid would beat against regular
// detail such as grooves.
glm::vec2 shiftOfSample(int i)
{
    const auto fraction = [](double x) { return float(x - std::floor(x)); };
    return {fraction(0.5 + 0.7548776662466927 * i) - 0.5f, fraction(0.5 + 0.5698402909980532 * i) - 0.5f};
}

// Samples of the next submission, after `count` of them took `seconds`: Ctrl-C is answered between
// submissions, and devices that show a desktop stop those that take seconds.
int samplesPerSubmission(int count, double seconds)
{
    constexpr double kSubmissionSeconds = 0.2;
    constexpr double kMostSamples = gpu::Timer::kMaxScopes / 2; // each is a scope, others come before
    return int(std::clamp(count * kSubmissionSeconds / seconds, 1.0, kMostSamples));
}

} // namespace

void Renderer::recordReference(Frame& frame)
{
    Progress progress("reference", size_t(settings_.samples));
    if (sumSamples_ == 0)
        display_.clearSum(frame);
    else
        display_.resumeSum(frame);
    for (int done = 0, count = 1; done < settings_.samples;) {
        count = std::min(count, settings_.samples - done);
        const auto start = std::chrono::steady_clock::now();
        for (int i = 0; i < count; ++i) {
            scene_.frameSet().recordView(frame.commands, makeView(frame, shiftOfSample(sumSamples_++)));
            draw_.record(frame, pool_);
            display_.accumulate(frame);
        }
        submitAndWait(frame);
        progress.advance(size_t(count));
        done += count;
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
        count = samplesPerSubmission(count, taken.count());
    }
}

} // namespace lumel
