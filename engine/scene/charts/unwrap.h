// Unique lit UVs for a mesh whose own UVs are not: charts, flattened and packed into [0, 1]^2.
#pragma once
#include "scene/scene.h"

namespace lumel::scene {

// What a new vertex and the index buffer come from: enough to unwrap the same mesh again without work.
struct Unwrapping {
    std::vector<uint32_t> sources; // the old vertex that each new one copies
    std::vector<glm::vec2> uvs;    // of each new vertex
    std::vector<uint32_t> indices; // as many triangles as before, in the same order
    uint32_t charts = 0;
    float gap = 0.0f; // least distance between charts, in widths of the texture; half of it at the border
};

// Looks at positions and indices only. The same mesh gives the same result everywhere. Triangles without area
// are kept; their UVs are a point. Throws Error when the mesh is too large or shattered to be packed, with
// the reason alone.
Unwrapping unwrap(const Mesh& mesh);

// Gives the mesh the new vertices, all attributes carried along, and says how good they are.
void apply(const Unwrapping& unwrapping, Mesh& mesh);

// Of the map from space to lit UVs. Stretch: how much longer a lumel is in one direction than in the other,
// 1 or more. Density: lumels per metre in relation to the mesh's mean.
UnwrapReport measureUnwrap(const Mesh& mesh);

} // namespace lumel::scene
