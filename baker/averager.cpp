#include "averager.h"
#include "solver.h"

namespace lumel::baker {

Averager::Averager(bool isotropicBase, bool colouredSpecular)
    : kernels_(kernels()), isotropic_(isotropicBase), channels_(colouredSpecular ? 3 : 1)
{
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
            for (size_t i = first; i < std::min(first + kChunk, members.size()); ++i) {
                const size_t m = members[i].lobe;
                const float inverseDet = 1.0f / (lobes.sxx[m] * lobes.syy[m] - lobes.sxy[m] * lobes.sxy[m]);
                const float ks = black ? 1.0f
                                 : channels_ == 3
                                     ? lobes.ks[c][m]
                                     : float(luminance({lobes.ks[0][m], lobes.ks[1][m], lobes.ks[2][m]}));
                terms_.push_back({lobes.nx[m], lobes.ny[m], lobes.nz[m], lobes.syy[m] * inverseDet,
                                  -lobes.sxy[m] * inverseDet, lobes.sxx[m] * inverseDet,
                                  members[i].share * ks * std::sqrt(inverseDet)});
            }
            kernels_.average(terms_.data(), int(terms_.size()), isotropic_, list, g_[c].data());
        }
    }
}

} // namespace lumel::baker
