#include "geometry.h"
#include <array>
#include <cmath>
#include <numbers>

namespace lumel::assets {
namespace {

// A cube face seen from outside: right and up span the picture, so cross(right, up) = outwards.
struct Face {
    glm::vec3 outwards, right, up;
};
const std::array<Face, 6> kFaces{{
    {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
    {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
    {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
    {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
    {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
    {{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}},
}};

// Unit vector at the face's angles (radians from its centre, to the right and up).
glm::vec3 onSphere(const Face& face, glm::vec2 angles)
{
    return glm::normalize(face.outwards + std::tan(angles.x) * face.right + std::tan(angles.y) * face.up);
}

constexpr float kQuarterTurn = float(std::numbers::pi) / 2;

} // namespace

glm::vec3 tangentOf(glm::vec3 alongU, glm::vec3 alongUp, glm::vec3 normal)
{
    const glm::vec3 u = glm::normalize(alongU), up = glm::normalize(alongUp);
    const glm::vec3 fromUp = glm::cross(up, normal); // where u would be if the chart were square
    const glm::vec3 tangent = glm::normalize(u + fromUp);
    return glm::normalize(tangent - normal * glm::dot(normal, tangent));
}

uint32_t Shape::add(glm::vec3 position, glm::vec3 normal, glm::vec3 tangent, glm::vec2 uv)
{
    // No chart here is mirrored, so cross(N, T) is the map's up everywhere.
    vertices.push_back({position, normal, glm::vec4(tangent, 1.0f), uv, uv, uv});
    return uint32_t(vertices.size() - 1);
}

void Shape::quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    const auto triangle = [&](uint32_t i, uint32_t j, uint32_t k) {
        const glm::vec3 p = vertices[i].position;
        const glm::vec3 normal = glm::cross(vertices[j].position - p, vertices[k].position - p);
        const glm::vec3 wanted = vertices[i].normal + vertices[j].normal + vertices[k].normal;
        if (glm::dot(normal, normal) < 1e-20f)
            return; // a quad on the lathe's axis has one side of no length
        if (glm::dot(normal, wanted) < 0.0f)
            std::swap(j, k);
        indices.insert(indices.end(), {i, j, k});
    };
    triangle(a, b, c);
    triangle(a, c, d);
}

Shape lathe(const std::vector<ProfilePoint>& profile, int segments)
{
    Shape shape;
    // The seam's vertices are doubled only in the list: the texture is planar and has none.
    for (const ProfilePoint& p : profile)
        for (int i = 0; i < segments; ++i) {
            const float angle = 4.0f * kQuarterTurn * float(i) / float(segments);
            const float c = std::cos(angle), s = std::sin(angle);
            const glm::vec3 normal(p.normal.x * c, p.normal.y, p.normal.x * s);
            const glm::vec3 alongProfile(p.normal.y * c, -p.normal.x, p.normal.y * s);
            const glm::vec3 around(-s, 0.0f, c);
            const glm::vec3 tangent = c * alongProfile - s * around; // d(position)/du of the planar map
            shape.add({p.radius * c, p.y, p.radius * s}, normal, glm::normalize(tangent),
                      {0.5f + p.uvRadius * c, 0.5f + p.uvRadius * s});
        }
    const auto at = [&](size_t ring, int i) {
        return uint32_t(ring * size_t(segments) + size_t(i % segments));
    };
    for (size_t ring = 0; ring + 1 < profile.size(); ++ring) {
        const ProfilePoint &a = profile[ring], &b = profile[ring + 1];
        if (a.radius == b.radius && a.y == b.y)
            continue; // an edge
        for (int i = 0; i < segments; ++i)
            shape.quad(at(ring, i), at(ring + 1, i), at(ring + 1, i + 1), at(ring, i + 1));
    }
    return shape;
}

Shape ball(float radius, int divisions)
{
    Shape shape;
    constexpr float kInner = kBallCell - 2 * kBallGutter;
    for (int f = 0; f < 6; ++f) {
        const Face& face = kFaces[size_t(f)];
        const glm::vec2 corner = glm::vec2(f % 3, f / 3) * float(kBallCell) + float(kBallGutter);
        const uint32_t first = uint32_t(shape.vertices.size());
        for (int j = 0; j <= divisions; ++j)
            for (int i = 0; i <= divisions; ++i) {
                const glm::vec2 t = glm::vec2(i, j) / float(divisions); // as uv: right, down
                const glm::vec2 angles = kQuarterTurn * glm::vec2(t.x - 0.5f, 0.5f - t.y);
                constexpr float kStep = 1e-3f; // radians
                const glm::vec3 n = onSphere(face, angles);
                const glm::vec3 alongU = onSphere(face, angles + glm::vec2(kStep, 0)) - n;
                const glm::vec3 alongUp = onSphere(face, angles + glm::vec2(0, kStep)) - n;
                shape.add(radius * n, n, tangentOf(alongU, alongUp, n),
                          (corner + kInner * t) / float(kBallMap));
            }
        const uint32_t row = uint32_t(divisions) + 1;
        for (uint32_t j = 0; j + 1 < row; ++j)
            for (uint32_t i = 0; i + 1 < row; ++i) {
                const uint32_t a = first + j * row + i;
                shape.quad(a, a + 1, a + row + 1, a + row);
            }
    }
    return shape;
}

glm::vec3 ballPoint(glm::vec2 texel)
{
    const glm::ivec2 cell = glm::min(glm::ivec2(texel) / kBallCell, glm::ivec2(2, 1));
    const Face& face = kFaces[size_t(cell.y * 3 + cell.x)];
    const glm::vec2 inCell = glm::min(texel - glm::vec2(cell * kBallCell), glm::vec2(kBallCell));
    const glm::vec2 t = (inCell - float(kBallGutter)) / float(kBallCell - 2 * kBallGutter);
    return onSphere(face, kQuarterTurn * glm::vec2(t.x - 0.5f, 0.5f - t.y));
}

Shape floorGrid(float width, float depth, int divisions)
{
    Shape shape;
    for (int j = 0; j <= divisions; ++j)
        for (int i = 0; i <= divisions; ++i) {
            const glm::vec2 uv = glm::vec2(i, j) / float(divisions);
            shape.add({width * (uv.x - 0.5f), 0.0f, depth * (uv.y - 0.5f)}, {0, 1, 0}, {1, 0, 0}, uv);
        }
    const uint32_t row = uint32_t(divisions) + 1;
    for (uint32_t j = 0; j + 1 < row; ++j)
        for (uint32_t i = 0; i + 1 < row; ++i)
            shape.quad(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i);
    return shape;
}

Shape box(glm::vec3 lower, glm::vec3 upper)
{
    Shape shape;
    constexpr float kMargin = 0.01f; // of the map, around each face
    const glm::vec3 centre = 0.5f * (lower + upper), half = 0.5f * (upper - lower);
    for (int f = 0; f < 6; ++f) {
        const Face& face = kFaces[size_t(f)];
        const glm::vec2 cellSize(1.0f / 3.0f, 0.5f);
        uint32_t corners[4];
        for (int k = 0; k < 4; ++k) {
            const glm::vec2 t((k == 1 || k == 2) ? 1.0f : 0.0f, k >= 2 ? 1.0f : 0.0f);
            const glm::vec3 direction =
                face.outwards + (2.0f * t.x - 1.0f) * face.right + (1.0f - 2.0f * t.y) * face.up;
            const glm::vec2 uv = (glm::vec2(f % 3, f / 3) + kMargin + (1.0f - 2.0f * kMargin) * t) * cellSize;
            corners[k] = shape.add(centre + half * direction, face.outwards, face.right, uv);
        }
        shape.quad(corners[0], corners[1], corners[2], corners[3]);
    }
    return shape;
}

} // namespace lumel::assets
