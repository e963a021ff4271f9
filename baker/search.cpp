// Which first guesses the minimiser starts from. The error has several minima as soon as the lobes
// under a texel stand apart (a V-groove has one on each flank and a broad one between), so one start is
// not enough: every guess is tried and the best result kept.
#include "group.h"
#include <numeric>

namespace lumel::baker {
namespace {

// Below this error the average is one bump and has one minimum: all starts end there.
constexpr float kSettledError = 0.03f;
constexpr float kNoError = 1e30f; // worse than any search

constexpr int kIsotropicStarts = 3; // how many of the ranked guesses are searched from
constexpr int kAnisotropicStarts = 2;

// The talk's guess: under half of the finer power, never near 1.
Shape halfPower(const TexelTask& task)
{
    Shape shape = averageShape(task.mean);
    shape.sxx = shape.syy = std::min(2.2f / scalarPower(shape), 0.4f);
    shape.sxy = 0.0f;
    return shape;
}

} // namespace

bool Group::settled() const
{
    for (size_t lane = 0; lane < size_t(count_); ++lane)
        if (bestError_[lane] > kSettledError && !tasks_[lane].uniform)
            return false;
    return true;
}

// Ranks the guesses by their own error, lane by lane, and searches from the best `searches` of them.
void Group::searchRanked(const std::vector<std::array<Shape, kMaxLanes>>& guesses, int searches,
                         bool isotropic)
{
    const size_t count = guesses.size();
    std::vector<std::array<float, kMaxLanes>> errors(count);
    for (size_t s = 0; s < count; ++s)
        consider(guesses[s].data(), errors[s].data());
    std::array<std::vector<size_t>, kMaxLanes> order;
    for (size_t lane = 0; lane < size_t(count_); ++lane) {
        order[lane].resize(count);
        std::iota(order[lane].begin(), order[lane].end(), size_t(0));
        std::stable_sort(order[lane].begin(), order[lane].end(),
                         [&](size_t a, size_t b) { return errors[a][lane] < errors[b][lane]; });
    }
    for (size_t rank = 0; rank < std::min(count, size_t(searches)); ++rank) {
        std::array<Shape, kMaxLanes> starts;
        for (size_t lane = 0; lane < size_t(count_); ++lane)
            starts[lane] = guesses[order[lane][rank]][lane];
        minimiseFrom(starts.data(), isotropic);
        if (settled())
            return;
    }
}

// Guesses that depend on the texel's own lobes only, so that both models search them alike.
void Group::fitIsotropic()
{
    std::vector<std::array<Shape, kMaxLanes>> guesses(5);
    for (size_t lane = 0; lane < size_t(count_); ++lane) {
        const TexelTask& task = tasks_[lane];
        guesses[0][lane] = isotropicShape(leanShape(task.mean));
        guesses[1][lane] = isotropicShape(toksvigShape(task.mean));
        guesses[2][lane] = isotropicShape(averageShape(task.mean));
        guesses[3][lane] = halfPower(task);
        guesses[4][lane] = isotropicShape(peaks_[lane]);
    }
    searchRanked(guesses, kIsotropicStarts, true);
}

void Group::fitAnisotropic()
{
    std::vector<std::array<Shape, kMaxLanes>> guesses(3);
    for (size_t lane = 0; lane < size_t(count_); ++lane) {
        guesses[0][lane] = leanShape(tasks_[lane].mean);
        guesses[1][lane] = toksvigShape(tasks_[lane].mean);
        guesses[2][lane] = averageShape(tasks_[lane].mean);
    }
    for (size_t i = 0; i < 4; ++i) {
        guesses.emplace_back();
        for (size_t lane = 0; lane < size_t(count_); ++lane) {
            const TexelTask& task = tasks_[lane];
            guesses.back()[lane] =
                task.childCount > 0 ? task.children[i % size_t(task.childCount)] : peaks_[lane];
        }
    }
    searchRanked(guesses, kAnisotropicStarts, false);
    if (settled())
        return;
    // From the Blinn-Phong fit too: the result cannot be worse than it.
    const std::array<Shape, kMaxLanes> soFar = best_;
    const std::array<float, kMaxLanes> soFarError = bestError_;
    bestError_.fill(kNoError);
    fitIsotropic();
    minimiseFrom(std::array(best_).data(), false);
    for (size_t lane = 0; lane < size_t(count_); ++lane)
        if (soFarError[lane] < bestError_[lane]) {
            best_[lane] = soFar[lane];
            bestError_[lane] = soFarError[lane];
        }
}

void Group::fit()
{
    bestError_.fill(kNoError);
    if (options_.model == Model::blinnPhong)
        fitIsotropic();
    else
        fitAnisotropic();
}

} // namespace lumel::baker
