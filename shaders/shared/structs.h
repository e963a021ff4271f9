// Every struct that the CPU and the GPU share, once. GLSL blocks are `scalar`; the static_asserts below
// guard the C++ side and tests/gpu/structs_test.cpp compares every offset with the SPIR-V's.
#ifndef LUMEL_SHARED_STRUCTS_H
#define LUMEL_SHARED_STRUCTS_H
#include "compat.h"
LUMEL_SHARED_BEGIN

// A GPU address of an array: a typed buffer reference in GLSL, a number in C++.
#ifdef __cplusplus
#define LUMEL_ADDRESS(type) std::uint64_t
#else
#define LUMEL_ADDRESS(type) type
layout(buffer_reference) buffer Vertices;
layout(buffer_reference) buffer Indices;
layout(buffer_reference) buffer Texels;
layout(buffer_reference) buffer Lights;
layout(buffer_reference) buffer Objects;
layout(buffer_reference) buffer Views;
layout(buffer_reference) buffer Tiles;
layout(buffer_reference) buffer Needs;
#endif

struct Vertex {
    vec3 position; // metres, object space
    vec3 normal;   // unit
    vec4 tangent;  // unit xyz, w = handedness: B = w cross(N, T)
    vec2 uv;       // texture coordinates, (0, 0) = upper left corner
};

LUMEL_CONST uint kLightDirectional = 0u;
LUMEL_CONST uint kLightPoint = 1u;
LUMEL_CONST uint kLightSpot = 2u;

struct Light {
    vec3 position;      // metres
    uint type;          // kLight...
    vec3 direction;     // the way the light travels, unit
    float inverseRange; // 1 / metres, 0 = no limit
    vec3 intensity;     // linear colour times lux (directional) or candela
    float coneScale;    // spot: cone = clamp(cos(angle) * coneScale + coneOffset)^2
    float coneOffset;
};

// One camera of one frame.
struct View {
    mat4 clipFromWorld;
    vec3 eyeInWorld;
    uint lightCount;
    vec3 skyRadiance; // ambient hemisphere, +Y
    float exposure;   // display only: multiplies radiance
    vec3 groundRadiance;
    float anisotropy; // most taps along a footprint's long axis, 1 = isotropic
    uvec2 sizePixels;
    LUMEL_ADDRESS(Lights) lights;
    LUMEL_ADDRESS(Objects) objects;
};

LUMEL_CONST uint kMaxLevels = 14u; // 8192 lumels down to 1

LUMEL_CONST uint kObjectDoubleSided = 1u;
LUMEL_CONST uint kObjectMask = 2u; // alpha below alphaCutoff is cut out

struct Object {
    mat4 worldFromObject;
    mat3 worldFromObjectNormal; // inverse transpose
    LUMEL_ADDRESS(Vertices) vertices;
    LUMEL_ADDRESS(Indices) indices;
    LUMEL_ADDRESS(Texels) texels;  // the mesh's texel map, all levels
    uint texelOffsets[kMaxLevels]; // first entry of each level in the texel map
    uvec2 litSize;                 // lumels of level 0, powers of two
    float materialLevelOffset;     // material level = lit level + this
    uint texelsCoincide;           // 1: lit and material levels have equal sizes where both exist
    uint flags;                    // kObject...
    float alphaCutoff;
    // The lit texture that the object draws this frame: a layer of a pool block.
    uint layer;
    uint litLevel; // level of the texture's MIP 0: the object's maximum MIP level
};

// An 8x8-lumel tile to light or to filter.
LUMEL_CONST uint kTileSize = 8u;
struct Tile {
    uint object;
    uint x; // in tiles
    uint y;
};

// Texel map entry: triangle + 1 in the low 24 bits (0 = no surface near), coverage in the high 8 (0 = gutter).
LUMEL_CONST uint kTexelTriangleMask = 0xffffffu;
LUMEL_CONST uint kTexelCoverageShift = 24u;

// What the need pass finds of an object. `level` is the least ever needed, in 1/256 of a level, kNotSeen
// when no sample saw the object.
LUMEL_CONST uint kNotSeen = 0xffffffffu;
LUMEL_CONST uint kNeedScale = 256u;
struct Need {
    uint level;
    uint samples; // quarter-resolution samples that saw it
};

struct NeedPush {
    LUMEL_ADDRESS(Views) view;
    LUMEL_ADDRESS(Needs) needs;
    vec2 jitter;    // sub-pixel offset in clip space
    float divisor;  // full-size pixels per sample, per axis
    uint object;
    uvec2 size;     // samples
};

struct LightPush {
    LUMEL_ADDRESS(Views) view;
    LUMEL_ADDRESS(Tiles) tiles;
    uint mip;       // of the lit texture
};

struct DrawPush {
    LUMEL_ADDRESS(Views) view;
    uint object;
    uint filterKind; // kFilter...
    float level;     // forward: >= 0 fixes the material level (the reference reads level 0), < 0 derives it
};

LUMEL_CONST uint kFilterBilinear = 0u;
LUMEL_CONST uint kFilterBspline = 1u;
LUMEL_CONST uint kFilterCatmullRom = 2u;

struct DisplayPush {
    LUMEL_ADDRESS(Views) view;
    float weight; // of the accumulated sum: 1 / samples
};

LUMEL_SHARED_END

#ifdef __cplusplus
#include <cstddef>
namespace lumel::shared {
static_assert(sizeof(Vertex) == 48 && sizeof(Light) == 52 && sizeof(Tile) == 12);
static_assert(offsetof(View, lights) % 8 == 0 && offsetof(Object, vertices) % 8 == 0);
static_assert(sizeof(DrawPush) <= 128 && sizeof(NeedPush) <= 128); // lavapipe's push constant limit
} // namespace lumel::shared
#endif
#endif
