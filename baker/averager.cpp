#include "averager.h"
#include "solver.h"

namespace lumel::baker {

Averager::Averager(const Source& source, bool isotropic)
    : kernels_(kernels()), isotropic_(isotropic), channels_(source.colouredSpecular() ? 3 : 1)
{
}

// The lobe as the kernels take it; its amplitude for each channel.
LobeTerm Averager::term(const Lobes& lobes, const Member& member, bool black, float* amplitudes) const
{
    const size_t m = member.lobe;
    const float inverseDet = 1.0f / (lobes.sxx[m] * lobes.syy[m] - lobes.sxy[m] * lobes.sxy[m]);
    const float energy = member.area * std::sqrt(inverseDet);
    for (int c = 0; c < channels_; ++c) {
        const float ks = black ? 1.0f
                         : channels_ == 3
                             ? lobes.ks[c][m]
                             : float(luminance({lobes.ks[0][m], lobes.ks[1][m], lobes.ks[2][m]}));
        amplitudes[c] = energy * ks;
    }
    return {lobes.nx[m],
            lobes.ny[m],
            lobes.nz[m],
            lobes.syy[m] * inverseDet,
            -lobes.sxy[m] * inverseDet,
            lobes.sxx[m] * inverseDet,
            amplitudes[0]};
}

bool Averager::reachesRim(const Lobes& lobes, const std::vector<Member>& members, double power)
{
    if (power > kRimRulePower)
        return false;
    for (const Member& member : members) {
        const double nz = lobes.nz[member.lobe], r2 = 1.0 - nz * nz;
        if (r2 > 0.5 && power * std::log(r2) > -7.0)
            return true;
    }
    return false;
}

void Averager::gather(const Lobes& lobes, const std::vector<Member>& members, const Nodes* shared,
                      bool isBlack, Cell& cell)
{
    cell.clear();
    for (const Member& member : members)
        cell.add(lobes, member.lobe, member.area);
    if (shared || !cell.uniform)
        average(lobes, members, shared, isBlack, cell);
}

void Averager::list(const Lobes& lobes, const std::vector<Member>& members, Cell& cell)
{
    cell.clear();
    for (const Member& member : members) {
        cell.add(lobes, member.lobe, member.area);
        cell.list.add(lobes, member.lobe, member.area);
    }
    cell.shortenList();
}

void Averager::average(const Lobes& lobes, const std::vector<Member>& members, const Nodes* shared,
                       bool isBlack, Cell& cell)
{
    Patch& patch = cell.patch;
    const bool black = shared ? isBlack : luminance(cell.sum.ks) <= 0.0;
    const double narrow = cell.sum.energyNarrow / cell.sum.energy;
    if (shared)
        patch.nodes = *shared;
    else if (narrow <= kDiscRulePower || reachesRim(lobes, members, narrow))
        patch.nodes = {0.0f, &discRule(narrow)};
    else
        patch.nodes = {float(kSpacing / std::sqrt(narrow)), nullptr};
    if (patch.nodes.rule) {
        sumOnRule(lobes, members, black, patch);
        return;
    }
    measure(lobes, members, patch.nodes.spacing);
    if (!shared) {
        place(patch, nullptr);
        if (const size_t points = patch.size(); points > size_t(kMaxNodes))
            patch.nodes.spacing *= std::sqrt(float(points) / float(kMaxNodes));
    }
    patch.sublattice = shared ? Sublattice{} : chooseSublattice(patch.nodes.spacing);
    place(patch, &patch.sublattice);
    sumOnLattice(lobes, members, black, patch);
}

void Averager::sumOnRule(const Lobes& lobes, const std::vector<Member>& members, bool black, Patch& patch)
{
    constexpr size_t kChunk = 128; // terms that stay in the first-level cache while nodes pass by
    patch.reset(patch.nodes, {}, {}, channels_);
    const NodeSet& nodes = *patch.nodes.rule;
    const NodeList list{int(nodes.size()), nodes.x.data(), nodes.y.data(), nodes.z.data(), nullptr};
    for (int c = 0; c < channels_; ++c)
        for (size_t first = 0; first < members.size(); first += kChunk) {
            terms_.clear();
            for (size_t i = first; i < std::min(first + kChunk, members.size()); ++i) {
                float amplitudes[3];
                terms_.push_back(term(lobes, members[i], black, amplitudes));
                terms_.back().amplitude = amplitudes[c];
            }
            kernels_.average(terms_.data(), int(terms_.size()), isotropic_, list,
                             patch.g.data() + size_t(c) * nodes.size());
        }
}

// Where the lobes are, and which of them are so long that a strip has far fewer points than a disc.
void Averager::measure(const Lobes& lobes, const std::vector<Member>& members, float spacing)
{
    constexpr float kFewer = 2.0f; // what a strip must save to be worth its outline
    places_.clear();
    longLobes_.clear();
    for (const Member& member : members) {
        const size_t m = member.lobe;
        const float lowest = lowestPower(lobes, m), radius = supportRadius(lobes.nz[m], lowest);
        const float det = lobes.sxx[m] * lobes.syy[m] - lobes.sxy[m] * lobes.sxy[m];
        const float width = supportRadius(lobes.nz[m], 1.0f / (det * lowest));
        Place place{lambert(lobes.nx[m], lobes.ny[m], lobes.nz[m]), radius, -1, {}, nullptr};
        if (std::min(radius, kMostReach * spacing) > kFewer * (width + spacing)) {
            place.strip = int(longLobes_.size());
            longLobes_.emplace_back(lobes, m);
        }
        places_.push_back(place);
    }
    if (strips_.size() < longLobes_.size())
        strips_.resize(longLobes_.size());
}

// The points of a sublattice that the lobes need, and their bounding box. Without one only the box, roughly
// for strips.
void Averager::place(Patch& patch, const Sublattice* sub)
{
    glm::vec2 lower(1e30f), upper(-1e30f);
    const float spacing = patch.nodes.spacing, perSpacing = 1.0f / spacing;
    for (Place& place : places_) {
        const glm::vec2 l = place.at * perSpacing;
        place.centre = {std::nearbyint(l.x), std::nearbyint(l.y)};
        if (place.strip >= 0) {
            Stencil& strip = strips_[size_t(place.strip)];
            if (sub)
                longLobes_[size_t(place.strip)].fill(spacing, place.centre, *sub, strip);
            else
                longLobes_[size_t(place.strip)].findBox(spacing, place.centre, strip);
            place.stencil = &strip;
        } else {
            place.stencil = &stencilFor(place.radius * perSpacing);
        }
        lower = glm::min(lower, place.centre + glm::vec2(place.stencil->lower));
        upper = glm::max(upper, place.centre + glm::vec2(place.stencil->upper));
    }
    patch.x0 = int(lower.x);
    patch.y0 = int(lower.y);
    patch.width = int(upper.x) - patch.x0;
    patch.height = int(upper.y) - patch.y0;
}

// Where all lobes are long and lie alike, fewer nodes will do.
Sublattice Averager::chooseSublattice(float spacing)
{
    if (longLobes_.size() < places_.size())
        return {};
    covariances_.clear();
    for (const Strip& strip : longLobes_)
        covariances_.push_back(strip.covariance(spacing));
    return sublatticeFor(covariances_);
}

// Each lobe at the lattice points of its support only.
void Averager::sumOnLattice(const Lobes& lobes, const std::vector<Member>& members, bool black, Patch& patch)
{
    patch.g.assign(patch.size() * size_t(channels_), 0.0f);
    for (size_t i = 0; i < members.size(); ++i) {
        const glm::vec2 centre = places_[i].centre;
        const Stencil* const stencil = places_[i].stencil;
        float amplitudes[3];
        const LobeTerm lobe = term(lobes, members[i], black, amplitudes);
        values_.resize(stencil->x.size());
        kernels_.shapeOnLattice(lobe, isotropic_, stencil->x.data(), stencil->y.data(),
                                int(stencil->x.size()), centre.x, centre.y, patch.nodes.spacing,
                                values_.data());
        for (int c = 0; c < channels_; ++c) {
            float* origin = patch.g.data() + size_t(c) * patch.size() +
                            ptrdiff_t(int(centre.y) - patch.y0) * patch.width + int(centre.x) - patch.x0;
            const float* value = values_.data();
            for (const Stencil::Run& run : stencil->runs) {
                float* row = origin + ptrdiff_t(run.y) * patch.width + run.x;
                if (run.stride == 1) // vectors
                    for (int k = 0; k < run.count; ++k)
                        row[k] += amplitudes[c] * value[k];
                else
                    for (int k = 0; k < run.count; ++k)
                        row[k * run.stride] += amplitudes[c] * value[k];
                value += run.count;
            }
        }
    }
}

} // namespace lumel::baker
