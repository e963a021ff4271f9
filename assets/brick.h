// One brick and the mortar around it, for the floor and the ball.
#pragma once
#include "noise.h"

namespace lumel::assets {

// Where a point lies in a bond of bricks. All lengths in units of a brick's height.
struct BrickPlace {
    glm::vec2 local;    // from the brick's centre
    glm::vec2 halfSize; // with half a joint all around
    int id;             // differs from brick to brick
};

inline constexpr float kJoint = 0.13f; // width of the mortar
inline constexpr float kWear = 0.10f;  // width of the worn edges

// 0 in the mortar, 1 on the brick's face, with rounded corners and worn edges.
inline float brickFace(const BrickPlace& place)
{
    constexpr float kCorner = 0.12f;
    const glm::vec2 q = glm::abs(place.local) - place.halfSize + 0.5f * kJoint + kCorner;
    const float distance = glm::length(glm::max(q, 0.0f)) + std::min(std::max(q.x, q.y), 0.0f) - kCorner;
    return smooth(0.0f, kWear, -distance);
}

// Height in units of a brick's height. `p`: the point in space, for grain that ignores the bond.
inline float brickHeight(const BrickPlace& place, glm::vec3 p)
{
    const float face = brickFace(place);
    const glm::vec2 lean(random01(place.id, 1) - 0.5f, random01(place.id, 2) - 0.5f);
    const float lie = 0.03f * random01(place.id, 3) + 0.05f * glm::dot(lean, place.local);
    const float grain = 0.022f * fbm3(6.0f * p, 3, 31) - 0.03f * smooth(0.35f, 0.6f, fbm3(3.0f * p, 2, 37));
    const float mortar = 0.02f * fbm3(9.0f * p, 2, 41);
    return glm::mix(mortar, 0.11f + lie + grain, face);
}

inline glm::vec3 brickColour(const BrickPlace& place, glm::vec3 p)
{
    const float tone = random01(place.id, 4), soot = random01(place.id, 5);
    glm::vec3 brick = glm::mix(glm::vec3(0.30f, 0.085f, 0.045f), glm::vec3(0.42f, 0.17f, 0.09f), tone);
    if (soot > 0.86f)
        brick = glm::mix(brick, glm::vec3(0.09f, 0.05f, 0.05f), 0.7f);
    brick *= 1.0f + 0.35f * fbm3(4.0f * p, 3, 43);
    const glm::vec3 mortar = glm::vec3(0.30f, 0.28f, 0.25f) * (1.0f + 0.3f * fbm3(9.0f * p, 2, 47));
    return glm::clamp(glm::mix(mortar, brick, brickFace(place)), 0.0f, 1.0f);
}

} // namespace lumel::assets
