#include "solver.h"
#include "profile.h"
#include "shared/limits.h"

namespace lumel::baker {

void TexelTask::addChild(const Moments& part, double share)
{
    children[size_t(childCount++)] = {leanShape(part), float(luminance(part.ks)), float(share)};
}

Solver::Solver(const Options& options, const Source& source)
    : kernels_(kernels()), options_(options), coloured_(source.colouredSpecular()), averager_(source, false)
{
}

void Solver::add(const TexelTask& task, const Cell& cell)
{
    Texel texel;
    texel.task = task;
    texel.firstNode = nodes_.size();
    texel.nodeCount = 0;
    if (cell.list.empty())
        addPatch(texel, cell);
    else
        addList(texel, cell);
    // No fit needs to be narrower than the narrowest lobe under the texel; the margin lets the minimiser
    // overshoot.
    const double narrowest = 1.1 * std::max(1.0, task.mean.maxPower);
    texel.maxLog = float(0.5 * std::log(narrowest - double(kBase)));
    if (!task.fixed)
        texel.lean = cell.list.empty() ? leanShape(task.mean) : cell.list.matchedShape();
    addChildren(texel);
    texels_.push_back(texel);
}

void Solver::addPatch(Texel& texel, const Cell& cell)
{
    texel.firstNode = nodes_.size();
    cell.patch.appendTo(nodes_, channelWeight_, float(1.0 / cell.sum.weight), channels());
    texel.nodeCount = nodes_.size() - texel.firstNode;
    texel.energy = std::max(float(weighNodes(texel.firstNode)), 1e-30f);
}

void Solver::addNodes(Texel& texel)
{
    const StepTimer timer(options_.profile, Step::sums);
    lobes_.resize(texel.listedCount);
    members_.clear();
    cell_.clear();
    for (size_t i = 0; i < texel.listedCount; ++i) {
        listedLobes_[texel.firstListed + i].store(lobes_, i);
        members_.push_back({uint32_t(i), listedLobes_[texel.firstListed + i].area});
        cell_.add(lobes_, i, double(members_.back().area));
    }
    averager_.average(lobes_, members_, nullptr, false, cell_);
    addPatch(texel, cell_);
    texel.listedCount = 0;
}

// The lobes themselves as Gaussians.
void Solver::addList(Texel& texel, const Cell& cell)
{
    const bool black = luminance(texel.task.mean.ks) <= 0.0;
    texel.firstListed = listed_.size();
    texel.listedCount = cell.list.lobes().size();
    for (const ListedLobe& lobe : cell.list.lobes())
        listed_.push_back(termOf(lobe, float(cell.sum.weight), black));
    listedLobes_.insert(listedLobes_.end(), cell.list.lobes().begin(), cell.list.lobes().end());
    texel.energy =
        std::max(kernels_.mixtureEnergy(&listed_[texel.firstListed], int(texel.listedCount)), 1e-30f);
}

// Weights of the nodes from `first` on: area * G. Returns <G, G>.
double Solver::weighNodes(size_t first)
{
    const size_t end = nodes_.size(); // whole vectors after `first`
    weight_.resize(end);
    const float* area = nodes_.area.data();
    float* weight = weight_.data();
    if (coloured_)
        for (size_t k = first; k < end; ++k)
            weight[k] = float(luminance({channelWeight_[0][k], channelWeight_[1][k], channelWeight_[2][k]}));
    const float* g = coloured_ ? weight : channelWeight_[0].data();
    constexpr size_t kSums = 8; // side by side, for the compiler to vectorise
    float sums[kSums] = {};
    for (size_t k = first; k < end; k += kSums)
        for (size_t i = 0; i < kSums; ++i) {
            const float value = g[k + i], weighted = area[k + i] * value;
            sums[i] += weighted * value;
            weight[k + i] = weighted;
        }
    if (coloured_)
        for (int c = 0; c < channels(); ++c)
            for (size_t k = first; k < end; ++k)
                channelWeight_[c][k] *= area[k];
    double energy = 0.0;
    for (const float sum : sums)
        energy += sum;
    return energy;
}

// The finer level's lobes as Gaussians.
void Solver::addChildren(Texel& texel)
{
    const TexelTask& task = texel.task;
    texel.firstTerm = terms_.size();
    const bool black = luminance(task.mean.ks) <= 0.0;
    const auto addTerm = [&](const TexelTask::Child& child) {
        const Shape& s = child.shape;
        const float nz = std::sqrt(std::max(1e-4f, 1.0f - s.nx * s.nx - s.ny * s.ny));
        terms_.push_back(termOf({s, nz, child.share, {child.ks, child.ks, child.ks}}, 1.0f, black));
    };
    for (int i = 0; i < task.childCount; ++i)
        addTerm(task.children[size_t(i)]);
    texel.firstFiner = task.finerCount > 0 ? terms_.size() : texel.firstTerm;
    texel.finerCount = size_t(task.finerCount > 0 ? task.finerCount : task.childCount);
    for (int i = 0; i < task.finerCount; ++i)
        addTerm(task.finer(i));
}

FitJob Solver::jobOf(const Start& start, Family family, Against against) const
{
    const Texel& t = texels_[start.texel];
    const size_t n = t.firstNode;
    FitJob job;
    if (t.nodeCount > 0)
        job.nodes = {int(t.nodeCount), &nodes_.x[n], &nodes_.y[n], &nodes_.z[n], &weight_[n]};
    const bool whole = against == Against::average && t.nodeCount == 0;
    job.mixture = whole ? listed_.data() + t.firstListed : terms_.data() + t.firstTerm;
    job.mixtureCount = whole ? int(t.listedCount) : t.task.childCount;
    job.energy = t.energy;
    job.maxLog = t.maxLog;
    toUnknowns(family == kIsotropic ? isotropicShape(start.shape) : start.shape, job.maxLog, job.unknowns);
    if (options_.method == Method::fitPower) // no step moves N
        job.unknowns[kB11] = job.unknowns[kB21] = job.unknowns[kB22] = 0.0f;
    return job;
}

// For searches against mixtures of so many terms.
void Solver::reserveScratch(int terms)
{
    constexpr size_t kPerTerm = 7 * kMaxLanes;
    scratch_.resize(std::max(scratch_.size(), kPerTerm * size_t(terms)));
}

void Solver::run(const std::vector<Start>& starts, Family family, Against against, std::vector<Found>& found)
{
    const StepTimer timer(options_.profile, against == Against::children ? Step::starts : Step::searches);
    const size_t count = starts.size();
    jobs_.resize(count);
    order_.clear();
    std::vector<FitJob*> mixtures;
    std::vector<size_t> same(count);
    for (size_t i = 0; i < count; ++i) {
        same[i] = firstAlike(starts, i, family);
        if (same[i] != i)
            continue;
        FitJob& job = jobs_[i] = jobOf(starts[i], family, against);
        const bool onNodes = against == Against::average && job.nodes.count > 0;
        (onNodes ? order_ : mixtures).push_back(&job);
    }
    // Similar sizes together: the lanes of a group process their terms in lockstep.
    std::ranges::stable_sort(mixtures, std::greater(), [](const FitJob* job) { return job->mixtureCount; });
    if (!mixtures.empty())
        reserveScratch(mixtures.front()->mixtureCount);
    SearchSettings settings;
    settings.isotropic = family == kIsotropic;
    kernels_.minimise(order_.data(), int(order_.size()), settings);
    if (against == Against::children)
        settings.maxEvaluations = 30;
    kernels_.minimiseMixtures(mixtures.data(), int(mixtures.size()), settings, scratch_.data());
    found.resize(count);
    std::vector<Start> clampedStarts;
    std::vector<size_t> clampedIndices;
    for (size_t i = 0; i < count; ++i) {
        if (same[i] != i)
            continue;
        found[i] = {starts[i].shape, jobs_[i].error, jobs_[i].norm};
        bool clamped = false;
        found[i].shape = fromUnknowns(jobs_[i].unknowns, jobs_[i].maxLog, clamped);
        if (clamped && against == Against::average) {
            clampedStarts.push_back({starts[i].texel, found[i].shape});
            clampedIndices.push_back(i);
        }
    }
    if (!clampedStarts.empty()) {
        std::vector<Found> evaluated;
        judge(clampedStarts, evaluated);
        for (size_t i = 0; i < evaluated.size(); ++i)
            found[clampedIndices[i]] = evaluated[i];
    }
    for (size_t i = 0; i < count; ++i)
        found[i] = found[same[i]];
}

// On nodes by a kernel of its own; against lists by a search that ends where it starts.
void Solver::judge(const std::vector<Start>& starts, std::vector<Found>& found)
{
    const StepTimer timer(options_.profile, Step::closedForms);
    found.resize(starts.size());
    std::vector<Start> onNodes;
    std::vector<size_t> nodeIndices, listIndices;
    std::vector<FitJob> jobs;
    jobs.reserve(starts.size());
    size_t most = 1;
    for (size_t i = 0; i < starts.size(); ++i) {
        const Texel& t = texels_[starts[i].texel];
        if (t.listedCount == 0) {
            onNodes.push_back(starts[i]);
            nodeIndices.push_back(i);
            continue;
        }
        jobs.push_back(jobOf(starts[i], kAnisotropic, Against::average));
        listIndices.push_back(i);
        most = std::max(most, t.listedCount);
    }
    order_.clear();
    for (FitJob& job : jobs)
        order_.push_back(&job);
    reserveScratch(int(most));
    SearchSettings once;
    once.isotropic = false;
    once.maxEvaluations = 1;
    kernels_.minimiseMixtures(order_.data(), int(order_.size()), once, scratch_.data());
    for (size_t i = 0; i < jobs.size(); ++i)
        found[listIndices[i]] = {starts[listIndices[i]].shape, jobs[i].error, jobs[i].norm};
    std::vector<Found> judged;
    judgeOnNodes(onNodes, judged);
    for (size_t i = 0; i < judged.size(); ++i)
        found[nodeIndices[i]] = judged[i];
}

void Solver::judgeOnNodes(const std::vector<Start>& starts, std::vector<Found>& found)
{
    trials_.resize(starts.size());
    for (size_t i = 0; i < starts.size(); ++i) {
        const Texel& t = texels_[starts[i].texel];
        const Shape& s = starts[i].shape;
        const size_t n = t.firstNode;
        const float inverseDet = 1.0f / (s.sxx * s.syy - s.sxy * s.sxy);
        trials_[i] = {{int(t.nodeCount), &nodes_.x[n], &nodes_.y[n], &nodes_.z[n], &weight_[n]},
                      t.energy,
                      s.nx,
                      s.ny,
                      s.syy * inverseDet,
                      -s.sxy * inverseDet,
                      s.sxx * inverseDet,
                      1.0f,
                      1.0f};
    }
    kernels_.judge(trials_.data(), int(trials_.size()));
    found.resize(starts.size());
    for (size_t i = 0; i < starts.size(); ++i)
        found[i] = {starts[i].shape, trials_[i].error, trials_[i].norm};
}

void Solver::solve()
{
    const StepTimer timer(options_.profile, Step::closedForms);
    const bool closedForm = !isFitted(options_.method);
    Selection selection;
    starts_.clear();
    for (size_t t = 0; t < texels_.size(); ++t)
        if (texels_[t].task.fixed)
            starts_.push_back({uint32_t(t), texels_[t].task.shape});
        else
            selection.push_back(uint32_t(t));
    judge(starts_, found_);
    keep(starts_, found_, kAnisotropic);
    for (const Start& s : starts_)
        texels_[s.texel].best[kIsotropic] = texels_[s.texel].best[kAnisotropic];
    const bool isotropic = options_.model == Model::blinnPhong && !closedForm;
    if (options_.method == Method::fitPower) {
        fitPowers(selection, kAnisotropic);
        if (isotropic)
            fitPowers(selection, kIsotropic);
    } else {
        fitAnisotropic(settle(selection, kAnisotropic));
        if (isotropic)
            fitIsotropic(settle(selection, kIsotropic));
        polish(selection, isotropic);
        mergeLists(selection);
    }
    writeSingles(isotropic ? kIsotropic : kAnisotropic);
    // This may put nodes in place of lists, so single lobes are written before.
    if (options_.lobes != LobeCount::one)
        fitPairs(selection, isotropic ? kIsotropic : kAnisotropic);
    for (const Texel& texel : texels_)
        if (texel.pair.error < kNoError)
            writePair(texel);
    texels_.clear();
    terms_.clear();
    listed_.clear();
    listedLobes_.clear();
    nodes_.clear();
    for (auto* v : {&weight_, channelWeight_, channelWeight_ + 1, channelWeight_ + 2})
        v->clear();
}

void Solver::writeSingles(Family family)
{
    const StepTimer timer(options_.profile, Step::output);
    for (const Texel& texel : texels_) {
        const bool ownKs = texel.task.uniform || (texel.task.fixed && !options_.bestKs);
        write(texel, texel.best[family], texel.task.texel, ownKs);
        if (texel.task.oneLobe)
            write(texel, texel.best[kAnisotropic], texel.task.oneLobe, ownKs);
    }
}

void Solver::write(const Texel& texel, const Found& found, float* t, bool ownKs)
{
    const Shape& shape = found.shape;
    t[kNx] = shape.nx;
    t[kNy] = shape.ny;
    t[kSxx] = shape.sxx;
    t[kSxy] = shape.sxy;
    t[kSyy] = shape.syy;
    writeSpecular(texel, found, t, ownKs);
    writeDiffuse(texel.task, normalOf(shape), t);
}

void Solver::writeDiffuse(const TexelTask& task, const glm::dvec3& normal, float* t)
{
    const glm::vec3 kd = diffuseAlong(normal, task.mean);
    std::copy_n(&kd.x, 3, t + kKdR);
}

// Its values of Ks 1 at the texel's nodes, into the scratch.
void Solver::sampleShape(const Texel& texel, const Shape& shape)
{
    const Sym2 p = Sym2{shape.sxx, shape.sxy, shape.syy}.inverse();
    const float nz = std::sqrt(std::max(1e-4f, 1.0f - shape.nx * shape.nx - shape.ny * shape.ny));
    const LobeTerm lobe{
        shape.nx, shape.ny, nz, float(p.xx), float(p.xy), float(p.yy), float(std::sqrt(p.det()))};
    const size_t n = texel.firstNode;
    if (scratch_.size() < texel.nodeCount)
        scratch_.resize(texel.nodeCount);
    std::fill_n(scratch_.begin(), texel.nodeCount, 0.0f);
    kernels_.average(&lobe, 1, false,
                     {int(texel.nodeCount), &nodes_.x[n], &nodes_.y[n], &nodes_.z[n], nullptr},
                     scratch_.data());
}

// Ks by projection, <G, f> / <f, f>, or the mean (`ownKs`); E with that Ks.
void Solver::writeSpecular(const Texel& texel, const Found& found, float* t, bool ownKs)
{
    const TexelTask& task = texel.task;
    const double meanKs = luminance(task.mean.ks);
    if (meanKs <= 0.0) { // black: no error
        t[kKsR] = t[kKsG] = t[kKsB] = t[kError] = 0.0f;
        return;
    }
    const double norm = found.norm, energy = texel.energy;
    const double overlap = std::sqrt(std::max(0.0, 1.0 - double(found.error)) * energy * norm);
    const double ks = ownKs ? meanKs : overlap / norm;
    t[kError] =
        task.uniform ? 0.0f : float(std::max(0.0, (energy - 2.0 * ks * overlap + ks * ks * norm) / energy));
    for (int c = 0; c < 3; ++c)
        t[kKsR + c] = float(ownKs ? task.mean.ks[c] : ks * task.mean.ks[c] / meanKs);
    if (!coloured_ || ownKs)
        return;
    // Each channel by a projection of its own: f at the nodes once, then three sums.
    const Shape& shape = found.shape;
    if (texel.nodeCount == 0) {
        projectColours(texel, shape, ks, t);
        return;
    }
    sampleShape(texel, shape);
    for (int c = 0; c < 3; ++c) {
        double channelOverlap = 0.0;
        for (size_t k = 0; k < texel.nodeCount; ++k)
            channelOverlap += double(channelWeight_[c][texel.firstNode + k]) * scratch_[k];
        t[kKsR + c] = float(channelOverlap / norm);
    }
}

// Each channel's projection is to that of the luminance as its overlap with the lobe.
void Solver::projectColours(const Texel& texel, const Shape& shape, double ks, float* t)
{
    const float nz = std::sqrt(std::max(1e-4f, 1.0f - shape.nx * shape.nx - shape.ny * shape.ny));
    if (scratch_.size() < texel.listedCount)
        scratch_.resize(texel.listedCount);
    kernels_.mixtureOverlaps(&listed_[texel.firstListed], int(texel.listedCount),
                             termOf({shape, nz, 1.0f, {1.0f, 1.0f, 1.0f}}, 1.0f, false), scratch_.data());
    double sum = 0.0, sums[3] = {};
    for (size_t i = 0; i < texel.listedCount; ++i) {
        const float* colour = listedLobes_[texel.firstListed + i].ks;
        const double overlap = scratch_[i], whole = luminance({colour[0], colour[1], colour[2]});
        sum += overlap;
        for (int c = 0; c < 3 && whole > 0.0; ++c)
            sums[c] += overlap * double(colour[c]) / whole;
    }
    for (int c = 0; c < 3; ++c)
        t[kKsR + c] = float(ks * sums[c] / std::max(sum, 1e-30));
}

} // namespace lumel::baker
