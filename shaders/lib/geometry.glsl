// Vertex pulling: meshes are storage buffers, so that the rasteriser and light.comp read them the same way.
#ifndef LUMEL_GEOMETRY_GLSL
#define LUMEL_GEOMETRY_GLSL
#include "lib/interface.glsl"

Vertex pullVertex(Object object, uint corner)
{
    return object.vertices.at[object.indices.at[corner]];
}
#endif
