// Vertex pulling: to compute shaders, meshes are storage buffers.
#ifndef LUMEL_GEOMETRY_GLSL
#define LUMEL_GEOMETRY_GLSL
#include "lib/interface.glsl"

Vertex pullVertex(ObjectAt object, uint corner)
{
    return object.at.vertices.at[object.at.indices.at[corner]];
}

vec4 unpackColour(uvec2 packed)
{
    return vec4(unpackHalf2x16(packed.x), unpackHalf2x16(packed.y));
}

vec4 vertexColour(ObjectAt object, uint vertex)
{
    return unpackColour(object.at.colours.at[vertex]);
}

// Barycentric coordinates of p in the triangle of texture coordinates a, b, c; extrapolates outside.
vec3 barycentrics(vec2 a, vec2 b, vec2 c, vec2 p)
{
    vec2 ab = b - a, ac = c - a, ap = p - a;
    float area = ab.x * ac.y - ab.y * ac.x;
    float inverseArea = abs(area) > 1e-20 ? 1.0 / area : 0.0;
    float v = (ap.x * ac.y - ap.y * ac.x) * inverseArea;
    float w = (ab.x * ap.y - ab.y * ap.x) * inverseArea;
    return vec3(1.0 - v - w, v, w);
}
#endif
