#include "lobe_order.h"
#include "moments.h"
#include "normals.h"
#include "profile.h"
#include "shared/lobe.h"
#include "solver.h"
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace lumel::baker {
namespace {

// A lobe on the disc, and what it reflects.
struct Spot {
    float ks = 0.0f, x = 0.0f, y = 0.0f, cxx = 1.0f, cxy = 0.0f, cyy = 1.0f, det = 1.0f;
};

Spot spotOf(const float* t) // first or second lobe: both begin alike
{
    const glm::dvec3 n(shared::lobeNormal(glm::vec2(t[kNx], t[kNy])));
    const Sym2 c = DiscFrame(n).toDisc({t[kSxx], t[kSxy], t[kSyy]});
    return {float(luminance({t[kKsR], t[kKsG], t[kKsB]})),
            t[kNx],
            t[kNy],
            float(c.xx),
            float(c.xy),
            float(c.yy),
            float(c.det())};
}

// What blending two lobes costs: the Bhattacharyya distance of two Gaussians, by how much of either is
// blended.
float cost(const Spot& a, const Spot& b)
{
    const float both = a.ks * b.ks;
    if (both <= 0.0f)
        return 0.0f;
    const float xx = 0.5f * (a.cxx + b.cxx), xy = 0.5f * (a.cxy + b.cxy), yy = 0.5f * (a.cyy + b.cyy);
    const float det = std::max(xx * yy - xy * xy, 1e-12f), dx = a.x - b.x, dy = a.y - b.y;
    const float apart = (yy * dx * dx - 2.0f * xy * dx * dy + xx * dy * dy) / det;
    const float widths = 0.5f * std::log(std::max(det / std::sqrt(std::max(a.det * b.det, 1e-24f)), 1.0f));
    return both / (a.ks + b.ks) * (0.125f * apart + widths);
}

struct Texel {
    Spot lobes[2];
    bool single() const { return lobes[1].ks <= 0.0f; }
};

// What it gains that two texels keep their order relative to each other.
float coupling(const Texel& a, const Texel& b)
{
    return cost(a.lobes[0], b.lobes[1]) + cost(a.lobes[1], b.lobes[0]) - cost(a.lobes[0], b.lobes[0]) -
           cost(a.lobes[1], b.lobes[1]);
}

// A random number of [0, 1) that is the same on any machine (Jarzynski and Olano 2020, "Hash Functions for
// GPU Rendering": pcg).
float random(uint32_t x)
{
    const uint32_t state = x * 747796405u + 2891336453u;
    const uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return float(((word >> 22u) ^ word) >> 8u) / 16777216.0f;
}

// Orders of a level's texels as spins of an Ising model: +1 as stored, -1 swapped.
class Order {
public:
    Order(const Level& level, Wrap wrap, Profile* profile)
        : width_(level.width), height_(level.height), wrap_(wrap), profile_(profile)
    {
        const size_t count = size_t(width_) * size_t(height_);
        texels_.resize(count);
        spins_.assign(count, 1.0f);
        field_.assign(count, 0.0f);
        right_.assign(count, 0.0f);
        down_.assign(count, 0.0f);
        forRows([&](int y) {
            for (int x = 0; x < width_; ++x)
                texels_[at(x, y)] = {{spotOf(level.at(x, y)), spotOf(level.secondAt(x, y))}};
        });
        forRows([&](int y) {
            for (int x = 0; x < width_; ++x) {
                const int nextX = wrapped(x + 1, width_, wrap_), nextY = wrapped(y + 1, height_, wrap_);
                if (nextX != x)
                    right_[at(x, y)] = coupling(texels_[at(x, y)], texels_[at(nextX, y)]);
                if (nextY != y)
                    down_[at(x, y)] = coupling(texels_[at(x, y)], texels_[at(x, nextY)]);
            }
        });
    }

    // Starts from the order of the next coarser level.
    void follow(const Order& coarser)
    {
        forRows([&](int y) {
            for (int x = 0; x < width_; ++x) {
                const size_t above =
                    coarser.at(std::min(x / 2, coarser.width_ - 1), std::min(y / 2, coarser.height_ - 1));
                field_[at(x, y)] =
                    coarser.spins_[above] * coupling(texels_[at(x, y)], coarser.texels_[above]);
                if (field_[at(x, y)] < 0.0f && !texels_[at(x, y)].single())
                    spins_[at(x, y)] = -1.0f;
            }
        });
    }

    // Simulated annealing, by texels of one colour of a chequerboard at a time: none depends on another.
    void anneal()
    {
        constexpr int kHot = 24, kCold = 8;
        double sum = 0.0;
        for (size_t i = 0; i < texels_.size(); ++i)
            sum += double(std::abs(right_[i])) + double(std::abs(down_[i]));
        const float mean = float(sum / (2.0 * double(texels_.size())));
        std::vector<std::vector<int>> doubles(size_t(height_) * 2); // by row and parity of x
        forRows([&](int y) {
            for (int x = 0; x < width_; ++x)
                if (!texels_[at(x, y)].single())
                    doubles[size_t(2 * y + x % 2)].push_back(x);
        });
        for (int sweep = 0; sweep < kHot + kCold; ++sweep) {
            const float temperature = std::max(0.0f, mean * float(kHot - sweep) / float(kHot));
            for (int colour = 0; colour < 2; ++colour)
                forRows([&](int y) {
                    for (const int x : doubles[size_t(2 * y + (y + colour) % 2)])
                        turn(x, y, temperature, uint32_t(2 * sweep + colour));
                });
        }
    }

    void apply(Level& level) const
    {
        for (size_t i = 0; i < spins_.size(); ++i)
            if (spins_[i] < 0.0f)
                std::swap_ranges(&level.second[i * kSecondChannels],
                                 &level.second[i * kSecondChannels] + kSecondChannels,
                                 &level.texels[i * kChannels]);
    }

private:
    size_t at(int x, int y) const { return size_t(y) * size_t(width_) + size_t(x); }

    template<class Row>
    void forRows(const Row& row) const
    {
        tbb::parallel_for(tbb::blocked_range<int>(0, height_, 16), [&](const auto& rows) {
            const StepTimer timer(profile_, Step::order);
            for (int y = rows.begin(); y < rows.end(); ++y)
                row(y);
        });
    }

    void turn(int x, int y, float temperature, uint32_t step)
    {
        const size_t i = at(x, y);
        const auto neighbour = [&](int nx, int ny) {
            return at(wrapped(nx, width_, wrap_), wrapped(ny, height_, wrap_));
        };
        const size_t left = neighbour(x - 1, y), up = neighbour(x, y - 1);
        float field =
            field_[i] + right_[i] * spins_[neighbour(x + 1, y)] + down_[i] * spins_[neighbour(x, y + 1)];
        if (left != i)
            field += right_[left] * spins_[left];
        if (up != i)
            field += down_[up] * spins_[up];
        // Metropolis, with the exponential's first-order fraction: exp(-d) about 1 / (1 + d)^2.
        const float loss = field * spins_[i]; // of turning, halved
        const float d = 1.0f + loss / std::max(temperature, 1e-30f);
        if (loss < 0.0f || (temperature > 0.0f && random(random32(i, step)) * d * d < 1.0f))
            spins_[i] = -spins_[i];
    }
    static uint32_t random32(size_t i, uint32_t step) { return uint32_t(i) * 64u + step; }

    int width_, height_;
    Wrap wrap_;
    Profile* profile_;
    std::vector<Texel> texels_;
    std::vector<float> spins_, field_; // field: to the coarser level
    std::vector<float> right_, down_;  // to the next texel
};

} // namespace

void orderLobes(std::vector<Level>& levels, Wrap wrap, Profile* profile)
{
    std::unique_ptr<Order> coarser;
    for (auto level = levels.rbegin(); level != levels.rend() && !level->second.empty(); ++level) {
        auto order = std::make_unique<Order>(*level, wrap, profile);
        if (coarser)
            order->follow(*coarser);
        order->anneal();
        order->apply(*level);
        coarser = std::move(order);
    }
}

} // namespace lumel::baker
