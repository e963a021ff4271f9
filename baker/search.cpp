// Which first guesses the minimiser starts from. The error has several minima as soon as the lobes
// under a texel stand apart (a V-groove has one on each flank and a broad one between), so one start is
// not enough. Every guess is searched from on a cheap stand-in for the error (fit_mixture.inl); the two
// best minima found are then searched from exactly, and the best result kept.
#include "group.h"

namespace lumel::baker {
namespace {

// Below this error the average is one bump and has one minimum: all starts end there.
constexpr float kSettledError = 0.02f;
// Above this error no single lobe fits, and minima are many: try the isotropic ones too.
constexpr float kHopelessError = 0.2f;
constexpr float kNoError = 1e30f; // worse than any search

// The talk's guess: under half of the finer power, never near 1.
Shape halfPower(const TexelTask& task)
{
    Shape shape = averageShape(task.mean);
    shape.sxx = shape.syy = std::min(2.2f / scalarPower(shape), 0.4f);
    shape.sxy = 0.0f;
    return shape;
}

// Closed forms first, then the finer level's lobes.
Shape guess(const TexelTask& task, int number)
{
    switch (number) {
    case 0:
        return leanShape(task.mean);
    case 1:
        return halfPower(task);
    default:
        return task.children[size_t(number - 2) % size_t(task.childCount)].shape;
    }
}

// Do two lobes stand for different minima? Their normals lie a lobe's width apart or their powers
// differ by half.
bool distinct(const Shape& a, const Shape& b)
{
    const float dx = a.nx - b.nx, dy = a.ny - b.ny, power = scalarPower(a), ratio = power / scalarPower(b);
    return (dx * dx + dy * dy) * power > 0.25f || ratio > 1.5f || ratio < 0.67f;
}

} // namespace

bool Group::settled() const
{
    for (size_t lane = 0; lane < size_t(count_); ++lane)
        if (bestError_[lane] > kSettledError && !tasks_[lane].uniform)
            return false;
    return true;
}

// The two best distinct minima of the mixture's error.
void Group::chooseStarts(Shape* first, Shape* second, bool isotropic)
{
    std::array<Shape, kMaxLanes> shapes;
    std::array<float, kMaxLanes> errors, firstError, secondError;
    firstError.fill(kNoError);
    secondError.fill(kNoError);
    for (int number = 0; number < 2 + mixtureCount_; ++number) {
        for (size_t lane = 0; lane < size_t(count_); ++lane)
            shapes[lane] = guess(tasks_[lane], number);
        search(shapes.data(), errors.data(), isotropic, false);
        for (size_t lane = 0; lane < size_t(count_); ++lane) {
            const bool other = number == 0 || distinct(shapes[lane], first[lane]);
            if (errors[lane] < firstError[lane]) {
                if (other && number > 0) {
                    second[lane] = first[lane];
                    secondError[lane] = firstError[lane];
                }
                first[lane] = shapes[lane];
                firstError[lane] = errors[lane];
            } else if (other && errors[lane] < secondError[lane]) {
                second[lane] = shapes[lane];
                secondError[lane] = errors[lane];
            }
        }
    }
    // One minimum only: the closed form is the other start.
    for (size_t lane = 0; lane < size_t(count_); ++lane)
        if (secondError[lane] == kNoError)
            second[lane] = guess(tasks_[lane], 0);
}

void Group::fit()
{
    const bool isotropic = options_.model == Model::blinnPhong;
    bestError_.fill(kNoError);
    buildMixture();
    std::array<Shape, kMaxLanes> first, second;
    std::array<float, kMaxLanes> errors;
    chooseStarts(first.data(), second.data(), isotropic);
    search(first.data(), errors.data(), isotropic, true);
    if (settled())
        return;
    search(second.data(), errors.data(), isotropic, true);
    if (!isotropic && *std::max_element(bestError_.begin(), bestError_.begin() + count_) > kHopelessError) {
        chooseStarts(first.data(), second.data(), true);
        for (std::array<Shape, kMaxLanes>* start : {&first, &second}) {
            search(start->data(), errors.data(), true, true);
            search(start->data(), errors.data(), false, true);
        }
    }
    // No closed form of the family may beat the fit: where one does, search on from it.
    const std::array<float, kMaxLanes> before = bestError_;
    for (const auto& form : {leanShape, toksvigShape, averageShape}) {
        std::array<Shape, kMaxLanes> shapes;
        for (size_t lane = 0; lane < size_t(count_); ++lane) {
            shapes[lane] = form(tasks_[lane].mean);
            if (isotropic)
                shapes[lane] = isotropicShape(shapes[lane]);
        }
        consider(shapes.data());
    }
    if (bestError_ != before) {
        first = best_;
        search(first.data(), errors.data(), isotropic, true);
    }
}

} // namespace lumel::baker
