#version 460
#extension GL_GOOGLE_include_directive : require
// The environment behind the scene, where nothing else is drawn.
#include "lib/environment.glsl"

layout(location = 0) in vec4 farInWorld;
layout(location = 0) out vec4 colour;

void main()
{
    vec3 d = farInWorld.xyz - farInWorld.w * view.eyeInWorld;
    colour = vec4(environmentRadiance(normalize(d), 0.0), 1.0);
}
