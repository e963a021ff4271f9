// Which first guesses the minimiser starts from. The error has several minima as soon as the lobes
// under a texel stand apart (a V-groove has one on each flank and a broad one between), so one start is
// not enough. Every guess is searched from on a cheap stand-in for the error (fit_mixture.inl); the two
// best minima found are then searched from exactly, and the best result kept.
#include "solver.h"

namespace lumel::baker {
namespace {

// Below this error the average is one bump and has one minimum: all starts end there.
constexpr float kSettledError = 0.03f;
// Above this error a closed form may lie in a better minimum; above the second, where no single lobe fits
// and minima are many, an isotropic lobe too.
constexpr float kHopelessError = 0.06f;
constexpr float kTornError = 0.15f;
// Where lobes are this broad (variance) or this tilted (|N.xy|^2), their Gaussian stand-ins mislead. Then a
// closed form or an isotropic lobe may win at smaller errors too.
constexpr float kBroad = 0.05f, kSteep = 0.6f;
constexpr float kBroadError = 1e-4f, kSteepError = 0.01f;
// A closed form this narrow, relative to the mean lobe, says that the lobes lie within each other.
constexpr float kCompact = 0.7f;

// The talk's guess: under half of the finer power, never near 1.
Shape halfPower(const TexelTask& task)
{
    Shape shape = averageShape(task.mean);
    shape.sxx = shape.syy = std::min(2.2f / scalarPower(shape), 0.4f);
    shape.sxy = 0.0f;
    return shape;
}

// Do two lobes stand for different minima? Their normals lie half a lobe's width apart or their powers
// differ by half.
bool distinct(const Shape& a, const Shape& b)
{
    const float dx = a.nx - b.nx, dy = a.ny - b.ny, power = scalarPower(a), ratio = power / scalarPower(b);
    return (dx * dx + dy * dy) * power > 0.25f || ratio > 1.5f || ratio < 0.67f;
}

} // namespace

Solver::Selection Solver::above(const Selection& selection, Family family, float error) const
{
    Selection rest;
    for (const uint32_t t : selection)
        if (texels_[t].best[family].error > error)
            rest.push_back(t);
    return rest;
}

// Those above the error, and at a smaller one those whose stand-ins mislead.
Solver::Selection Solver::doubtful(const Selection& selection, Family family, float error) const
{
    Selection rest;
    for (const uint32_t t : above(selection, family, kBroadError)) {
        const Shape lean = leanShape(texels_[t].task.mean);
        const float found = texels_[t].best[family].error;
        const bool broad = std::max(lean.sxx, lean.syy) > kBroad;
        const bool steep = lean.nx * lean.nx + lean.ny * lean.ny > kSteep && found > kSteepError;
        if (found > error || broad || steep)
            rest.push_back(t);
    }
    return rest;
}

void Solver::keep(const std::vector<Start>& starts, const std::vector<Found>& found, Family family)
{
    for (size_t i = 0; i < starts.size(); ++i) {
        Found& best = texels_[starts[i].texel].best[family];
        if (found[i].error < best.error)
            best = found[i];
    }
}

// The two best distinct minima of the mixture's error.
void Solver::chooseStarts(const Selection& selection, Family family)
{
    starts_.clear();
    for (const uint32_t t : selection) {
        const TexelTask& task = texels_[t].task;
        const Shape lean = leanShape(task.mean);
        texels_[t].start[0] = texels_[t].start[1] = {};
        if (scalarPower(lean) > kCompact * float(task.mean.energy)) {
            texels_[t].start[0] = {lean, 0.0f, 1.0f}; // one bump: nothing to choose
            continue;
        }
        starts_.push_back({t, lean});
        starts_.push_back({t, halfPower(task)});
        for (int i = 0; i < task.childCount; ++i)
            starts_.push_back({t, task.children[size_t(i)].shape});
    }
    run(starts_, family, Against::mixture, found_);
    for (size_t i = 0; i < starts_.size(); ++i) {
        Found* start = texels_[starts_[i].texel].start;
        const bool other = start[0].error < kNoError && distinct(found_[i].shape, start[0].shape);
        if (found_[i].error < start[0].error) {
            if (other)
                start[1] = start[0];
            start[0] = found_[i];
        } else if (other && found_[i].error < start[1].error) {
            start[1] = found_[i];
        }
    }
}

// From the best minimum of the mixture; where that does not settle it, from the second best too.
void Solver::searchExactly(const Selection& selection, Family family)
{
    Selection rest = selection;
    for (int rank = 0; rank < 2; ++rank) {
        starts_.clear();
        for (const uint32_t t : rest)
            if (texels_[t].start[rank].error < kNoError)
                starts_.push_back({t, texels_[t].start[rank].shape});
        run(starts_, family, Against::nodes, found_);
        keep(starts_, found_, family);
        rest = above(rest, family, kSettledError);
    }
}

// No closed form of the family may beat the fit: where one does, search on from it.
void Solver::searchClosedForms(const Selection& selection, Family family)
{
    const auto evaluate = [&](Shape (*form)(const Moments&)) {
        starts_.clear();
        for (const uint32_t t : selection) {
            const Shape shape = form(texels_[t].task.mean);
            starts_.push_back({t, family == kIsotropic ? isotropicShape(shape) : shape});
        }
        run(starts_, family, Against::nodesOnce, found_);
        std::vector<Start> better;
        for (size_t i = 0; i < starts_.size(); ++i)
            if (found_[i].error < texels_[starts_[i].texel].best[family].error)
                better.push_back(starts_[i]);
        keep(starts_, found_, family);
        run(better, family, Against::nodes, found_);
        keep(better, found_, family);
    };
    for (const auto form : {leanShape, toksvigShape, averageShape})
        evaluate(form);
}

void Solver::fitIsotropic(const Selection& selection)
{
    chooseStarts(selection, kIsotropic);
    searchExactly(selection, kIsotropic);
    searchClosedForms(doubtful(selection, kIsotropic, kHopelessError), kIsotropic);
}

void Solver::fitAnisotropic(const Selection& selection)
{
    chooseStarts(selection, kAnisotropic);
    searchExactly(selection, kAnisotropic);
    searchClosedForms(doubtful(selection, kAnisotropic, kHopelessError), kAnisotropic);
    // From the isotropic fit too, so that the result cannot be worse than it.
    const Selection hopeless = doubtful(selection, kAnisotropic, kTornError);
    fitIsotropic(hopeless);
    starts_.clear();
    for (const uint32_t t : hopeless) {
        Found* best = texels_[t].best;
        if (best[kIsotropic].error < best[kAnisotropic].error) {
            best[kAnisotropic] = best[kIsotropic];
            starts_.push_back({t, best[kIsotropic].shape});
        }
    }
    run(starts_, kAnisotropic, Against::nodes, found_);
    keep(starts_, found_, kAnisotropic);
}

} // namespace lumel::baker
