// One texel of a baked chain, looked at: the exact average of the level-0 lobes under it, beside the baked
// lobe, or two, and LEAN's. What the viewer's inspector shows.
#pragma once
#include "bake.h"
#include <memory>

namespace lumel::baker {

// A square of the half-angle disc: side * side values of reflectance, row 0 on top (+y up, +x right); -1
// beyond the rim.
struct DiscPicture {
    std::vector<float> values;
    double error = 0.0; // relative to the energy of the average
};

struct TexelLobes {
    int side = 0;                                    // points of a picture's side
    double centreX = 0.0, centreY = 0.0, half = 1.0; // the part of the disc that is shown
    double peak = 1.0;                               // the largest value of the average
    DiscPicture average, fit;
    DiscPicture lean; // with the Ks of least error
};

// Decodes the maps once for all texels of their material. Averages over thousands of texels take their time.
class TexelInspector {
public:
    explicit TexelInspector(Maps maps); // throws Error for unusable ones
    ~TexelInspector();

    // `texel`: that of a chain baked from the maps by any method, whose levels have these sizes; their texels
    // are not read. `second`: its second lobe, if it may have one.
    TexelLobes look(const std::vector<Level>& sizes, size_t level, int x, int y, const float* texel,
                    const float* second = nullptr) const;

private:
    struct Data;
    std::unique_ptr<Data> data_;
};

} // namespace lumel::baker
