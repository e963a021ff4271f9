#include "averager.h"
#include "solver.h"

namespace lumel::baker {

Averager::Averager(bool isotropicBase, bool colouredSpecular)
    : kernels_(kernels()), isotropic_(isotropicBase), channels_(colouredSpecular ? 3 : 1)
{
}

LobeTerm Averager::term(const Lobes& lobes, const Member& member, bool black, int channel) const
{
    const size_t m = member.lobe;
    const float inverseDet = 1.0f / (lobes.sxx[m] * lobes.syy[m] - lobes.sxy[m] * lobes.sxy[m]);
    const float ks = black            ? 1.0f
                     : channels_ == 3 ? lobes.ks[channel][m]
                                      : float(luminance({lobes.ks[0][m], lobes.ks[1][m], lobes.ks[2][m]}));
    return {lobes.nx[m],
            lobes.ny[m],
            lobes.nz[m],
            lobes.syy[m] * inverseDet,
            -lobes.sxy[m] * inverseDet,
            lobes.sxx[m] * inverseDet,
            member.share * ks * std::sqrt(inverseDet)};
}

void Averager::average(const Lobes& lobes, const std::vector<Member>& members, bool black,
                       const NodeSet& nodes)
{
    constexpr size_t kChunk = 128; // terms that stay in the first-level cache while nodes pass by
    const NodeList list{int(nodes.size()), nodes.x.data(), nodes.y.data(), nodes.z.data(), nullptr};
    for (int c = 0; c < channels_; ++c) {
        g_[c].assign(nodes.size(), 0.0f);
        pointers_[c] = g_[c].data();
        for (size_t first = 0; first < members.size(); first += kChunk) {
            terms_.clear();
            for (size_t i = first; i < std::min(first + kChunk, members.size()); ++i)
                terms_.push_back(term(lobes, members[i], black, c));
            kernels_.average(terms_.data(), int(terms_.size()), isotropic_, list, g_[c].data());
        }
    }
}

void Averager::scatter(const Lobes& lobes, const std::vector<Member>& members, bool black,
                       const SharedLattice& lattice, float* sums)
{
    const NodeSet& nodes = lattice.nodes();
    const size_t lanes = size_t(kernels_.lanes);
    for (const Member& member : members) {
        const size_t m = member.lobe;
        const float radius = supportRadius(lowestPower(lobes, m));
        const glm::vec2 centre = lambert(lobes.nx[m], lobes.ny[m], lobes.nz[m]);
        for (int c = 0; c < channels_; ++c) {
            const LobeTerm one = term(lobes, member, black, c);
            float* g = sums + size_t(c) * nodes.size();
            lattice.around(centre, radius, [&](size_t first, size_t count) {
                // Whole vectors: what they add beside the run is the lobe's own far tail.
                const size_t end = (first + count + lanes - 1) / lanes * lanes;
                first = first / lanes * lanes;
                count = end - first;
                const NodeList list{int(count), &nodes.x[first], &nodes.y[first], &nodes.z[first], nullptr};
                kernels_.average(&one, 1, isotropic_, list, g + first);
            });
        }
    }
}

} // namespace lumel::baker
