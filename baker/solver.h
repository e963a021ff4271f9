// From a batch of texels with their average reflectance at quadrature nodes to fitted texels.
#pragma once
#include "averager.h"
#include "closed_form.h"
#include "fit_kernel.h"
#include <array>

namespace lumel::baker {

// The input for one texel.
struct TexelTask {
    Moments mean;       // mean moments of its lobes
    bool fixed = false; // nothing to fit: the method is a closed form, or the texel is uniform
    Shape shape;        // the lobe then
    const HeightMips* heights = nullptr; // where there is a height map
    int level = 0, x = 0, y = 0;         // the texel
    bool uniform = false;                // all its lobes are `shape`: no error
    // Lobes of the finer level under it with their Ks (luminance) and share of the area.
    struct Child {
        Shape shape;
        float ks, share;
    };
    static constexpr int kMostChildren = 9;
    std::array<Child, kMostChildren> children;
    int childCount = 0;
    // Both lobes of each texel of the finer level, where that has second ones; else the children.
    std::array<Child, 2 * kMostChildren> finerLobes;
    int finerCount = 0;
    const Child& finer(int i) const { return finerCount > 0 ? finerLobes[size_t(i)] : children[size_t(i)]; }
    // The LEAN lobe of a part of the texel as a child.
    void addChild(const Moments& mean, double share);
    LobeList* list = nullptr; // of coarser texels: it becomes one lobe where that is as good
    float* texel = nullptr;   // kChannels floats to fill
    float* second = nullptr;  // kSecondChannels where the texel may have a second lobe
    // In a chain that is isotropic or has second lobes, the fit of one anisotropic lobe: a starting point for
    // the next level.
    float* oneLobe = nullptr;
};

class Solver {
public:
    Solver(const Options& options, const Source& source);

    // Adds a texel with its sums; one channel (luminance) unless the specular is coloured.
    void add(const TexelTask& task, const Cell& cell);
    // Solves and writes what was added, and forgets it.
    void solve();

    int channels() const { return coloured_ ? 3 : 1; }

private:
    struct Found {
        Shape shape;
        float error = kNoError;
        float norm = 1.0f; // <f, f>
    };
    static constexpr float kNoError = 1e30f; // worse than any search
    enum Family { kIsotropic, kAnisotropic };

    struct FoundPair {
        Shape shape[2];
        float ks[2], norm[2], cross;
        float error = kNoError;
    };

    struct Texel {
        TexelTask task;
        size_t firstNode, nodeCount;
        size_t firstTerm;                        // of the children
        size_t firstFiner, finerCount;           // of the finer level's lobes
        size_t firstListed = 0, listedCount = 0; // terms of the whole list, in place of nodes
        float energy, maxLog;
        Shape lean;                 // the closed form of the moments
        float leanError = kNoError; // where there is a list
        bool startsAtLean = false;  // the last exact search did
        Found best[2];              // by family
        Found start[2];             // the two best minima of the mixture
        FoundPair pair;             // where a second lobe is worth it
    };
    using Selection = std::vector<uint32_t>;

    double weighNodes(size_t first);
    void addChildren(Texel& texel);
    void addPatch(Texel& texel, const Cell& cell);
    void addList(Texel& texel, const Cell& cell);
    // One search for each of `starts` (texel, shape).
    struct Start {
        uint32_t texel;
        Shape shape;
    };
    enum class Against { children, average };
    FitJob jobOf(const Start& start, Family family, Against against) const;
    static size_t firstAlike(const std::vector<Start>& starts, size_t index, Family family);
    void reserveScratch(int terms);
    void run(const std::vector<Start>& starts, Family family, Against against, std::vector<Found>& found);
    // The lobes without a search.
    void judge(const std::vector<Start>& starts, std::vector<Found>& found);
    void judgeOnNodes(const std::vector<Start>& starts, std::vector<Found>& found);
    // Sums at nodes in place of lists where lobes are no Gaussians.
    void addNodes(Texel& texel);
    bool isGaussian(const Found& found) const;
    bool isGaussian(const FoundPair& pair, float oneLobe) const;
    bool isAstray(const Found& found) const;
    void polish(const Selection& selection, bool isotropicToo);
    // Closed forms; returns where a search is needed.
    Selection settle(const Selection& selection, Family family);
    void keep(const std::vector<Start>& starts, const std::vector<Found>& found, Family family);
    void chooseStarts(const Selection& selection, Family family);
    void searchExactly(const Selection& selection, Family family);
    void addClosedForms(uint32_t texel, Family family);
    void searchClosedForms(const Selection& selection, Family family);
    void mergeLists(const Selection& selection);
    void fitPowers(const Selection& selection, Family family);
    void fitIsotropic(const Selection& selection);
    void keepIsotropic(const Selection& selection);
    void fitAnisotropic(const Selection& selection);
    Selection above(const Selection& selection, Family family, float error) const;
    Selection doubtful(const Selection& selection, Family family, float error) const;
    struct PairStart {
        uint32_t texel;
        Shape shape[2];
    };
    static size_t firstAlike(const std::vector<PairStart>& starts, size_t index);
    PairJob pairJobOf(const PairStart& start, Family family, Against against) const;
    void runPairs(const std::vector<PairStart>& starts, Family family, Against against, int evaluations,
                  std::vector<FoundPair>& found);
    static FoundPair swapped(FoundPair pair);
    static std::vector<PairStart> bestOf(const std::vector<PairStart>& starts,
                                         const std::vector<FoundPair>& found);
    void fitPairs(const Selection& selection, Family family);
    std::array<double, 3> channelOverlaps(const Texel& texel, const Shape& shape);
    void writePair(const Texel& texel);
    void writePairColours(const Texel& texel, float* first, float* second);
    void writeDiffuse(const TexelTask& task, const glm::dvec3& normal, float* to);
    void sampleShape(const Texel& texel, const Shape& shape);
    void writeSingles(Family family);
    void write(const Texel& texel, const Found& found, float* to, bool ownKs);
    void writeSpecular(const Texel& texel, const Found& found, float* to, bool ownKs);
    void projectColours(const Texel& texel, const Shape& shape, double ks, float* to);

    const Kernels& kernels_;
    Options options_;
    bool coloured_;
    Averager averager_;
    Lobes lobes_;
    std::vector<Member> members_;
    Cell cell_;
    std::vector<Texel> texels_;
    NodeSet nodes_;                                // of all texels
    std::vector<float> weight_, channelWeight_[3]; // area * G there
    std::vector<MixtureTerm> terms_;
    std::vector<MixtureTerm> listed_;
    std::vector<ListedLobe> listedLobes_; // the same
    std::vector<FitJob> jobs_;
    std::vector<FitJob*> order_;
    std::vector<Trial> trials_;
    std::vector<Start> starts_;
    std::vector<Found> found_;
    std::vector<float> scratch_;
};

// The minimiser's unknowns for a lobe, and back. `clamped`: their powers left the limits of a lobe and
// were brought back, so that the error found is not the lobe's.
void toUnknowns(const Shape& shape, float maxLog, float* unknowns);
Shape fromUnknowns(const float* unknowns, float maxLog, bool& clamped);

// The normal of a texel's diffuse term: the lobes' own, by the luminance of their Ks.
glm::dvec3 pairNormal(const float* texel, const float* second);

// Ks of one number: Rec. 709 luminance, the weight of the shape fit.
inline double luminance(glm::dvec3 c)
{
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

} // namespace lumel::baker
