// Skinning and morphing of a vertex: run by deform.comp each frame, and by the CPU where it needs the result.
#ifndef LUMEL_SHARED_DEFORM_H
#define LUMEL_SHARED_DEFORM_H
#include "structs.h"
LUMEL_SHARED_BEGIN

// Of length 1; where there is no direction left (scaled to nothing, or out of range) `otherwise`.
LUMEL_FN vec3 unitOr(vec3 v, vec3 otherwise)
{
    float length2 = dot(v, v);
    return length2 > 0.0f && length2 < 1e38f ? v / sqrt(length2) : otherwise;
}

// What a morph target adds at a weight. Lengths are normalised by skinned().
LUMEL_FN Vertex morphed(Vertex v, MorphDelta delta, float weight)
{
    v.position += weight * delta.position;
    v.normal += weight * delta.normal;
    v.tangent += vec4(weight * delta.tangent, 0.0f);
    return v;
}

// m: the mean of the joints' matrices, by their weights. Normals go by its cofactors, which are its inverse
// transpose times its determinant but need no division: correct under non-uniform scales. Where it mirrors, so
// does the bitangent, which is the cross product of the other two: w changes its sign.
LUMEL_FN Vertex skinned(Vertex v, mat4 m)
{
    vec3 x = vec3(m[0]), y = vec3(m[1]), z = vec3(m[2]);
    vec3 normal = v.normal.x * cross(y, z) + v.normal.y * cross(z, x) + v.normal.z * cross(x, y);
    float side = dot(x, cross(y, z)) < 0.0f ? -1.0f : 1.0f;
    normal *= side;
    vec3 tangent = v.tangent.x * x + v.tangent.y * y + v.tangent.z * z;
    v.position = vec3(m * vec4(v.position, 1.0f));
    v.normal = unitOr(normal, vec3(0.0f, 0.0f, 1.0f));
    v.tangent = vec4(unitOr(tangent, vec3(1.0f, 0.0f, 0.0f)), side * v.tangent.w);
    return v;
}

LUMEL_SHARED_END
#endif
