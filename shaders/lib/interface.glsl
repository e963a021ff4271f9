// Extensions, shared structs and the typed GPU addresses: every shader's first include.
//
// Software Vulkan masks what a branch leaves out but runs it, and ends a loop where no invocation is left in it: a loop
// whose test is on its top runs its body once more than needed. Where the body is dear, the test is at its end.
#ifndef LUMEL_INTERFACE_GLSL
#define LUMEL_INTERFACE_GLSL
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_buffer_reference_uvec2 : require
#include "shared/structs.h"

// What an Object names is aligned to 8: glslang aligns the load of an address in memory as it does what is there, and
// an address must not be loaded with less (VUID-StandaloneSpirv-PhysicalStorageBuffer64-06314).
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Vertices { Vertex at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Indices { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Texels { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Objects { Object at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer ObjectAt { Object at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer JobTiles { JobTile at[]; };
#ifndef LUMEL_TILE_STATES // a shader whose invocations read each other's writes makes them coherent
#define LUMEL_TILE_STATES
#endif
layout(buffer_reference, scalar, buffer_reference_align = 8) LUMEL_TILE_STATES buffer TileStates { TileState at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer FeedbackList { ObjectFeedback at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer FeedbackTotals { FeedbackTotal at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Plans { Plan at; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Jobs { Job at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Marks { Mark at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer DeformedVertices { Vertex at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Influences { Influence at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer MorphDeltas { MorphDelta at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Matrices { mat4 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Floats { float at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 8) readonly buffer Colours { uvec2 at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) buffer Histogram { uint at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 16) writeonly buffer Surfaces { uvec4 at[]; };

// Pipelines by what lights their objects. The draw filter is constant 1.
layout(constant_id = 0) const uint kFeatures = 0u; // kFeature...
const bool kTwoLobes = (kFeatures & kFeatureSecondLobe) != 0u;
const bool kColoured = (kFeatures & kFeatureColoured) != 0u;

// Of the frame. Uniform buffers: loads that are the same for all invocations are cheap from there.
layout(set = 0, binding = 0, scalar) uniform ViewBlock { View view; };
layout(set = 0, binding = 1, scalar) uniform LightBlock { Light lights[kMaxLights]; };

// By reference: a copy would carry its arrays along, which software Vulkan takes literally. The sum is in 32 bits,
// since not every device has integers of 64.
ObjectAt objectAt(uint index)
{
    uvec2 table = uvec2(view.objects);
    uint carry;
    uint low = uaddCarry(table.x, index * kObjectBytes, carry);
    return ObjectAt(uvec2(low, table.y + carry));
}
#endif
