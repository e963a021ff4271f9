#version 460
#extension GL_GOOGLE_include_directive : require
// The formulas of shaders/shared on the GPU: see formulas_test.cpp.
#include "lib/interface.glsl"
#include "formulas.h"

layout(local_size_x = 64) in;
layout(buffer_reference, scalar, buffer_reference_align = 4) readonly buffer Inputs { FormulaInput at[]; };
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Outputs { FormulaOutput at[]; };
layout(push_constant, scalar) uniform Constants { Inputs inputs; Outputs outputs; uint count; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i < count)
        outputs.at[i] = formulas(inputs.at[i]);
}
