// The average reflectance of a set of lobes at quadrature nodes.
#pragma once
#include "fit_kernel.h"
#include "quadrature.h"

namespace lumel::baker {

class Averager {
public:
    Averager(bool isotropicBase, bool colouredSpecular);
    // g()[channel][node] of the members. `black`: all Ks are 0; they count as 1, to fit the shape.
    void average(const Lobes& lobes, const std::vector<Member>& members, bool black, const NodeSet& nodes);
    // Adds the members to sums[channel * nodes + node], each only at the nodes of its support.
    void scatter(const Lobes& lobes, const std::vector<Member>& members, bool black,
                 const SharedLattice& lattice, float* sums);
    const float* const* g() const { return pointers_; }
    int channels() const { return channels_; }

private:
    LobeTerm term(const Lobes& lobes, const Member& member, bool black, int channel) const;

    const Kernels& kernels_;
    bool isotropic_;
    int channels_;
    std::vector<LobeTerm> terms_;
    std::vector<float> g_[3];
    const float* pointers_[3] = {};
};

} // namespace lumel::baker
