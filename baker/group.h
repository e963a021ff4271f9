// One SIMD group: as many texels as the kernels have lanes, from their lobes to their fitted texels.
#pragma once
#include "fit_kernel.h"
#include "moments.h"
#include "quadrature.h"
#include <array>

namespace lumel::baker {

// What the solver knows of one texel before it looks at its average reflectance.
struct TexelTask {
    Moments mean; // mean moments of its lobes
    Shape shape;  // closed-form lobe, when the method is not `fit`
    // Lobes of the finer level under it with their Ks (luminance) and share of the area.
    struct Child {
        Shape shape;
        float ks, share;
    };
    static constexpr int kMostChildren = 9;
    std::array<Child, kMostChildren> children;
    int childCount = 0;
    bool uniform = false;   // all its lobes are `shape`: the fit is that lobe, exactly
    float* texel = nullptr; // kChannels floats to fill
};

// 64-byte aligned rows of lanes.
class LaneArray {
public:
    void resize(size_t rows, int lanes)
    {
        lanes_ = size_t(lanes);
        if (storage_.size() < rows * lanes_ + 16)
            storage_.resize(rows * lanes_ + 16);
    }
    float* data()
    {
        const auto at = reinterpret_cast<uintptr_t>(storage_.data());
        return storage_.data() + ((64 - at % 64) % 64) / sizeof(float);
    }
    float& at(size_t row, int lane) { return data()[row * lanes_ + size_t(lane)]; }
    float* row(size_t row) { return data() + row * lanes_; }

private:
    size_t lanes_ = 1;
    std::vector<float> storage_;
};

class Group {
public:
    Group(const Options& options, bool isotropicBase, bool colouredSpecular);

    int lanes() const { return kernels_.lanes; }
    // Starts a group of `count` <= lanes() texels with at most `nodes` nodes each.
    void begin(int count, size_t nodes);
    void setNodes(int lane, const std::vector<Node>& nodes);
    // Same, with an average G that is known already, for each of channels() channels [channel][node].
    void setAveragedNodes(int lane, const std::vector<Node>& nodes, const float* const* average);
    void setTask(int lane, const TexelTask& task) { tasks_[size_t(lane)] = task; }
    // Adds lobes to the average G of each lane: members[lane] of `lobes`.
    void average(const Lobes& lobes, const std::vector<Member>* members);
    // The average G so far.
    const float* g(int channel) { return g_[channel].data(); }
    int channels() const { return coloured_ ? 3 : 1; }
    // Fits or evaluates and writes the texels.
    void finish();

private:
    void averageChunk(const Lobes& lobes, const std::vector<Member>* members, size_t first, size_t count);
    void weighNodes();
    void buildMixture();
    void evaluateShape(const Shape* shapes, float* overlap, float* norm);
    // Evaluates one shape a lane with its best Ks; keeps it where it beats the best so far.
    void consider(const Shape* shapes);
    // Searches from one start a lane. `exact`: against the nodes, keeping what beats the best so far;
    // otherwise against the mixture. Replaces the starts by what was found; errors[lane] too.
    void search(Shape* shapes, float* errors, bool isotropic, bool exact);
    void fit();
    void chooseStarts(Shape* first, Shape* second, bool isotropic);
    bool settled() const; // no lane's error is worth another search
    void write(bool closedForm);
    FitProblem problem(bool isotropic);

    const Kernels& kernels_;
    Options options_;
    bool isotropicBase_, coloured_;
    int count_ = 0;
    size_t nodes_ = 0;
    std::array<TexelTask, kMaxLanes> tasks_;
    LaneArray x_, y_, z_, area_, weight_, g_[3], batch_[9], mixture_[7], unknowns_;
    // Best lobe of each lane so far.
    std::array<Shape, kMaxLanes> best_{};
    std::array<float, kMaxLanes> bestError_{};
    int mixtureCount_ = 0;
    alignas(64) std::array<float, kMaxLanes> energy_{};
    alignas(64) std::array<float, kMaxLanes> maxLog_{};
};

// Ks of one number: Rec. 709 luminance, the weight of the shape fit.
inline double luminance(glm::dvec3 c)
{
    return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

} // namespace lumel::baker
