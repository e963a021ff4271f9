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
layout(buffer_reference) buffer Objects;
layout(buffer_reference) buffer JobTiles;
layout(buffer_reference) buffer TileStates;
layout(buffer_reference) buffer FeedbackList;
layout(buffer_reference) buffer FeedbackTotals;
layout(buffer_reference) buffer Plans;
layout(buffer_reference) buffer Jobs;
layout(buffer_reference) buffer Marks;
layout(buffer_reference) buffer DeformedVertices;
layout(buffer_reference) buffer Influences;
layout(buffer_reference) buffer MorphDeltas;
layout(buffer_reference) buffer Matrices;
layout(buffer_reference) buffer Floats;
layout(buffer_reference) buffer Colours;
layout(buffer_reference) buffer Histogram;
layout(buffer_reference) buffer Surfaces;
layout(buffer_reference) buffer EdgeLists;
layout(buffer_reference) buffer EdgePixels;
#endif

struct Vertex {
    vec3 position; // metres, object space
    vec3 normal;   // unit
    vec4 tangent;  // unit xyz, w = handedness: B = w cross(N, T)
    vec2 uv;       // lit UVs: where its lumels are; unique, (0, 0) = upper left corner
    vec2 materialUv; // where the material's maps are read; equal to uv where the file's own are unique
    vec2 emissionUv;     // the same for emission and occlusion
};

// Vertex attributes by location: of each vertex, and of the object (an instance's index is its object's).
LUMEL_CONST uint kAttributePosition = 0u;
LUMEL_CONST uint kAttributeNormal = 1u;
LUMEL_CONST uint kAttributeTangent = 2u;
LUMEL_CONST uint kAttributeUv = 3u;
LUMEL_CONST uint kAttributeMaterialUv = 4u;  // and emissionUv
LUMEL_CONST uint kAttributeWorld = 5u;       // worldFromObject, four columns
LUMEL_CONST uint kAttributeWorldNormal = 9u; // worldFromObjectNormal, three columns

// How strongly a joint moves a vertex. A vertex's weights sum to 1.
struct Influence {
    uint joint;
    float weight;
};

// What a morph target adds to a vertex at weight 1.
struct MorphDelta {
    uint target;
    vec3 position, normal, tangent;
};

LUMEL_CONST uint kLightDirectional = 0u;
LUMEL_CONST uint kLightPoint = 1u;
LUMEL_CONST uint kLightSpot = 2u;

// What a uniform buffer of 64 KiB holds.
LUMEL_CONST uint kMaxLights = 1024u;
struct Light {
    vec3 position;      // metres
    uint type;          // kLight...
    vec3 direction;     // the way the light travels, unit
    float inverseRange; // 1 / metres, 0 = no limit
    vec3 intensity;     // linear colour times lux (directional) or candela
    float coneScale;    // spot: cone = clamp(cos(angle) * coneScale + coneOffset)^2
    float coneOffset;
    uint changed; // frame in which it last moved or changed
};

// The environment, see shared/environment.h.
struct EnvironmentView {
    vec3 diffuse[9]; // of the quadric, scaled by the intensity
    float intensity; // multiplies the texture
    vec2 turn;       // cosine and sine of the rotation about +Y
};

// What shaders are compiled with (specialisation constant 0, see interface.glsl): software Vulkan runs both sides
// of any other branch.
LUMEL_CONST uint kFeatureEnvironment = 1u;
LUMEL_CONST uint kFeatureShadows = 2u;
LUMEL_CONST uint kFeatureColoured = 4u; // vertices have colours
LUMEL_CONST uint kFeatureWaiting = 8u;  // classify.comp, draw.frag: some lumels may wait for their light, or fade in
// A material's map is one texel: it is not filtered.
LUMEL_CONST uint kFeatureConstantEmission = 16u;
LUMEL_CONST uint kFeatureConstantOpacity = 32u;
LUMEL_CONST uint kFeatureConstantBase = 64u;
LUMEL_CONST uint kFeatureUnshadowed = 128u;  // some lights have no shadow map
LUMEL_CONST uint kFeatureManyLights = 256u;  // more than one word of a list
LUMEL_CONST uint kFeatureTail = 1024u; // lower.comp: MIPs of one tile each, made of each other
LUMEL_CONST uint kFeatureSecondLobe = 2048u; // the material has texels of two lobes
LUMEL_CONST uint kFeatureKnownShadows = 512u; // the surface cache has all visibility that is needed

// Bits of JobTile::lights.
LUMEL_CONST uint kListedLights = 256u;

// A light's shadow map: a layer of the array. Each light costs a map's memory and up to four comparisons per lumel.
LUMEL_CONST uint kMaxShadows = 8u;
struct Shadow {
    mat4 mapFromWorld; // xy: 0 to 1 over the map, z: depth
    uint light;        // below kListedLights
    float texel;       // metres, at a w of 1
};

// One camera of one frame.
struct View {
    mat4 clipFromWorld;
    vec3 eyeInWorld;
    uint lightCount;
    vec3 skyRadiance; // ambient hemisphere, +Y
    float exposure;   // display only: multiplies radiance
    vec3 groundRadiance;
    float anisotropy; // of this frame: most taps along a footprint's long axis, 1 = isotropic
    uvec2 sizePixels;
    uint frame;        // from 1
    float levelOffset; // levels that lit textures are coarser than one lumel per pixel
    uint lightsChanged; // frame in which a light last moved or changed
    uint unused;        // addresses are aligned to 8
    LUMEL_ADDRESS(Objects) objects;
    EnvironmentView environment;
    uint shadowCount;
    Shadow shadows[kMaxShadows];
    uint shadowed[kListedLights / 32u]; // the lights that have a map, as in JobTile
    mat4 worldFromClip; // for the background
};

// Workgroups of 64 invocations that cover a list, in rows: no device has to take more than 65535 workgroups along
// one dimension (Vulkan 1.3, table of required limits, maxComputeWorkGroupCount).
LUMEL_CONST uint kMostGroups = 65535u;
LUMEL_FN uvec2 groupRows(uint invocations)
{
    uint groups = max((invocations + 63u) / 64u, 1u);
    uint rows = (groups + kMostGroups - 1u) / kMostGroups;
    return uvec2((groups + rows - 1u) / rows, rows);
}

LUMEL_CONST uint kMaxLevels = 14u; // 8192 lumels down to 1

LUMEL_CONST uint kObjectDoubleSided = 1u;
LUMEL_CONST uint kObjectMask = 2u; // alpha below alphaCutoff is cut out
LUMEL_CONST uint kObjectOwnMaterialUv = 4u; // its material UVs are not its lit UVs
LUMEL_CONST uint kObjectLightable = 8u;     // it can be lit in texture space
LUMEL_CONST uint kObjectUnlit = 16u; // its colour is what it emits
LUMEL_CONST uint kObjectMirrored = 32u; // worldFromObject mirrors
LUMEL_CONST uint kObjectDeformed = 64u; // by joints or morph targets
LUMEL_CONST uint kObjectSecondLobe = 128u; // its material has texels of two lobes

// In texels of 16 bytes, so that compute shaders read it as a uniform texel buffer (lib/lit_object.glsl): on software
// Vulkan that costs a sixth of a buffer reference's loads.
struct Object {
    mat4 worldFromObject;
    mat3 worldFromObjectNormal; // inverse transpose
    uint flags;                 // kObject...
    float alphaCutoff;
    float dielectric;           // reflectance that vertex colours do not tint; < 0: they tint none
    LUMEL_ADDRESS(Vertices) vertices;
    LUMEL_ADDRESS(Indices) indices;
    LUMEL_ADDRESS(Texels) texels;   // the mesh's texel map, all levels
    LUMEL_ADDRESS(Colours) colours; // of the vertices, RGBA in half floats; read where there are any only
    // The lit texture that the object draws this frame: one layer of a pool block.
    LUMEL_ADDRESS(TileStates) tiles;
    uint changed;                  // frame in which it last moved
    float finest;                  // least MIP drawn; falls to 0 over a few frames after litLevel fell
    uvec2 litSize;                 // lumels of level 0, powers of two
    uint litLevel;                 // level of the texture's MIP 0: the object's maximum MIP level
    uint mips;                     // 0: none, the object is drawn forward
    uint layer;
    uint lightJob;                 // of its tiles
    uint cachedJob;                // of those whose surface is cached; the next, where shadows are to be found
    uint lowerJob;                 // of its MIP 1 tiles; each coarser MIP's follows, the tail's is one
    uint texelOffsets[kMaxLevels]; // first tile's words of each level in the texel map
    float materialLevelOffset;     // material level = lit level + this, where the UVs are the same
    float emissiveLevelOffset;     // the same for emissive, a map of a size of its own
    uint tileOffsets[kMaxLevels];  // first tile of each MIP
    uint firstVertex;              // in the buffer of `vertices`
    uint unused;
};
LUMEL_CONST uint kObjectTexels = 20u;
// Of these, where they are.
LUMEL_CONST uint kTexelOfFlags = 6u;     // flags in y
LUMEL_CONST uint kTexelOfAddresses = 8u; // texels, colours
LUMEL_CONST uint kTexelOfTiles = 9u;     // tiles, changed, finest
LUMEL_CONST uint kTexelOfSize = 10u;     // litSize, litLevel, mips
LUMEL_CONST uint kTexelOfJobs = 11u;     // layer, lightJob, cachedJob, lowerJob
LUMEL_CONST uint kTexelOfTexelOffsets = 12u;
LUMEL_CONST uint kTexelOfTileOffsets = 16u;
LUMEL_CONST uint kObjectBytes = 320u; // sizeof

// All MIPs of a lit texture lie in one layer: MIP 0 at (0, 0), the others below each other to its right.
// One image then serves light, lower and draw without a view for every MIP.
// size: powers of two.
LUMEL_FN uvec2 mipOrigin(uvec2 size, uint mip)
{
    if (mip == 0u)
        return uvec2(0u, 0u);
    // The heights of MIPs 1 to mip - 1: halves down to 1, then 1 each.
    uint halves = min(mip - 1u, uint(findMSB(size.y)));
    return uvec2(size.x, size.y - (size.y >> halves) + (mip - 1u - halves));
}

// The finest MIP that is a single tile, in a chain of so many: it and the coarser ones are lit for every object in
// view.
LUMEL_FN uint tailMip(uint mips)
{
    return mips - min(mips, 4u);
}

// The first MIP of those that one group derives after each other: each is a single tile, made of the one before.
LUMEL_FN uint derivedTail(uint mips)
{
    return max(tailMip(mips), 1u);
}

// An 8x8-lumel tile of an object's lit texture. It is lit and derived by quads of 2x2 lumels: bit 4 y + x of a mask is
// quad (x, y).
LUMEL_CONST uint kTileSize = 8u;
LUMEL_CONST uint kTileLumels = 64u;
LUMEL_CONST uint kQuadSize = 2u;
LUMEL_CONST uint kQuadLumels = 4u;
LUMEL_CONST uint kAllQuads = 0xffffu;
LUMEL_CONST uint kPlaceWaited = 0x80000000u; // the frame before needed it too
struct Tile {
    uint object;
    uint place; // kPlaceWaited | mip << 24 | y << 12 | x, in tiles
};

// What is known of a tile as long as its object keeps the texture. Frames count from 1; 0 = never.
struct TileState {
    vec3 eye;     // where it was lit from, world
    uint lit;     // frame in which it was last lit or, where none of it is lit, derived
    vec3 centre;  // of the surface that its lumels cover, world
    float radius; // metres
    // Two halves: radians that the eye had turned when it was last lit, kTurnedAtFirst or kTurnedOfDerived; and the RMS
    // change of its lumels' display value per radian that was expected then. 0 = it has no light.
    uint rates;
    uint change;  // mean over its lumels of the squared change then, in 1 / kChangeUnit
    uint shown;   // frame from which it is drawn; it fades in over kFadeFrames
    uint needed;  // quads that the view reads, by the marking in the high half: none by any other
    uint held;    // quads that hold light: lit in the low half, derived in the high half
    uint derived; // frame in which the youngest of the lumels that it was derived from were lit
    uint surface; // its number in the surface cache (lib/surface_cache.glsl), 0 = none
    uint cached;  // quads whose surface that holds, in the high half those whose shadow visibility it holds
    uint checked; // frame in which both were last found up to date
};
LUMEL_CONST float kTurnedAtFirst = 2.0f;   // there was no light to compare with
LUMEL_CONST float kTurnedOfDerived = 4.0f; // its light is derived from finer tiles
LUMEL_CONST float kChangeUnit = 16777216.0f;
LUMEL_CONST uint kShownAtOnce = 0xffffffffu;
LUMEL_CONST uint kFadeFrames = 8u;

// A tile in the list of a job, with the lights that may reach it: bit i of word i / 32 is light i. Lights past
// the last bit are taken to reach every tile.
struct JobTile {
    Tile tile;
    uint quads;   // to light or to derive. In the high half: those of them that hold light already; to be emptied
    uint surface; // its number in the surface cache, 0 = none
    uint visible; // quads whose shadow visibility the cache holds; in the high half those to be emptied
    uint shadows; // bit i: the light of view.shadows[i] may reach the tile; bit 8 + i: its visibility has changed
    uint lights[kListedLights / 32u];
};

// A tile that this frame's view needs, and what happens to it.
struct Mark {
    Tile tile;
    uint verdict; // kVerdict..., or the priority of lighting it
    uint quads;   // to light, or that keep their light; kMarkMore
};
LUMEL_CONST uint kMarkMore = 0x10000u; // the tile's other quads keep theirs
LUMEL_CONST uint kPriorities = 64u; // the greater, the more urgent
LUMEL_CONST uint kVerdictKeep = 64u;
LUMEL_CONST uint kVerdictNone = 65u; // no surface, or all derived from finer tiles
// Priorities from here on are tiles that show nothing yet, or something that is no more.
LUMEL_CONST uint kPriorityChanged = 47u;
// The coarsest tile of an object that shows nothing yet: lit whatever the budget, so that nothing is black.
LUMEL_CONST uint kPriorityAlways = 63u;

// One frame's plan: how many tiles are marked, and which priorities are lit.
struct Plan {
    uint marked; // tiles
    uint groups[3]; // of a dispatch over the marked tiles, 64 each
    uint chosen;    // tiles to light
    uint chosenGroups[3];
    uint unbound;   // those of them without a ball around their surface
    uint unboundGroups[3];
    uint histogram[kPriorities]; // quads
    uint threshold; // this priority and greater ones are lit
    float share;    // of the quads of exactly that priority
    uint tilesLit;
    uint quadsMarked, quadsLit, quadsDerived, quadsPending; // pending: to be lit in later frames
    uint surfacesTaken; // of the surface cache's pages
    uint dropped; // entries beyond the capacity of a list; 0, since lists hold all existing tiles
    // These are kept from frame to frame, so that the CPU need not know them.
    uint surfacesBefore; // surfacesTaken of the frame before
    uint surfacesLatest; // the surface cache's last page given by then
    uint surfacesOldest; // the last one given before its memory was allocated
};

// A list of tiles for one dispatch: of one block and material or of cached surfaces (light), or of one block and MIP
// (lower).
struct Job {
    uint groups[3]; // of the dispatch; a group takes tile after tile
    uint count;     // tiles appended, of which the list holds at most `capacity`
    uint capacity;
    uint first; // in the list of all jobs' tiles
};
LUMEL_CONST uint kMaxJobGroups = 16384u;
LUMEL_CONST uint kLowerTiles = 8u; // that a group of the lower pass looks at together

// Texel of a texel map: triangle + 1 in the low 24 bits (0 = no surface near). In the high 8 bits coverage, 1 to
// kFullCoverage; or, of a gutter lumel, kTexelGutter with where the nearest covered lumel lies.
LUMEL_CONST uint kTexelTriangleMask = 0xffffffu;
LUMEL_CONST uint kTexelCoverageShift = 24u;
LUMEL_CONST uint kFullCoverage = 127u;
LUMEL_CONST uint kTexelGutter = 0x80000000u;
LUMEL_CONST int kGutterReach = 3; // lumels along either axis

LUMEL_FN uint texelCoverage(uint texel)
{
    return (texel & kTexelGutter) != 0u ? 0u : texel >> kTexelCoverageShift;
}
LUMEL_FN uint gutterTexel(uint triangle, ivec2 toCovered)
{
    int code = (toCovered.y + kGutterReach) * (2 * kGutterReach + 1) + toCovered.x + kGutterReach;
    return kTexelGutter | uint(code) << kTexelCoverageShift | triangle;
}
LUMEL_FN ivec2 gutterSource(uint texel)
{
    int code = int((texel & ~kTexelGutter) >> kTexelCoverageShift);
    return ivec2(code % (2 * kGutterReach + 1) - kGutterReach, code / (2 * kGutterReach + 1) - kGutterReach);
}

// A texel map has two words for each tile of each level. The first is two masks of its quads: those with any surface or
// gutter; in the high half those that surface covers whole. The second is the texel that all its lumels are; or
// kTexelsListed with where, in words of the map, its list lies: numbers of texels, by texelPlace(), then those texels.
// A tile of more than 16 texels has 64 of them and no numbers.
LUMEL_CONST uint kTexelsListed = 0x80000000u; // kTexelGutter: gutter texels are always listed
LUMEL_CONST uint kTexelListShift = 29u; // the list's kind: numbers of 1, 2, 4 bits, or 64 texels
LUMEL_CONST uint kTexelListMask = 0x1fffffffu;

// Bits for each lumel in the list.
LUMEL_FN uint texelListBits(uint tileTexels)
{
    uint kind = tileTexels >> kTexelListShift & 3u;
    return kind == 3u ? 32u : 1u << kind;
}
// A lumel's place in its tile's list: quad by quad.
LUMEL_FN uint texelPlace(uvec2 lumel)
{
    uint x = lumel.x % kTileSize, y = lumel.y % kTileSize;
    return (y / kQuadSize * (kTileSize / kQuadSize) + x / kQuadSize) * kQuadLumels + y % kQuadSize * kQuadSize + x % kQuadSize;
}

// Levels of the feedback pass: kFeedbackFinest + n / kFeedbackScale, finer than any grid has where it is magnified.
LUMEL_CONST uint kNotSeen = 0xffffffffu;
LUMEL_CONST uint kFeedbackScale = 256u;
LUMEL_CONST float kFeedbackFinest = -4.0f;
// What the feedback pass finds of an object.
struct ObjectFeedback {
    uint level;   // the least of all samples, kNotSeen when there are none
    uint samples;
};
// What it finds of the view: samples by how much longer than wide their footprints are (tsl/detail.h), in
// 1 / kFeedbackScale.
LUMEL_CONST uint kElongations = 20u; // bins
LUMEL_CONST uint kElongationsPerOctave = 4u;
struct FeedbackTotal {
    uint elongations[kElongations];
    uint carries[kElongations]; // of these, 2^32 each: a picture of 8192 x 8192 samples may need two
};

// Of one mesh that joints or morph targets move.
struct DeformPush {
    LUMEL_ADDRESS(Vertices) rest;
    LUMEL_ADDRESS(DeformedVertices) deformed;
    LUMEL_ADDRESS(Influences) joints; // `influences` of each vertex
    LUMEL_ADDRESS(Indices) firstDeltas; // of each vertex, and one more for the last's end
    LUMEL_ADDRESS(MorphDeltas) deltas;
    LUMEL_ADDRESS(Matrices) matrices; // of the skin's joints: from the mesh to where they take it
    LUMEL_ADDRESS(Floats) weights;    // of the morph targets
    uint vertexCount;
    uint influences;
    uint morphs; // 1: there are deltas
};

struct FeedbackPush {
    LUMEL_ADDRESS(FeedbackList) objects;
    LUMEL_ADDRESS(FeedbackTotals) total;
    vec2 jitter;   // of the samples, in full-size pixels
    float divisor; // full-size pixels per sample, per axis
    uint object;   // masked ones are drawn one by one
    uvec2 size;    // samples
};

struct ShadowPush {
    mat4 clipFromWorld;
    uint object;
};

// The surface cache. It is a ring of pages: one word of each lumel of a tile. The tile of number n > Plan::surfacesOldest
// has as many pages from n % capacity on as its lumels have words, the last ones behind the ring's end if need be, until
// `capacity` more have been given.
struct SurfaceCacheState {
    uint capacity; // pages
    uint emptied;  // 1: its memory is new
};
LUMEL_CONST uint kSurfaceWords = 4u; // of 16 bytes, a lumel of one lobe; the second takes one more
LUMEL_FN uint surfacePages(uint flags) // kObject...
{
    return (flags & kObjectSecondLobe) != 0u ? kSurfaceWords + 1u : kSurfaceWords;
}
// A frame gives so many pages of the ring to other tiles at most: what it reads is not among them.
LUMEL_FN uint surfacesAFrame(uint capacity)
{
    return capacity / 8u;
}

struct PlanPush {
    LUMEL_ADDRESS(Plans) plan;
    LUMEL_ADDRESS(Marks) marks;
    LUMEL_ADDRESS(Jobs) jobs;
    LUMEL_ADDRESS(JobTiles) tiles; // of all jobs
    uvec2 samples;       // of the feedback pass
    float divisor;       // full-size pixels per sample, per axis
    float margin;        // pixels around those that are marked too
    float reach;         // lumels around a point that the draw filter reads
    uint objectCount;
    uint budgetQuads;    // to light this frame
    float refreshShare;  // of the marked quads that may be lit again because the eye moved
    float tolerance;     // display value: a smaller expected change is left alone
    uint markCapacity;   // tiles that each third of `marks` holds: marked, chosen, unbound
    uint marking;        // its number, 16 bits, from 1
    SurfaceCacheState surfaces;
};

struct LightPush {
    LUMEL_ADDRESS(Plans) plan;
    LUMEL_ADDRESS(Jobs) jobs;
    LUMEL_ADDRESS(JobTiles) tiles; // of all jobs
    LUMEL_ADDRESS(Surfaces) surfaces;
    uint job;
    uint surfaceCapacity; // pages
};

// Opaque objects write it into alpha where edges are filtered: from 2, whole, exact in half floats. A pixel that
// nothing covers holds 0, one of the background 1.
LUMEL_FN float objectNumber(uint object)
{
    return 2.0f + float(object % 2046u);
}

struct DrawPush {
    uint object;
    float opacity; // forward: fades it in over the lit texture; or the object's number
    float level;   // forward: >= 0 fixes the material level (the reference reads level 0), < 0 derives it
    uint frame;
};

struct ForwardPush {
    DrawPush draw; // for the vertex shader
    uint lights[kListedLights / 32u]; // that may reach the object, as in JobTile
    uint flags;                       // of the object, as in Object
    float alphaCutoff, dielectric;
};

// What drawing a lit texture needs, all of it: loads that are the same for all pixels are cheap from here only.
struct LitPush {
    DrawPush draw; // for the vertex shader
    LUMEL_ADDRESS(TileStates) tiles;
    uvec2 size;        // lumels of MIP 0
    float level;       // added to a footprint's level over litSize: position in the MIP chain
    float finest;
    float anisotropy;
    uint layer;
    uint mips;
    uint tileOffsets[kMaxLevels];
};

LUMEL_CONST uint kFilterBilinear = 0u;
LUMEL_CONST uint kFilterBspline = 1u;
LUMEL_CONST uint kFilterCatmullRom = 2u;      // 5 taps
LUMEL_CONST uint kFilterCatmullRomExact = 3u; // 16 taps
LUMEL_CONST uint kFilterQuadratic = 4u;       // 3 taps

// What view.frag shows in place of the picture.
LUMEL_CONST uint kViewNone = 0u;
LUMEL_CONST uint kViewLevel = 1u;
LUMEL_CONST uint kViewAge = 2u;
LUMEL_CONST uint kViewLit = 3u;
LUMEL_CONST uint kViewDensity = 4u;
LUMEL_CONST uint kViewMode = 5u;
LUMEL_CONST uint kViewCharts = 6u;
LUMEL_CONST uint kViewNormal = 7u;
LUMEL_CONST uint kViewPower = 8u;
LUMEL_CONST uint kViewAnisotropy = 9u;
LUMEL_CONST uint kViewDiffuse = 10u;
LUMEL_CONST uint kViewSpecular = 11u;
LUMEL_CONST uint kViewError = 12u;
LUMEL_CONST uint kViewOvershading = 13u;
LUMEL_CONST uint kViewPool = 14u; // pool.frag's
LUMEL_CONST uint kViewLobes = 15u;

struct ViewPush {
    DrawPush draw; // for the vertex shader
    uint kind;     // kView...
};

// One texture of the pool as a picture.
struct PoolPush {
    vec4 rectangle; // left, top, width, height in clip space
    float layer;
    float shade;    // 1, less for a texture that this frame does not draw
};

// The least that a pass could take, measured beside it (floor_*): a square texture of so many lumels a side that is lit,
// made coarser and drawn, or a part of it.
LUMEL_CONST uint kFloorSide = 512u;
LUMEL_CONST uint kFloorSurfaceLayers = 3u; // of four words for each lumel: its surface and material, packed
// What drawing looks up for a pixel.
LUMEL_CONST uint kFloorBilinear = 0u;
LUMEL_CONST uint kFloorBicubic = 1u;
LUMEL_CONST uint kFloorTwoLevels = 2u; // bicubic on either, blended
struct FloorPush {
    uvec2 size;  // draw: lumels of the texture that the object would draw
    uint lumels; // light, lower: how many
};

// Pixels at edges between objects, listed for three dispatches.
struct EdgeList {
    uint groups[3]; // of a dispatch over the list, 64 each
    uint count;     // pixels appended, of which the list holds at most EdgePush::capacity
};
struct EdgePixel {
    uint place;     // y << 16 | x
    uvec2 radiance; // to come, in half floats
};
// Pixels that an invocation of edges_find.comp looks at.
LUMEL_CONST uvec2 kEdgeBlock = uvec2(4u, 8u);
struct EdgePush {
    LUMEL_ADDRESS(EdgeLists) list;
    LUMEL_ADDRESS(EdgePixels) pixels;
    uvec2 size; // pixels of the source that hold the picture
    uint capacity;
};

// Pixels below each other that an invocation of display.comp makes.
LUMEL_CONST uint kDisplayRows = 4u;
struct DisplayPush {
    float weight; // of the accumulated sum: 1 / samples
    uvec2 size;   // pixels of the source that hold the picture
};

// Rows of pixels that a group of meter.comp counts.
LUMEL_CONST uint kMeterRows = 16u;
struct MeterPush {
    LUMEL_ADDRESS(Histogram) histogram; // kMeterBins
    uvec2 size;                         // pixels of the source that hold the picture
};

struct ScalePush {
    uvec2 from, to; // pixels
};

LUMEL_SHARED_END

#ifdef __cplusplus
#include <cstddef>
namespace lumel::shared {
static_assert(sizeof(Vertex) == 64 && sizeof(Light) == 56 && sizeof(Tile) == 8);
static_assert(sizeof(Object) == kObjectBytes && sizeof(Object) == 16 * kObjectTexels);
static_assert(offsetof(Object, flags) == 16 * kTexelOfFlags + 4);
static_assert(offsetof(Object, texels) == 16 * kTexelOfAddresses && offsetof(Object, tiles) == 16 * kTexelOfTiles);
static_assert(offsetof(Object, litSize) == 16 * kTexelOfSize && offsetof(Object, layer) == 16 * kTexelOfJobs);
static_assert(offsetof(Object, texelOffsets) == 16 * kTexelOfTexelOffsets);
static_assert(offsetof(Object, tileOffsets) == 16 * kTexelOfTileOffsets);
static_assert(offsetof(View, objects) % 8 == 0 && offsetof(Object, vertices) % 8 == 0);
static_assert(sizeof(LitPush) <= 128 && sizeof(PlanPush) <= 128); // lavapipe's push constant limit
} // namespace lumel::shared
#endif
#endif
