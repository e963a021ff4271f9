// Deterministic hashes and gradient-free value noise: the raw material of every map.
#pragma once
#include "core/math.h"
#include <cstdint>

namespace lumel::assets {

// PCG output permutation (O'Neill 2014; as a hash: Jarzynski and Olano 2020, section 4).
inline uint32_t hash(uint32_t value)
{
    const uint32_t state = value * 747796405u + 2891336453u;
    const uint32_t word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
    return (word >> 22) ^ word;
}

// Uniform in [0, 1), from up to three lattice coordinates.
inline float random01(int x, int y = 0, int z = 0)
{
    const uint32_t h = hash(uint32_t(x) + hash(uint32_t(y) + hash(uint32_t(z))));
    return float(h >> 8) * 0x1p-24f;
}

inline float fade(float t) // Perlin 2002: continuous second derivative, so slopes have no creases
{
    return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
}

inline int wrapped(int cell, int period) // period 0: no wrap
{
    return period > 0 ? ((cell % period) + period) % period : cell;
}

// Value noise in [-1, 1], one feature per unit. `period` wraps x (for angles); `seed` picks the field.
inline float noise2(glm::vec2 p, int seed, int period = 0)
{
    const glm::vec2 cell = glm::floor(p);
    const glm::vec2 t(fade(p.x - cell.x), fade(p.y - cell.y));
    const int x0 = wrapped(int(cell.x), period), x1 = wrapped(int(cell.x) + 1, period), y = int(cell.y);
    const float upper = glm::mix(random01(x0, y, seed), random01(x1, y, seed), t.x);
    const float lower = glm::mix(random01(x0, y + 1, seed), random01(x1, y + 1, seed), t.x);
    return 2.0f * glm::mix(upper, lower, t.y) - 1.0f;
}

inline float noise3(glm::vec3 p, int seed)
{
    const glm::vec3 cell = glm::floor(p);
    const glm::vec3 t(fade(p.x - cell.x), fade(p.y - cell.y), fade(p.z - cell.z));
    const int x = int(cell.x), y = int(cell.y), z = int(cell.z);
    float layers[2];
    for (int k = 0; k < 2; ++k) {
        const int s = int(hash(uint32_t(z + k) + hash(uint32_t(seed))));
        const float upper = glm::mix(random01(x, y, s), random01(x + 1, y, s), t.x);
        const float lower = glm::mix(random01(x, y + 1, s), random01(x + 1, y + 1, s), t.x);
        layers[k] = glm::mix(upper, lower, t.y);
    }
    return 2.0f * glm::mix(layers[0], layers[1], t.z) - 1.0f;
}

// Octaves of halving size and amplitude, in about [-1, 1].
inline float fbm3(glm::vec3 p, int octaves, int seed)
{
    float sum = 0.0f, amplitude = 0.5f;
    for (int i = 0; i < octaves; ++i, amplitude *= 0.5f, p *= 2.03f)
        sum += amplitude * noise3(p, seed + i);
    return sum;
}

// The lattice point of one cell, moved at random inside it: scattered points, evenly dense.
struct Scattered {
    glm::vec3 offset; // from the place that asks, in cells
    int id;
};

template<class Visit>
void forNeighbours(glm::vec3 q, const Visit& visit)
{
    const glm::ivec3 cell = glm::ivec3(glm::floor(q));
    for (int k = 0; k < 27; ++k) {
        const glm::ivec3 c = cell + glm::ivec3(k % 3, k / 3 % 3, k / 9) - 1;
        const int id = int(hash(uint32_t(c.x) + hash(uint32_t(c.y) + hash(uint32_t(c.z)))));
        const glm::vec3 jitter(random01(id, 1), random01(id, 2), random01(id, 3));
        visit(Scattered{glm::vec3(c) + jitter - q, id});
    }
}

inline float smooth(float from, float to, float x)
{
    const float t = glm::clamp((x - from) / (to - from), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

} // namespace lumel::assets
