#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_basic : require
// Light pass, of tiles whose surface is in the cache.
#include "lib/light_tiles.glsl"

layout(set = 1, binding = 0) uniform usamplerBuffer surfaces;

uint firstWord;

void beginTile(LitObject object, JobTile job)
{
    firstWord = surfaceWord(job.surface, push.surfaceCapacity, 0u, uvec2(0u));
}

LumelSurface surfaceOfLumel(uvec2 lumel)
{
    uvec2 inTile = lumel % kTileSize;
    int place = int(firstWord + inTile.y * kTileSize + inTile.x);
    LumelSurface result;
    for (uint i = 0u; i < kSurfaceWords; ++i)
        result.record.words[i] = texelFetch(surfaces, place + int(i * kTileLumels));
    if (kTwoLobes)
        result.record.second = texelFetch(surfaces, place + int(kSurfaceWords * kTileLumels));
    result.visible = result.record.words[kSurfaceWords - 1u].zw;
    result.changed = false;
    return result;
}
