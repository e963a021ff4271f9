// The surface cache: what lighting needs of a lumel's surface, whoever sees it and whatever lights it, in 64 bytes, 80 with
// a second lobe. Tiles whose object is at rest read it from there when they are lit again. All lumels go through this form, cached or not, so
// that their light is the same.
#ifndef LUMEL_SURFACE_CACHE_GLSL
#define LUMEL_SURFACE_CACHE_GLSL
#include "lib/surface.glsl"

// Meyer et al. 2010, "On Floating-Point Normal Vectors": the octahedron's faces in a square, 16 bits an axis.
uint packUnit(vec3 d)
{
    vec2 p = d.xy / (abs(d.x) + abs(d.y) + abs(d.z));
    vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    return packSnorm2x16(d.z < 0.0 ? folded : p);
}

vec3 unpackUnit(uint packed)
{
    vec2 p = unpackSnorm2x16(packed);
    float z = 1.0 - abs(p.x) - abs(p.y), t = max(-z, 0.0);
    return normalize(vec3(p.x + (p.x < 0.0 ? t : -t), p.y + (p.y < 0.0 ? t : -t), z));
}

// Two directions that complete n (unit): Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
mat2x3 tangentsOf(vec3 n)
{
    float s = n.z < 0.0 ? -1.0 : 1.0, a = -1.0 / (s + n.z), b = n.x * n.y * a;
    return mat2x3(1.0 + s * n.x * n.x * a, s * b, -s * n.x, b, s + n.y * n.y * a, -n.y);
}

// zw of the last word are left to the visibility of lights, 8 bits each.
struct SurfaceRecord {
    uvec4 words[kSurfaceWords];
    uvec4 second; // lobe, where there are two
};

// A lobe is stored as its precision's Cholesky factor in the frame of tangentsOf(): L L^T = P. Unlike P's own entries
// these lose nothing of a narrow lobe's determinant when they are rounded. normal: as packUnit() gives it.
vec3 choleskyOf(Lobe lobe, uint normal)
{
    mat2x3 tangents = tangentsOf(unpackUnit(normal));
    vec2 turn = normalize(vec2(dot(lobe.tangentU, tangents[0]), dot(lobe.tangentU, tangents[1])));
    float c = turn.x, s = turn.y;
    vec3 p = lobe.inverseCovariance;
    p.y *= dot(cross(lobe.normal, lobe.tangentU), lobe.tangentV) < 0.0 ? -1.0 : 1.0; // of a mirrored frame
    float xx = p.x * c * c - 2.0 * p.y * c * s + p.z * s * s;
    float xy = (p.x - p.z) * c * s + p.y * (c * c - s * s);
    float l11 = sqrt(max(xx, 1e-6));
    return vec3(l11, xy / l11, lobe.scale / l11);
}

Lobe lobeOf(uint packedNormal, vec3 cholesky)
{
    vec3 normal = unpackUnit(packedNormal);
    mat2x3 tangents = tangentsOf(normal);
    return Lobe(normal, tangents[0], tangents[1],
                vec3(cholesky.x * cholesky.x, cholesky.x * cholesky.y, cholesky.y * cholesky.y + cholesky.z * cholesky.z),
                cholesky.x * cholesky.z);
}

uvec4 packSecond(SecondSurfaceLobe second)
{
    uint normal = packUnit(second.lobe.normal);
    vec3 cholesky = choleskyOf(second.lobe, normal);
    return uvec4(normal, packHalf2x16(cholesky.xy), packHalf2x16(vec2(cholesky.z, second.specular.x)),
                 packHalf2x16(second.specular.yz));
}

SecondSurfaceLobe unpackSecond(uvec4 word)
{
    vec2 more = unpackHalf2x16(word.z);
    return SecondSurfaceLobe(lobeOf(word.x, vec3(unpackHalf2x16(word.y), more.x)), vec3(more.y, unpackHalf2x16(word.w)));
}

SurfaceRecord packSurface(SurfacePoint point)
{
    SurfaceTexel texel = point.texel;
    uint normal = packUnit(texel.lobe.normal);
    vec3 cholesky = choleskyOf(texel.lobe, normal);
    SurfaceRecord record;
    record.words[0] = uvec4(floatBitsToUint(point.position), packUnit(texel.macroNormal));
    record.words[1] = uvec4(normal, packHalf2x16(cholesky.xy), packHalf2x16(vec2(cholesky.z, texel.baseVariance)),
                            packHalf2x16(texel.specular.xy));
    record.words[2] = uvec4(packHalf2x16(vec2(texel.specular.z, point.occlusion)), packHalf2x16(texel.f0.xy),
                            packHalf2x16(vec2(texel.f0.z, texel.diffuse.x)), packHalf2x16(texel.diffuse.yz));
    record.words[3] = uvec4(packHalf2x16(point.emitted.xy), packHalf2x16(vec2(point.emitted.z, 0.0)), 0u, 0u);
    record.second = kTwoLobes ? packSecond(point.second) : uvec4(0u);
    return record;
}

SurfacePoint unpackSurface(SurfaceRecord record)
{
    vec2 cholesky = unpackHalf2x16(record.words[1].y), more = unpackHalf2x16(record.words[1].z);
    vec2 specular = unpackHalf2x16(record.words[1].w), rest = unpackHalf2x16(record.words[2].x);
    vec2 f0 = unpackHalf2x16(record.words[2].y), f0Diffuse = unpackHalf2x16(record.words[2].z);
    Lobe lobe = lobeOf(record.words[1].x, vec3(cholesky, more.x));
    SurfaceTexel texel =
        SurfaceTexel(lobe, unpackUnit(record.words[0].w), vec3(specular, rest.x), vec3(f0, f0Diffuse.x), more.y,
                     vec3(f0Diffuse.y, unpackHalf2x16(record.words[2].w)));
    return SurfacePoint(texel, uintBitsToFloat(record.words[0].xyz),
                        vec3(unpackHalf2x16(record.words[3].x), unpackHalf2x16(record.words[3].y).x), rest.y,
                        kTwoLobes ? unpackSecond(record.second) : noSecondLobe(lobe));
}

// Where a lumel's words are: in a page each, beside those of the tile's other lumels.
uint surfaceWord(uint number, uint capacity, uint word, uvec2 lumelInTile)
{
    return (number % capacity + word) * kTileLumels + lumelInTile.y * kTileSize + lumelInTile.x;
}
#endif
