// The lattice points of long lobes.
#include "baker/fit_kernel.h"
#include "baker/strip.h"
#include <set>

namespace lumel::baker {
namespace {

// A lobe of these powers, its long axis under an angle in the frame of its normal.
Lobes lobeOf(float nx, float ny, float low, float high, float angle)
{
    Lobes lobes;
    lobes.resize(1);
    const float c = std::cos(angle), s = std::sin(angle);
    lobes.nx[0] = nx;
    lobes.ny[0] = ny;
    lobes.nz[0] = std::sqrt(1.0f - nx * nx - ny * ny);
    lobes.sxx[0] = c * c / low + s * s / high;
    lobes.sxy[0] = c * s * (1.0f / low - 1.0f / high);
    lobes.syy[0] = s * s / low + c * c / high;
    return lobes;
}

// Its value at lattice points.
std::vector<float> valuesAt(const Lobes& l, const Stencil& stencil, glm::vec2 centre, float spacing)
{
    const float det = l.sxx[0] * l.syy[0] - l.sxy[0] * l.sxy[0];
    const LobeTerm lobe{l.nx[0], l.ny[0], l.nz[0], l.syy[0] / det, -l.sxy[0] / det, l.sxx[0] / det, 1.0f};
    std::vector<float> values(stencil.x.size());
    kernels().shapeOnLattice(lobe, false, stencil.x.data(), stencil.y.data(), int(values.size()), centre.x,
                             centre.y, spacing, values.data());
    return values;
}

std::set<std::pair<int, int>> pointsOf(const Stencil& stencil)
{
    std::set<std::pair<int, int>> points;
    for (const Stencil::Run& run : stencil.runs)
        for (int i = 0; i < run.count; ++i)
            points.insert({run.y, run.x + i * run.stride});
    return points;
}

} // namespace

TEST(Strip, HoldsTheLobeDownToTheCutOffAndLittleElse)
{
    const float least = std::exp(-0.5f * kMargin * kMargin);
    for (const float tilt : {0.0f, 0.3f, 0.7f, 0.9f})
        for (const float low : {1.0f, 20.0f, 200.0f})
            for (int turn = 0; turn < 16; ++turn) {
                const float high = 6000.0f, angle = 0.2f * float(turn), spacing = 1.0f / std::sqrt(high);
                const Lobes l =
                    lobeOf(tilt * std::cos(1.7f * angle), tilt * std::sin(1.7f * angle), low, high, angle);
                const glm::vec2 at = lambert(l.nx[0], l.ny[0], l.nz[0]) / spacing;
                const glm::vec2 centre(std::nearbyint(at.x), std::nearbyint(at.y));
                Stencil strip;
                Strip(l, 0).fill(spacing, centre, {}, strip);
                const auto inStrip = pointsOf(strip);
                Stencil around; // as far as strips reach
                for (int y = -36; y <= 36; ++y)
                    around.runs.push_back({y, -36, 73});
                around.place();
                const std::vector<float> values = valuesAt(l, around, centre, spacing);
                size_t k = 0, visible = 0, missed = 0;
                for (const Stencil::Run& run : around.runs)
                    for (int i = 0; i < run.count; ++i, ++k) {
                        const bool isVisible =
                            values[k] > least && run.y * run.y + (run.x + i) * (run.x + i) < 36 * 36;
                        visible += isVisible;
                        missed += isVisible && !inStrip.contains({run.y, run.x + i});
                    }
                EXPECT_EQ(missed, 0u)
                    << "of " << visible << ", tilt " << tilt << ", power " << low << ", turn " << turn;
                EXPECT_LT(inStrip.size(), 2 * visible + 128)
                    << "tilt " << tilt << ", power " << low << ", turn " << turn;
            }
}

// Squares of lobes, which vary the fastest, summed on the sublattice and on the whole.
TEST(Strip, OnASublatticeSumsAreTheSame)
{
    int coarser = 0, count = 0;
    for (const float tilt : {0.0f, 0.3f, 0.7f})
        for (int turn = 0; turn < 16; ++turn, ++count) {
            const float high = 6000.0f, angle = 0.2f * float(turn), spacing = 1.0f / std::sqrt(high);
            const Lobes l =
                lobeOf(tilt * std::cos(1.7f * angle), tilt * std::sin(1.7f * angle), 50.0f, high, angle);
            const glm::vec2 centre = glm::round(lambert(l.nx[0], l.ny[0], l.nz[0]) / spacing);
            const Strip strip(l, 0);
            const Sublattice sub = sublatticeFor({strip.covariance(spacing)});
            coarser += sub.step > 1;
            const auto energyOn = [&](const Sublattice& points) {
                Stencil stencil;
                strip.fill(spacing, centre, points, stencil);
                const std::vector<float> values = valuesAt(l, stencil, centre, spacing);
                double sum = 0.0;
                for (size_t k = 0; k < pointsOf(stencil).size(); ++k) // without what pads them
                    sum += points.step * double(values[k]) * double(values[k]);
                return sum;
            };
            EXPECT_NEAR(energyOn(sub) / energyOn({}), 1.0, 2e-3) << "tilt " << tilt << ", turn " << turn;
        }
    EXPECT_GT(2 * coarser, count);
}

TEST(Strip, OfASublatticeItHasThePointsThatTheWholeHas)
{
    const float spacing = 1.0f / std::sqrt(6000.0f);
    const Lobes l = lobeOf(0.3f, -0.2f, 50.0f, 6000.0f, 0.7f);
    const Strip strip(l, 0);
    for (const Sublattice sub : {Sublattice{2, 1, 0}, {2, 0, 1}, {2, 1, 1}, {4, 1, 2}, {4, 2, 1}, {4, 1, 3}})
        for (const glm::ivec2 centre : {glm::ivec2(19, -12), glm::ivec2(18, -13)}) {
            Stencil whole, part;
            strip.fill(spacing, glm::vec2(centre), {}, whole);
            strip.fill(spacing, glm::vec2(centre), sub, part);
            auto expected = pointsOf(whole);
            std::erase_if(expected,
                          [&](const auto& p) { return !sub.has(centre.x + p.second, centre.y + p.first); });
            EXPECT_EQ(pointsOf(part), expected) << sub.step << " " << sub.x << " " << sub.y;
        }
}

TEST(Strip, RoundLobesNeedTheWholeLattice)
{
    EXPECT_EQ(sublatticeFor({{1.0f, 0.0f, 1.0f, 1.0f}}).step, 1);
}

} // namespace lumel::baker
