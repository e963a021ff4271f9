// An object's lit texture, read once from the object table.
#ifndef LUMEL_LIT_OBJECT_GLSL
#define LUMEL_LIT_OBJECT_GLSL
#include "lib/interface.glsl"

layout(set = 0, binding = 4) uniform usamplerBuffer objectTable;

struct LitObject {
    int row; // its first texel in the table
    Texels texels;
    TileStates tiles;
    uint changed;
    float finest;
    uvec2 litSize;
    uint litLevel, mips, layer, lightJob, cachedJob, lowerJob;
};

LitObject litObject(uint index)
{
    int row = int(index * kObjectTexels);
    uvec4 addresses = texelFetch(objectTable, row + int(kTexelOfAddresses));
    uvec4 tiles = texelFetch(objectTable, row + int(kTexelOfTiles));
    uvec4 size = texelFetch(objectTable, row + int(kTexelOfSize));
    uvec4 jobs = texelFetch(objectTable, row + int(kTexelOfJobs));
    return LitObject(row, Texels(addresses.xy), TileStates(tiles.xy), tiles.z, uintBitsToFloat(tiles.w), size.xy, size.z,
                     size.w, jobs.x, jobs.y, jobs.z, jobs.w);
}

uint objectFlags(LitObject object) // kObject...
{
    return texelFetch(objectTable, object.row + int(kTexelOfFlags)).y;
}

// First tile's words of a level in the texel map, first tile of a MIP.
uint texelOffset(LitObject object, uint level)
{
    return texelFetch(objectTable, object.row + int(kTexelOfTexelOffsets + level / 4u))[level % 4u];
}
uint tileOffset(LitObject object, uint mip)
{
    return texelFetch(objectTable, object.row + int(kTexelOfTileOffsets + mip / 4u))[mip % 4u];
}
#endif
