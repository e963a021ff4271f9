#include "report_diffuse.h"
#include "shared/limits.h"
#include "solver.h"

namespace lumel::baker {
namespace {
// Midpoints. (N.l)+ has a kink, so that sums converge as the square of the spacing: within 0.5 % of the
// error.
constexpr int kRings = 16, kSpokes = 48;
} // namespace

LightGrid::LightGrid()
{
    for (int i = 0; i < kRings; ++i) {
        const float z = (float(i) + 0.5f) / float(kRings), r = std::sqrt(1.0f - z * z);
        for (int j = 0; j < kSpokes; ++j) {
            const float phi = 2.0f * shared::kPi * (float(j) + 0.5f * float(i & 1)) / float(kSpokes);
            x_.push_back(r * std::cos(phi));
            y_.push_back(r * std::sin(phi));
            z_.push_back(z);
        }
    }
}

void LightGrid::add(float nx, float ny, float kd, float weight, float* sums) const
{
    const float nz = std::sqrt(std::max(0.0f, 1.0f - nx * nx - ny * ny)), scale = weight * kd;
    const float *x = x_.data(), *y = y_.data(), *z = z_.data();
    for (size_t k = 0; k < x_.size(); ++k)
        sums[k] += scale * std::max(0.0f, nx * x[k] + ny * y[k] + nz * z[k]);
}

Averages::AddLobe LightGrid::adder() const
{
    return [this](const Lobes& l, size_t i, float weight, float* sums) {
        add(l.nx[i], l.ny[i], float(luminance({l.kd[0][i], l.kd[1][i], l.kd[2][i]})), weight, sums);
    };
}

double diffuseError(const LightGrid& lights, const std::vector<float>& average, glm::dvec2 normal, double kd)
{
    std::vector<float> difference = average;
    lights.add(float(normal.x), float(normal.y), float(kd), -1.0f, difference.data());
    double error = 0.0, energy = 0.0;
    for (size_t k = 0; k < average.size(); ++k) {
        error += double(difference[k]) * difference[k];
        energy += double(average[k]) * average[k];
    }
    return energy > 0.0 ? error / energy : 0.0; // black: no error
}

} // namespace lumel::baker
