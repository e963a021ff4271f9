// Vectors that differ by rounding only.
#pragma once
#include <glm/glm.hpp>
#include <gtest/gtest.h>

namespace lumel::scene {

inline void expectNear(glm::vec3 a, glm::vec3 b, float tolerance = 1e-5f)
{
    EXPECT_LT(glm::distance(a, b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

} // namespace lumel::scene
