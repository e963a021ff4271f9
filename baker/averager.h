// Gathers level-0 lobes into cells: their moments and their sum at quadrature nodes.
#pragma once
#include "cell.h"
#include "fit_kernel.h"
#include "source.h"
#include "strip.h"

namespace lumel::baker {

// A lobe of a block with the area that it covers, in level-0 texels.
struct Member {
    uint32_t lobe;
    float area;
};

class Averager {
public:
    explicit Averager(const Source& source) : Averager(source, source.isotropic()) {}
    // Of lobes that are not all the source's own.
    Averager(const Source& source, bool isotropic);

    // Sums `members` into `cell`: on `shared` nodes, or, when null, on nodes of its own; a uniform cell then
    // gets none. Where all Ks are 0 they count as 1, to fit the shape; on shared nodes that is so only if the
    // whole map `isBlack`.
    void gather(const Lobes& lobes, const std::vector<Member>& members, const Nodes* shared, bool isBlack,
                Cell& cell);
    // Lists them in place of sums.
    static void list(const Lobes& lobes, const std::vector<Member>& members, Cell& cell);
    // The second half of gather(): the sums, uniform or not.
    void average(const Lobes& lobes, const std::vector<Member>& members, const Nodes* shared, bool isBlack,
                 Cell& cell);
    // Does a lobe of this power reach the rim of the disc, where no lattice serves?
    static bool reachesRim(const Lobes& lobes, const std::vector<Member>& members, double power);
    int channels() const { return channels_; }

private:
    LobeTerm term(const Lobes& lobes, const Member& member, bool black, float* amplitudes) const;
    void measure(const Lobes& lobes, const std::vector<Member>& members, float spacing);
    void place(Patch& patch, const Sublattice* sub);
    Sublattice chooseSublattice(float spacing);
    void sumOnLattice(const Lobes& lobes, const std::vector<Member>& members, bool black, Patch& patch);
    void sumOnRule(const Lobes& lobes, const std::vector<Member>& members, bool black, Patch& patch);

    const Kernels& kernels_;
    bool isotropic_; // every lobe
    int channels_;
    std::vector<LobeTerm> terms_;
    std::vector<float> values_;
    struct Place {
        glm::vec2 at;     // in Lambert's map
        float radius;     // there
        int strip;        // index of a long lobe, or -1
        glm::vec2 centre; // a lattice point
        const Stencil* stencil;
    };
    std::vector<Place> places_;
    std::vector<Strip> longLobes_;
    std::vector<Stencil> strips_; // of those
    std::vector<LatticeCovariance> covariances_;
};

} // namespace lumel::baker
