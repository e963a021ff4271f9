// Where the minimiser starts. The error has several minima as soon as the lobes
// under a texel stand apart (a V-groove has one on each flank and a broad one between), so one start is
// not enough. Every guess is first refined on a cheap approximation of the error (fit_mixture.inl); the
// two best minima found are then refined on the exact error, and the better result is kept.
#include "solver.h"

namespace lumel::baker {
namespace {

// Thresholds for retrying a search, as relative squared error E = <G - F, G - F> / <G, G>. Below kRetryError
// the average is one bump with a single minimum: all starts end there.
constexpr float kRetryError = 0.03f;
// The accuracy of the quadrature: below this E lobes cannot be ranked, and closed forms are not tried.
constexpr float kQuadratureError = 2e-4f;
// Where lobes are this broad (variance on the disc) or this tilted (|N.xy|^2), their Gaussian approximations
// are poor. Then a closed form or an isotropic lobe may win at a smaller E too: retry above these.
constexpr float kBroadVariance = 0.05f, kSteepTilt = 0.6f;
constexpr float kBroadRetryError = 1e-4f, kSteepRetryError = 0.01f;
// A closed form at least this narrow, relative to the mean lobe, means that the lobes overlap.
constexpr float kCompact = 0.7f;

// The talk's guess: under half of the finer power, never near 1.
Shape halfPower(const TexelTask& task)
{
    Shape shape = averageShape(task.mean);
    shape.sxx = shape.syy = std::min(2.2f / scalarPower(shape), 0.4f);
    shape.sxy = 0.0f;
    return shape;
}

// Do two lobes belong to different minima? Their normals lie half a lobe's width apart or their powers
// differ by half.
bool distinct(const Shape& a, const Shape& b)
{
    const float dx = a.nx - b.nx, dy = a.ny - b.ny, power = scalarPower(a), ratio = power / scalarPower(b);
    return (dx * dx + dy * dy) * power > 0.25f || ratio > 1.5f || ratio < 0.67f;
}

// Is a lobe too unlike a fit of this error to beat it, wherever its normal points? Functions on the disc form
// angles: with a = angle(G, fit), sin^2 a = E, a lobe at least 2 a away from the fit is at least a away from
// G. Of two Gaussians of covariances S and T, the cosine is at most 2 (det S det T)^(1/4) / sqrt(det(S + T)),
// and cos 2 a = 1 - 2 E. Broad lobes are no Gaussians and widths on the disc change with the normal, hence
// the margin and the limits.
bool widthsAreFarApart(const Shape& a, const Shape& b, float error)
{
    constexpr float kMarginOfGaussians = 1.5f;
    const float xx = a.sxx + b.sxx, xy = a.sxy + b.sxy, yy = a.syy + b.syy;
    if (xx + yy > 4.0f * kBroadVariance || b.nx * b.nx + b.ny * b.ny > kSteepTilt)
        return false;
    const float detA = a.sxx * a.syy - a.sxy * a.sxy, detB = b.sxx * b.syy - b.sxy * b.sxy;
    const float least = 1.0f - 2.0f * kMarginOfGaussians * error; // cosine of a lobe that may win
    if (least <= 0.0f)
        return false;
    // cosine < least, squared.
    return 4.0f * std::sqrt(detA * detB) < least * least * (xx * yy - xy * xy);
}

} // namespace

// The first start of the same texel, up to `index`, from which a search ends where it ends from this one.
size_t Solver::firstAlike(const std::vector<Start>& starts, size_t index, Family family)
{
    const auto shapeOf = [&](const Start& start) {
        return family == kIsotropic ? isotropicShape(start.shape) : start.shape;
    };
    size_t first = index;
    for (size_t i = index; i-- > 0 && starts[i].texel == starts[index].texel;)
        if (isAlike(shapeOf(starts[i]), shapeOf(starts[index])))
            first = i;
    return first;
}

Solver::Selection Solver::above(const Selection& selection, Family family, float error) const
{
    Selection rest;
    for (const uint32_t t : selection)
        if (texels_[t].best[family].error > error)
            rest.push_back(t);
    return rest;
}

// Those above the error, and at a smaller one those whose Gaussian approximations are poor.
Solver::Selection Solver::doubtful(const Selection& selection, Family family, float error) const
{
    Selection rest;
    for (const uint32_t t : above(selection, family, kBroadRetryError)) {
        const Shape& lean = texels_[t].lean;
        const float found = texels_[t].best[family].error;
        const bool broad = std::max(lean.sxx, lean.syy) > kBroadVariance;
        const bool steep = lean.nx * lean.nx + lean.ny * lean.ny > kSteepTilt && found > kSteepRetryError;
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
        const Shape& lean = texels_[t].lean;
        texels_[t].start[0] = texels_[t].start[1] = {};
        texels_[t].startsAtLean = false;
        if (scalarPower(lean) > kCompact * float(task.mean.energy)) {
            texels_[t].start[0] = {lean, 0.0f, 1.0f}; // one bump: nothing to choose
            texels_[t].startsAtLean = true;
            continue;
        }
        starts_.push_back({t, lean});
        starts_.push_back({t, halfPower(task)});
        for (int i = 0; i < task.childCount; ++i)
            starts_.push_back({t, task.children[size_t(i)].shape});
    }
    run(starts_, family, Against::children, found_);
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
        run(starts_, family, Against::average, found_);
        keep(starts_, found_, family);
        rest = above(rest, family, kRetryError);
    }
}

// The closed forms that may beat the best lobe so far, of the family or made isotropic.
void Solver::addClosedForms(uint32_t t, Family family)
{
    const Texel& texel = texels_[t];
    const TexelTask& task = texel.task;
    const auto ofFamily = [&](const Shape& shape) {
        return family == kIsotropic ? isotropicShape(shape) : shape;
    };
    const auto add = [&](const Shape& shape) { starts_.push_back({t, ofFamily(shape)}); };
    if (!texel.startsAtLean) // no search ends above its start
        add(texel.lean);
    add(toksvigShape(task.mean));
    const Shape average = averageShape(task.mean);
    if (widthsAreFarApart(ofFamily(average), texel.best[family].shape, texel.best[family].error))
        return;
    add(average);
    add({0.0f, 0.0f, average.sxx, average.sxy, average.syy}); // flat
    if (task.heights) {
        const glm::vec3 normal = task.heights->normal(task.level, task.x, task.y);
        add({normal.x, normal.y, average.sxx, average.sxy, average.syy});
    }
}

// No closed form may beat the fit: where one does, continue the search from it.
void Solver::searchClosedForms(const Selection& selection, Family family)
{
    starts_.clear();
    for (const uint32_t t : selection)
        addClosedForms(t, family);
    judge(starts_, found_);
    std::vector<Start> better;
    for (size_t i = 0; i < starts_.size(); ++i)
        if (found_[i].error < texels_[starts_[i].texel].best[family].error)
            better.push_back(starts_[i]);
    keep(starts_, found_, family);
    run(better, family, Against::average, found_);
    keep(better, found_, family);
}

// Mixtures misjudge E by about its product with the lobes' variance; an error below 0 shows that they do.
bool Solver::isGaussian(const Found& found) const
{
    constexpr float kMisjudged = 2.0f;
    const Shape& s = found.shape;
    return kMisjudged * found.error * std::max(s.sxx, s.syy) < options_.precision &&
           found.error > -kQuadratureError && s.nx * s.nx + s.ny * s.ny < kSteepTilt;
}

// The same for two lobes, whose overlaps are judged as those of one lobe with its error.
bool Solver::isGaussian(const FoundPair& pair, float oneLobe) const
{
    return pair.error > -kQuadratureError && isGaussian({pair.shape[0], oneLobe}) &&
           isGaussian({pair.shape[1], oneLobe});
}

// Are minima of the mixture no guide to those of the error?
bool Solver::isAstray(const Found& found) const
{
    const Shape& s = found.shape;
    return s.nx * s.nx + s.ny * s.ny > kSteepTilt || found.error < -kQuadratureError ||
           (std::max(s.sxx, s.syy) > kBroadVariance && found.error > kRetryError);
}

// Where lobes are no Gaussians, the search goes on at nodes.
void Solver::polish(const Selection& selection, bool isotropicToo)
{
    Selection polished, astray;
    for (const uint32_t t : selection) {
        Texel& texel = texels_[t];
        if (texel.listedCount == 0 ||
            (isGaussian(texel.best[kAnisotropic]) && (!isotropicToo || isGaussian(texel.best[kIsotropic]))))
            continue;
        addNodes(texel);
        if (isAstray(texel.best[kAnisotropic]) || (isotropicToo && isAstray(texel.best[kIsotropic]))) {
            astray.push_back(t);
            texel.best[kIsotropic] = texel.best[kAnisotropic] = {};
        } else {
            polished.push_back(t);
        }
    }
    fitAnisotropic(astray);
    if (isotropicToo)
        fitIsotropic(astray);
    for (const Family family : {kIsotropic, kAnisotropic}) {
        starts_.clear();
        for (const uint32_t t : polished) {
            Found& best = texels_[t].best[family];
            if (best.error < kNoError)
                starts_.push_back({t, best.shape});
            best = {};
        }
        run(starts_, family, Against::average, found_);
        keep(starts_, found_, family);
        if (family == kIsotropic && !isotropicToo)
            continue;
        searchClosedForms(above(polished, family, kQuadratureError), family);
    }
    keepIsotropic(polished);
}

// Where the lobe of the moments is good enough, it stays.
Solver::Selection Solver::settle(const Selection& selection, Family family)
{
    if (options_.precision <= 0.0f)
        return selection;
    starts_.clear();
    for (const uint32_t t : selection) {
        const Shape& lean = texels_[t].lean;
        starts_.push_back({t, family == kIsotropic ? isotropicShape(lean) : lean});
    }
    judge(starts_, found_);
    keep(starts_, found_, family);
    if (family == kAnisotropic)
        for (size_t i = 0; i < starts_.size(); ++i)
            texels_[starts_[i].texel].leanError = found_[i].error;
    return above(selection, family, options_.precision);
}

void Solver::mergeLists(const Selection& selection)
{
    // What a list may lose, of the precision; errors of neighbours add up on coarser levels.
    constexpr float kShare = 0.05f;
    for (const uint32_t t : selection)
        if (texels_[t].task.list && std::abs(texels_[t].leanError) < kShare * options_.precision)
            texels_[t].task.list->merge(texels_[t].lean);
}

// P from the mean lobe's and from LEAN's, with the mean normal.
void Solver::fitPowers(const Selection& selection, Family family)
{
    starts_.clear();
    for (const uint32_t t : selection) {
        const Shape average = averageShape(texels_[t].task.mean), &lean = texels_[t].lean;
        starts_.push_back({t, average});
        starts_.push_back({t, {average.nx, average.ny, lean.sxx, lean.sxy, lean.syy}});
    }
    run(starts_, family, Against::average, found_);
    keep(starts_, found_, family);
    starts_.clear();
    for (const uint32_t t : selection) {
        Texel& texel = texels_[t];
        if (texel.listedCount == 0 || isGaussian(texel.best[family]))
            continue;
        addNodes(texel);
        starts_.push_back({t, texel.best[family].shape});
        texel.best[family] = {};
    }
    run(starts_, family, Against::average, found_);
    keep(starts_, found_, family);
}

void Solver::fitIsotropic(const Selection& selection)
{
    chooseStarts(selection, kIsotropic);
    searchExactly(selection, kIsotropic);
    searchClosedForms(above(selection, kIsotropic, kQuadratureError), kIsotropic);
}

void Solver::fitAnisotropic(const Selection& selection)
{
    chooseStarts(selection, kAnisotropic);
    searchExactly(selection, kAnisotropic);
    searchClosedForms(above(selection, kAnisotropic, kQuadratureError), kAnisotropic);
    // Retry from the isotropic fit, so that the result is never worse than it.
    const Selection retried = doubtful(selection, kAnisotropic, kRetryError);
    fitIsotropic(retried);
    keepIsotropic(retried);
}

// An isotropic lobe that is better than the anisotropic one, and a search from it.
void Solver::keepIsotropic(const Selection& selection)
{
    starts_.clear();
    for (const uint32_t t : selection) {
        Found* best = texels_[t].best;
        if (best[kIsotropic].error < best[kAnisotropic].error) {
            best[kAnisotropic] = best[kIsotropic];
            starts_.push_back({t, best[kIsotropic].shape});
        }
    }
    run(starts_, kAnisotropic, Against::average, found_);
    keep(starts_, found_, kAnisotropic);
}

} // namespace lumel::baker
