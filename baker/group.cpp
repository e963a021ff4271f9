#include "group.h"
#include "shared/limits.h"

namespace lumel::baker {
namespace {

constexpr size_t kChunk = 64; // lobes averaged at a time: their parameters stay in the first-level cache

// The minimiser's unknowns for a lobe, and the unit in which its normal moves.
void toUnknowns(const Shape& shape, float maxLog, double floor, LaneArray& rows, int lane)
{
    const Sym2 s = clampPowers({shape.sxx, shape.sxy, shape.syy});
    Sym2 p = s.inverse();
    // P - I = U^T U, at least `floor`.
    const double u11 = std::sqrt(std::max(p.xx - 1.0, floor));
    const double u12 = p.xy / u11;
    const double u22 = std::sqrt(std::max(p.yy - 1.0 - u12 * u12, floor));
    rows.at(kX, lane) = shape.nx;
    rows.at(kY, lane) = shape.ny;
    rows.at(kL1, lane) = std::min(float(std::log(u11)), maxLog);
    rows.at(kL2, lane) = std::min(float(std::log(u22)), maxLog);
    rows.at(kL3, lane) = float(u12 / u22);
    const double r2 = std::min(0.98, double(shape.nx) * shape.nx + double(shape.ny) * shape.ny);
    const Sym2 d = DiscFrame({shape.nx, shape.ny, std::sqrt(1.0 - r2)}).toDisc(s);
    const double b11 = std::sqrt(d.xx), b21 = d.xy / b11;
    rows.at(kB11, lane) = float(b11);
    rows.at(kB21, lane) = float(b21);
    rows.at(kB22, lane) = float(std::sqrt(std::max(d.yy - b21 * b21, 1e-10)));
}

Shape fromUnknowns(LaneArray& rows, int lane)
{
    const double e1 = std::exp(double(rows.at(kL1, lane))), e2 = std::exp(double(rows.at(kL2, lane)));
    const double shear = double(rows.at(kL3, lane)) * e2;
    const Sym2 p{1.0 + e1 * e1, e1 * shear, 1.0 + e2 * e2 + shear * shear};
    const Sym2 s = clampPowers(p.inverse());
    return {rows.at(kX, lane), rows.at(kY, lane), float(s.xx), float(s.xy), float(s.yy)};
}

} // namespace

Group::Group(const Options& options, bool isotropicBase, bool colouredSpecular)
    : kernels_(kernels()), options_(options), isotropicBase_(isotropicBase), coloured_(colouredSpecular)
{
}

void Group::begin(int count, size_t nodes)
{
    count_ = count;
    nodes_ = nodes;
    for (LaneArray* a : {&x_, &y_, &z_, &area_, &weight_, g_, g_ + 1, g_ + 2}) {
        a->resize(nodes, lanes());
        std::fill_n(a->data(), nodes * size_t(lanes()), a == &z_ ? 1.0f : 0.0f);
    }
    unknowns_.resize(kUnknowns, lanes());
    for (LaneArray& a : batch_)
        a.resize(kChunk, lanes());
}

void Group::setNodes(int lane, const std::vector<Node>& nodes)
{
    for (size_t k = 0; k < nodes.size(); ++k) {
        x_.at(k, lane) = nodes[k].x;
        y_.at(k, lane) = nodes[k].y;
        z_.at(k, lane) = nodes[k].z;
        area_.at(k, lane) = nodes[k].area;
    }
}

void Group::setAveragedNodes(int lane, const std::vector<Node>& nodes, const float* const* average)
{
    setNodes(lane, nodes);
    for (int c = 0; c < channels(); ++c)
        for (size_t k = 0; k < nodes.size(); ++k)
            g_[c].at(k, lane) = average[c][k];
}

void Group::average(const Lobes& lobes, const std::vector<Member>* members)
{
    size_t most = 0;
    for (int lane = 0; lane < count_; ++lane)
        most = std::max(most, members[lane].size());
    for (size_t first = 0; first < most; first += kChunk)
        averageChunk(lobes, members, first, std::min(kChunk, most - first));
}

void Group::averageChunk(const Lobes& lobes, const std::vector<Member>* members, size_t first, size_t count)
{
    LobeBatch batch;
    batch.count = int(count);
    batch.isotropic = isotropicBase_;
    for (int lane = 0; lane < lanes(); ++lane) {
        const bool black = lane < count_ && luminance(tasks_[size_t(lane)].mean.ks) <= 0.0;
        for (size_t i = 0; i < count; ++i) {
            const bool present = lane < count_ && first + i < members[lane].size();
            if (!present) { // a lobe of no weight
                for (int j = 0; j < 9; ++j)
                    batch_[j].at(i, lane) = j == 2 || j == 3 || j == 5 ? 1.0f : 0.0f;
                continue;
            }
            const Member member = members[lane][first + i];
            const size_t m = member.lobe;
            const float inverseDet = 1.0f / (lobes.sxx[m] * lobes.syy[m] - lobes.sxy[m] * lobes.sxy[m]);
            batch_[0].at(i, lane) = lobes.nx[m];
            batch_[1].at(i, lane) = lobes.ny[m];
            batch_[2].at(i, lane) = lobes.nz[m];
            batch_[3].at(i, lane) = lobes.syy[m] * inverseDet;
            batch_[4].at(i, lane) = -lobes.sxy[m] * inverseDet;
            batch_[5].at(i, lane) = lobes.sxx[m] * inverseDet;
            const float scale = member.share * std::sqrt(inverseDet);
            if (coloured_ && !black)
                for (int c = 0; c < 3; ++c)
                    batch_[6 + c].at(i, lane) = scale * lobes.ks[c][m];
            else {
                const double ks = luminance({lobes.ks[0][m], lobes.ks[1][m], lobes.ks[2][m]});
                for (int c = 0; c < 3; ++c)
                    batch_[6 + c].at(i, lane) = black ? scale : scale * float(ks);
            }
        }
    }
    batch.nx = batch_[0].data();
    batch.ny = batch_[1].data();
    batch.nz = batch_[2].data();
    batch.pxx = batch_[3].data();
    batch.pxy = batch_[4].data();
    batch.pyy = batch_[5].data();
    const NodeBlock nodes{int(nodes_), x_.data(), y_.data(), z_.data(), area_.data()};
    for (int c = 0; c < channels(); ++c) {
        batch.amplitude = batch_[6 + c].data();
        kernels_.average(batch, nodes, g_[c].data());
    }
}

// Weights of the sums over nodes: area * G, and the energy <G, G> of each lane.
void Group::weighNodes()
{
    energy_.fill(0.0f);
    std::array<double, kMaxLanes> energy{};
    for (size_t k = 0; k < nodes_; ++k)
        for (int lane = 0; lane < lanes(); ++lane) {
            const float g = coloured_
                                ? float(luminance({g_[0].at(k, lane), g_[1].at(k, lane), g_[2].at(k, lane)}))
                                : g_[0].at(k, lane);
            const float w = area_.at(k, lane) * g;
            weight_.at(k, lane) = w;
            energy[size_t(lane)] += double(w) * g;
        }
    for (int lane = 0; lane < lanes(); ++lane) {
        energy_[size_t(lane)] = std::max(float(energy[size_t(lane)]), 1e-30f);
        const Moments& mean = tasks_[size_t(lane < count_ ? lane : 0)].mean;
        // No fit needs to be narrower than the narrowest lobe it stands for; a little room for the
        // minimiser to cross on its way.
        const double widest = std::max(1.1, 1.1 * mean.maxPower) - 1.0;
        maxLog_[size_t(lane)] = float(0.5 * std::log(std::max(widest, 0.02)));
    }
}

FitProblem Group::problem(bool isotropic)
{
    FitProblem p;
    p.nodes = {int(nodes_), x_.data(), y_.data(), z_.data(), weight_.data()};
    p.mixture = {mixtureCount_,      mixture_[0].data(), mixture_[1].data(), mixture_[2].data(),
                 mixture_[3].data(), mixture_[4].data(), mixture_[5].data(), mixture_[6].data()};
    p.energy = energy_.data();
    p.maxLog = maxLog_.data();
    p.isotropic = isotropic;
    return p;
}

void Group::evaluateShape(const Shape* shapes, float* overlap, float* norm)
{
    for (int lane = 0; lane < lanes(); ++lane)
        toUnknowns(shapes[lane < count_ ? lane : 0], 1e9f, 1e-6, unknowns_, lane);
    FitProblem p = problem(false);
    std::array<float, kMaxLanes> noLimit;
    noLimit.fill(10.0f);
    p.maxLog = noLimit.data();
    kernels_.evaluate(p, unknowns_.data(), overlap, norm, nullptr);
}

void Group::consider(const Shape* shapes)
{
    alignas(64) float overlap[kMaxLanes], norm[kMaxLanes];
    evaluateShape(shapes, overlap, norm);
    for (size_t lane = 0; lane < size_t(count_); ++lane) {
        const float error = 1.0f - overlap[lane] * overlap[lane] / (energy_[lane] * norm[lane]);
        if (error < bestError_[lane]) {
            best_[lane] = shapes[lane];
            bestError_[lane] = error;
        }
    }
}

void Group::search(Shape* shapes, float* errors, bool isotropic, bool exact)
{
    for (int lane = 0; lane < lanes(); ++lane) {
        const Shape& start = shapes[lane < count_ ? lane : 0];
        // A lobe at the lowest power starts a little above it: there the gradient is alive.
        toUnknowns(isotropic ? isotropicShape(start) : start, maxLog_[size_t(lane)], 0.02, unknowns_, lane);
    }
    FitProblem p = problem(isotropic);
    alignas(64) float found[kMaxLanes];
    if (exact)
        kernels_.minimise(p, unknowns_.data(), found);
    else
        kernels_.minimiseMixture(p, unknowns_.data(), found);
    for (int lane = 0; lane < count_; ++lane) {
        const size_t l = size_t(lane);
        shapes[l] = fromUnknowns(unknowns_, lane);
        errors[l] = found[l];
        if (exact && found[l] < bestError_[l]) {
            best_[l] = shapes[l];
            bestError_[l] = found[l];
        }
    }
}

// The finer level's lobes as Gaussians. Lanes with fewer of them are padded with weightless ones.
void Group::buildMixture()
{
    mixtureCount_ = 0;
    for (size_t lane = 0; lane < size_t(count_); ++lane)
        mixtureCount_ = std::max(mixtureCount_, tasks_[lane].childCount);
    for (LaneArray& a : mixture_)
        a.resize(size_t(mixtureCount_), lanes());
    for (int lane = 0; lane < lanes(); ++lane) {
        const TexelTask& task = tasks_[size_t(lane < count_ ? lane : 0)];
        const bool black = luminance(task.mean.ks) <= 0.0;
        for (size_t i = 0; i < size_t(mixtureCount_); ++i) {
            const bool present = int(i) < task.childCount;
            const TexelTask::Child child = present ? task.children[i] : task.children[0];
            const Shape& s = child.shape;
            const float nz = std::sqrt(std::max(1e-4f, 1.0f - s.nx * s.nx - s.ny * s.ny));
            const float ks = black ? 1.0f : child.ks;
            const float row[7] = {
                s.nx, s.ny, nz, s.sxx, s.sxy, s.syy, present ? child.share * ks * nz : 0.0f};
            for (int j = 0; j < 7; ++j)
                mixture_[j].at(i, lane) = row[j];
        }
    }
}

void Group::write(bool closedForm)
{
    alignas(64) float overlap[kMaxLanes], norm[kMaxLanes];
    evaluateShape(best_.data(), overlap, norm);
    float channelOverlap[3][kMaxLanes];
    for (int c = 0; coloured_ && c < 3; ++c) {
        // <G_c, f>: the same sum with the channel's own average.
        for (size_t k = 0; k < nodes_ * size_t(lanes()); ++k)
            weight_.data()[k] = area_.data()[k] * g_[c].data()[k];
        alignas(64) float ignored[kMaxLanes];
        evaluateShape(best_.data(), channelOverlap[c], ignored);
    }
    for (size_t lane = 0; lane < size_t(count_); ++lane) {
        const TexelTask& task = tasks_[lane];
        const Shape& shape = best_[lane];
        float* t = task.texel;
        t[kNx] = shape.nx;
        t[kNy] = shape.ny;
        t[kSxx] = shape.sxx;
        t[kSxy] = shape.sxy;
        t[kSyy] = shape.syy;
        const double meanKs = luminance(task.mean.ks);
        const bool asGiven = closedForm || task.uniform;
        double ks = asGiven ? meanKs : double(overlap[lane]) / norm[lane];
        const bool black = meanKs <= 0.0;
        for (int c = 0; c < 3; ++c)
            t[kKsR + c] = float(black       ? 0.0
                                : asGiven   ? task.mean.ks[c]
                                : coloured_ ? channelOverlap[c][lane] / norm[lane]
                                            : ks * task.mean.ks[c] / meanKs);
        if (black)
            ks = double(overlap[lane]) / norm[lane];
        const double a = energy_[lane];
        t[kError] = black || task.uniform
                        ? 0.0f
                        : float(std::max(0.0, (a - 2.0 * ks * overlap[lane] + ks * ks * norm[lane]) / a));
        const double nz =
            std::sqrt(std::max(0.0, 1.0 - double(shape.nx) * shape.nx - double(shape.ny) * shape.ny));
        for (int c = 0; c < 3; ++c)
            t[kKdR + c] =
                float(std::max(0.0, glm::dot(task.mean.kdNormal[c], glm::dvec3(shape.nx, shape.ny, nz))));
    }
}

void Group::finish()
{
    weighNodes();
    const bool closedForm = options_.method != Method::fit;
    if (closedForm)
        for (size_t lane = 0; lane < size_t(count_); ++lane)
            best_[lane] = tasks_[lane].shape;
    else
        fit();
    for (size_t lane = 0; lane < size_t(count_); ++lane)
        if (tasks_[lane].uniform && !closedForm)
            best_[lane] = tasks_[lane].shape;
    write(closedForm);
}

} // namespace lumel::baker
