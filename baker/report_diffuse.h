// The diffuse side of the measurement. A texel shines matte as Kd / pi (N.l)+, one normal and one Kd for all
// that lies under it. The average over its level-0 texels differs because (N.l)+ is cut off at the horizon of
// each normal, and because what of the averaged vector Kd N lies across the stored normal is left out.
#pragma once
#include "report_average.h"

namespace lumel::baker {

// Directions of light over the hemisphere, of equal solid angles.
class LightGrid {
public:
    LightGrid();
    size_t size() const { return x_.size(); }
    // sums += weight Kd (N.l)+; Kd is the luminance.
    void add(float nx, float ny, float kd, float weight, float* sums) const;
    Averages::AddLobe adder() const; // keeps a reference

private:
    std::vector<float> x_, y_, z_;
};

// The squared error of a stored texel relative to the average's square, over the hemisphere of lights.
double diffuseError(const LightGrid& lights, const std::vector<float>& average, glm::dvec2 normal, double kd);

} // namespace lumel::baker
