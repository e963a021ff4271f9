// The shapes of the example scenes, with unique texture coordinates and tangents that follow them.
#pragma once
#include "core/math.h"
#include "shared/structs.h"
#include <cstdint>
#include <functional>
#include <vector>

namespace lumel::assets {

using shared::Vertex;

struct Shape {
    std::vector<Vertex> vertices;
    std::vector<uint32_t> indices; // counter-clockwise seen from where the normals point
    // Of each vertex; all of them may be empty.
    std::vector<glm::vec3> colours;           // linear
    std::vector<glm::vec<4, uint8_t>> joints; // of the object's skin
    std::vector<glm::vec4> weights;           // of these joints, their sum is 1
    std::vector<Shape> targets;               // what it morphs into: the same vertices elsewhere

    uint32_t add(glm::vec3 position, glm::vec3 normal, glm::vec3 tangent, glm::vec2 uv);
    void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d); // in ring order, either way round
};

// The orthonormal frame nearest to the two surface directions (their polar decomposition): where a chart is
// skewed, both axes share the error, and neighbouring charts agree better than if one axis took it all.
glm::vec3 tangentOf(glm::vec3 alongU, glm::vec3 alongUp, glm::vec3 normal);

// One point of a lathe's profile. Metres; y is up. Two points at one place with different normals make
// an edge. `uvRadius` in units of the map's width: the distance along the profile keeps texels square.
struct ProfilePoint {
    float radius, y;
    glm::vec2 normal; // (outwards, up), unit
    float uvRadius;
};

// Turns the profile, listed from the axis outwards, around +Y. The texture is seen from above: u along
// +x, v along +z, so that circles on the surface are circles in the map and no seam exists.
Shape lathe(const std::vector<ProfilePoint>& profile, int segments);

// Six square charts, one per face, three in a row, in a square map of `mapSize` texels. Each chart has
// `kBallGutter` texels around it. Faces are divided by equal angles, which keeps texels alike in size.
inline constexpr int kBallMap = 1024; // texels
inline constexpr int kBallCell = 336; // a chart with its gutter: a multiple of 16, so 5 levels stay aligned
inline constexpr int kBallGutter = 8; // texels
Shape ball(float radius, int divisions);
// The point on the unit sphere under a texel of such a map. In gutters: the chart's continuation.
// Texels outside all cells give the nearest cell's.
glm::vec3 ballPoint(glm::vec2 texel);

// A horizontal rectangle centred on the origin, u along +x, v along +z.
Shape floorGrid(float width, float depth, int divisions);

// A box standing on y = lower.y with faces in a 3 x 2 atlas.
Shape box(glm::vec3 lower, glm::vec3 upper);

} // namespace lumel::assets
