// Compute over a list of any length in workgroups of 64, see groupRows().
#ifndef LUMEL_ROWS_GLSL
#define LUMEL_ROWS_GLSL
// Place in the list; the last row may reach past its end.
uint listIndex()
{
    // gl_WorkGroupSize is known only below a shader's own declaration of it.
    return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
}
#endif
