// Every struct that the CPU and the GPU share, once. GLSL blocks are `scalar`; in C++ the static_asserts
// below and tests/unit/structs_test.cpp (against the SPIR-V offsets) guard the layout.
#ifndef LUMEL_SHARED_STRUCTS_H
#define LUMEL_SHARED_STRUCTS_H
#include "compat.h"
LUMEL_SHARED_BEGIN

struct Vertex {
    vec3 position; // metres, object space
    vec3 normal;   // unit
    vec4 tangent;  // unit xyz, w = handedness: B = w cross(N, T)
    vec2 uv;       // texture coordinates, (0, 0) = upper left corner
};

LUMEL_SHARED_END
#endif
