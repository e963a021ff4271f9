// Extensions, shared structs and the typed GPU addresses: every shader's first include.
#ifndef LUMEL_INTERFACE_GLSL
#define LUMEL_INTERFACE_GLSL
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_buffer_reference : require
#include "shared/structs.h"

layout(buffer_reference, scalar) readonly buffer Vertices { Vertex at[]; };
layout(buffer_reference, scalar) readonly buffer Indices { uint at[]; };
layout(buffer_reference, scalar) readonly buffer Texels { uint at[]; };
layout(buffer_reference, scalar) readonly buffer Lights { Light at[]; };
layout(buffer_reference, scalar) readonly buffer Objects { Object at[]; };
layout(buffer_reference, scalar) readonly buffer Views { View at; };
layout(buffer_reference, scalar) readonly buffer Tiles { Tile at[]; };
layout(buffer_reference, scalar) buffer Needs { Need at[]; };
#endif
