// KHR_texture_transform: scaled, then rotated (from u towards -v), then moved.
#include "scene.h"

namespace lumel::scene {

glm::mat3 UvMapping::matrix() const
{
    const float c = std::cos(rotation), s = std::sin(rotation);
    return {glm::vec3(c * scale.x, -s * scale.x, 0.0f), glm::vec3(s * scale.y, c * scale.y, 0.0f),
            glm::vec3(offset, 1.0f)};
}

glm::vec2 UvMapping::operator()(glm::vec2 uv) const
{
    const glm::mat3 m = matrix();
    return m == glm::mat3(1.0f) ? uv : glm::vec2(m * glm::vec3(uv, 1.0f));
}

std::optional<glm::mat3> mappingBetween(const UvMapping& from, const UvMapping& to)
{
    const glm::mat3 relative = to.matrix() * glm::inverse(from.matrix());
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 2; ++r)
            if (!std::isfinite(relative[c][r]))
                return std::nullopt;
    return relative;
}

} // namespace lumel::scene
