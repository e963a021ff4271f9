// The lobes under a texel, as few as stand for them: near ones merge into one of the same moments.
#pragma once
#include "fit_kernel.h"
#include "moments.h"
#include <span>

namespace lumel::baker {

struct ListedLobe {
    Shape shape;
    float nz;
    float area;
    float ks[3];
    void store(Lobes& lobes, size_t index) const;
    float mass() const { return area * float(0.2126f * ks[0] + 0.7152f * ks[1] + 0.0722f * ks[2]); }
};

class LobeList {
public:
    // Most lobes of a list that was reduced.
    static constexpr size_t kMost = 128;

    const std::vector<ListedLobe>& lobes() const { return lobes_; }
    bool empty() const { return lobes_.empty(); }
    void clear() { lobes_.clear(); }
    void add(const Lobes& lobes, size_t index, float area);
    // Areas are multiplied by `factor`.
    void append(const LobeList& other, float factor);
    // Merges neighbours until at most kMost lobes are left.
    void reduce();
    // All into one of this shape.
    void merge(const Shape& shape);
    // The lobe of their moments, weighted by what they reflect.
    Shape matchedShape() const;

private:
    std::vector<ListedLobe> lobes_;
};

// As the kernels take it: its share of `area`; Ks is 1 where the texel `isBlack`.
MixtureTerm termOf(const ListedLobe& lobe, float area, bool isBlack);
MixtureTerm unitTerm(const Shape& shape); // of Ks 1

} // namespace lumel::baker
