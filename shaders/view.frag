#version 460
#extension GL_GOOGLE_include_directive : require
// What lies behind the picture, as colours: one quantity of the material or of the lit texture, by push.kind.
#include "lib/footprint.glsl"
#include "lib/material.glsl"
#include "lib/tiles.glsl"

layout(push_constant, scalar) uniform Constants { ViewPush push; };
layout(location = 0) in vec3 positionInWorld;
layout(location = 1) in vec3 normalInWorld;
layout(location = 3) in vec2 uv;
layout(location = 4) in vec4 materialUv;
layout(location = 0) out vec4 colour;

uint listedLights(uint word)
{
    return 0u; // nothing is lit
}

uint listedShadows()
{
    return 0u;
}

float listedVisibility(uint shadow, ShadingPoint point, vec3 toLight)
{
    return 1.0;
}

// 0 to 1 as blue, green, yellow, red.
vec3 heat(float t)
{
    t = clamp(t, 0.0, 1.0);
    return 0.7 * clamp(vec3(3.0 * t - 1.0, 1.5 - abs(3.0 * t - 1.5), 1.0 - 3.0 * t) + vec3(0.0, 0.2, 0.1), 0.0, 1.0);
}

vec3 tileView(LitObject object, float level)
{
    uint mips = clamp(object.mips, 1u, kMaxLevels);
    uint mip = min(uint(mipPosition(object, level)), mips - 1u);
    vec2 size = vec2(mipSize(object, mip));
    uvec2 tile = uvec2(clamp(uv * size, vec2(0.0), size - 1.0)) / kTileSize;
    TileState state = object.tiles.at[tileIndex(object, mip, tile)];
    float checker = ((tile.x + tile.y) & 1u) == 0u ? 1.0 : 0.8;
    if (push.kind == kViewOvershading) { // lumels lit in this frame for each pixel, 0 to 8; dark: none
        vec2 dx = dFdx(uv) * size, dy = dFdy(uv) * size;
        float lumels = state.lit == view.frame ? abs(dx.x * dy.y - dx.y * dy.x) : 0.0;
        return lumels == 0.0 ? vec3(0.05) : checker * heat(0.25 * log2(1.0 + 2.0 * lumels));
    }
    if (push.kind == kViewLit) // red: lit in this frame; grey: kept
        return checker * (state.lit == view.frame ? vec3(0.7, 0.15, 0.1) : vec3(0.25));
    if (push.kind == kViewAge)
        return checker * (state.lit == 0u ? vec3(0.6, 0.0, 0.6) : heat(float(view.frame - state.lit) / 32.0));
    return checker * heat(float(object.litLevel + mip) / 10.0); // kViewLevel
}

// Texture coordinates as a fine checker: it breaks where charts meet. Gutters that show are white.
vec3 chartView(LitObject object)
{
    uvec2 lumel = min(uvec2(uv * vec2(object.litSize)), object.litSize - 1u);
    if (texelCoverage(texelAt(object, 0u, lumel)) == 0u)
        return vec3(0.9);
    bool light = ((lumel.x / 32u + lumel.y / 32u) & 1u) == 0u;
    return (light ? 0.6 : 0.35) * vec3(uv, 0.4);
}

vec3 lobeView(MaterialTexel material)
{
    // Powers are the precision's eigenvalues: 1 / those of S.
    float mean = 0.5 * (material.covariance.x + material.covariance.z);
    float spread = length(vec2(0.5 * (material.covariance.x - material.covariance.z), material.covariance.y));
    if (push.kind == kViewPower)
        return heat(log2(1.0 / max(mean, 1e-5)) / log2(kMaxPower));
    return heat(0.25 * log2((mean + spread) / max(mean - spread, 1e-6))); // kViewAnisotropy: 1 to 16
}

void main()
{
    LitObject object = litObject(push.draw.object);
    float level = max(levelOf(mapNormal, dFdx(materialUv.xy), dFdy(materialUv.xy), 1.0), 0.0);
    Footprint lit = footprintOf(dFdx(uv), dFdy(uv), vec2(object.litSize), view.anisotropy);
    MaterialTexel texel = sampleMaterial(materialUv, vec2(level));
    bool inTextureSpace = object.mips > 0u;
    vec3 shown = vec3(0.0);
    if (push.kind == kViewMode) // green: texture space, red: forward
        shown = inTextureSpace ? vec3(0.1, 0.5, 0.15) : vec3(0.6, 0.15, 0.1);
    else if (push.kind == kViewDensity) // lumels per pixel along an axis, 1/4 to 4; green is 1
        shown = heat(0.5 + 0.25 * (lit.level - max(lit.level + view.levelOffset, 0.0)));
    else if (push.kind == kViewCharts)
        shown = inTextureSpace ? chartView(object) : vec3(0.2);
    else if (push.kind == kViewNormal)
        shown = 0.7 * (0.5 + 0.5 * vec3(texel.normal, sqrt(max(1.0 - dot(texel.normal, texel.normal), 0.0))));
    else if (push.kind == kViewDiffuse)
        shown = texel.diffuse;
    else if (push.kind == kViewSpecular)
        shown = texel.specular;
    else if (push.kind == kViewError)
        shown = heat(textureLod(mapDiffuse, materialUv.xy, level).w / 0.25);
    else if (push.kind == kViewLobes) {
        float second = luminanceOf(texel.second.specular), first = luminanceOf(texel.specular);
        shown = second > 0.0 ? heat(2.0 * second / max(first + second, 1e-6)) : vec3(0.05);
    } else if (push.kind == kViewPower || push.kind == kViewAnisotropy)
        shown = lobeView(texel);
    else
        shown = inTextureSpace ? tileView(object, lit.level + view.levelOffset) : vec3(0.05);
    float facing = abs(dot(normalize(normalInWorld), normalize(view.eyeInWorld - positionInWorld)));
    colour = vec4(shown * (0.6 + 0.4 * facing), 1.0);
}
