// The structs that C++ and GLSL share have the same layout in both: offsetof against the SPIR-V decorations.
#include "gpu/pipeline.h"
#include "shared/structs.h"
#include <gtest/gtest.h>
#include <map>

using namespace lumel;

namespace {

enum SpirvOp : uint32_t {
    OpName = 5,
    OpMemberName = 6,
    OpTypeArray = 28,
    OpTypeRuntimeArray = 29,
    OpDecorate = 71,
    OpMemberDecorate = 72
};
enum SpirvDecoration : uint32_t { ArrayStride = 6, Offset = 35 };

struct SpirvLayout {
    std::map<std::string, std::map<std::string, uint32_t>> offsets; // struct, member
    std::map<std::string, uint32_t> strides;                        // struct, as element of an array
};

// SPIR-V specification, section 3: words of (length << 16 | opcode) after a five-word header. A struct may
// appear several times (once per storage use); only laid-out copies carry offsets.
void readLayout(std::span<const uint32_t> code, SpirvLayout& layout)
{
    std::map<uint32_t, std::string> names;
    std::map<uint32_t, std::map<uint32_t, std::string>> memberNames;
    std::map<uint32_t, std::map<uint32_t, uint32_t>> memberOffsets;
    std::map<uint32_t, uint32_t> strides, elements;
    for (size_t at = 5; at < code.size(); at += code[at] >> 16) {
        const uint32_t* word = code.data() + at;
        const auto text = [&](size_t from) {
            return std::string(reinterpret_cast<const char*>(word + from));
        };
        switch (word[0] & 0xffffu) {
        case OpName:
            names[word[1]] = text(2);
            break;
        case OpMemberName:
            memberNames[word[1]][word[2]] = text(3);
            break;
        case OpMemberDecorate:
            if (word[3] == Offset)
                memberOffsets[word[1]][word[2]] = word[4];
            break;
        case OpDecorate:
            if (word[2] == ArrayStride)
                strides[word[1]] = word[3];
            break;
        case OpTypeArray:
        case OpTypeRuntimeArray:
            elements[word[1]] = word[2];
            break;
        default:
            break;
        }
    }
    for (const auto& [id, members] : memberOffsets)
        for (const auto& [member, offset] : members)
            layout.offsets[names[id]][memberNames[id][member]] = offset;
    for (const auto& [array, element] : elements)
        if (strides.contains(array))
            layout.strides[names[element]] = strides[array];
}

const SpirvLayout& spirvLayout()
{
    static const SpirvLayout layout = [] {
        SpirvLayout result;
        for (const std::string& name : gpu::shaderNames())
            readLayout(gpu::shaderCode(name), result);
        return result;
    }();
    return layout;
}

} // namespace

#define EXPECT_OFFSET(type, member)                                                                          \
    do {                                                                                                     \
        const auto& members = spirvLayout().offsets.at(#type);                                               \
        ASSERT_TRUE(members.contains(#member)) << #type "." #member;                                         \
        EXPECT_EQ(members.at(#member), offsetof(shared::type, member)) << #type "." #member;                 \
    } while (false)

TEST(SharedStructs, OffsetsEqualTheSpirvOffsets)
{
    EXPECT_OFFSET(Vertex, position);
    EXPECT_OFFSET(Vertex, normal);
    EXPECT_OFFSET(Vertex, tangent);
    EXPECT_OFFSET(Vertex, uv);
    EXPECT_OFFSET(Vertex, materialUv);
    EXPECT_OFFSET(Vertex, emissionUv);
    EXPECT_OFFSET(Influence, joint);
    EXPECT_OFFSET(Influence, weight);
    EXPECT_OFFSET(MorphDelta, target);
    EXPECT_OFFSET(MorphDelta, position);
    EXPECT_OFFSET(MorphDelta, normal);
    EXPECT_OFFSET(MorphDelta, tangent);
    EXPECT_OFFSET(DeformPush, rest);
    EXPECT_OFFSET(DeformPush, deformed);
    EXPECT_OFFSET(DeformPush, joints);
    EXPECT_OFFSET(DeformPush, firstDeltas);
    EXPECT_OFFSET(DeformPush, deltas);
    EXPECT_OFFSET(DeformPush, matrices);
    EXPECT_OFFSET(DeformPush, weights);
    EXPECT_OFFSET(DeformPush, vertexCount);
    EXPECT_OFFSET(DeformPush, influences);
    EXPECT_OFFSET(DeformPush, morphs);
    EXPECT_OFFSET(Light, position);
    EXPECT_OFFSET(Light, type);
    EXPECT_OFFSET(Light, direction);
    EXPECT_OFFSET(Light, inverseRange);
    EXPECT_OFFSET(Light, intensity);
    EXPECT_OFFSET(Light, coneScale);
    EXPECT_OFFSET(Light, coneOffset);
    EXPECT_OFFSET(Light, changed);
    EXPECT_OFFSET(View, clipFromWorld);
    EXPECT_OFFSET(View, eyeInWorld);
    EXPECT_OFFSET(View, lightCount);
    EXPECT_OFFSET(View, skyRadiance);
    EXPECT_OFFSET(View, exposure);
    EXPECT_OFFSET(View, groundRadiance);
    EXPECT_OFFSET(View, anisotropy);
    EXPECT_OFFSET(View, sizePixels);
    EXPECT_OFFSET(View, frame);
    EXPECT_OFFSET(View, levelOffset);
    EXPECT_OFFSET(View, lightsChanged);
    EXPECT_OFFSET(View, objects);
    EXPECT_OFFSET(View, environment);
    EXPECT_OFFSET(View, shadowCount);
    EXPECT_OFFSET(View, shadows);
    EXPECT_OFFSET(View, shadowed);
    EXPECT_OFFSET(View, worldFromClip);
    EXPECT_OFFSET(EnvironmentView, diffuse);
    EXPECT_OFFSET(EnvironmentView, intensity);
    EXPECT_OFFSET(EnvironmentView, turn);
    EXPECT_OFFSET(Shadow, mapFromWorld);
    EXPECT_OFFSET(Shadow, light);
    EXPECT_OFFSET(Shadow, texel);
    EXPECT_OFFSET(Object, worldFromObject);
    EXPECT_OFFSET(Object, worldFromObjectNormal);
    EXPECT_OFFSET(Object, vertices);
    EXPECT_OFFSET(Object, indices);
    EXPECT_OFFSET(Object, texels);
    EXPECT_OFFSET(Object, colours);
    EXPECT_OFFSET(Object, dielectric);
    EXPECT_OFFSET(Object, texelOffsets);
    EXPECT_OFFSET(Object, litSize);
    EXPECT_OFFSET(Object, materialLevelOffset);
    EXPECT_OFFSET(Object, emissiveLevelOffset);
    EXPECT_OFFSET(Object, flags);
    EXPECT_OFFSET(Object, alphaCutoff);
    EXPECT_OFFSET(Object, changed);
    EXPECT_OFFSET(Object, mips);
    EXPECT_OFFSET(Object, layer);
    EXPECT_OFFSET(Object, litLevel);
    EXPECT_OFFSET(Object, finest);
    EXPECT_OFFSET(Object, lightJob);
    EXPECT_OFFSET(Object, cachedJob);
    EXPECT_OFFSET(Object, lowerJob);
    EXPECT_OFFSET(Object, tileOffsets);
    EXPECT_OFFSET(Object, tiles);
    EXPECT_OFFSET(Tile, object);
    EXPECT_OFFSET(Tile, place);
    EXPECT_OFFSET(TileState, eye);
    EXPECT_OFFSET(TileState, lit);
    EXPECT_OFFSET(TileState, centre);
    EXPECT_OFFSET(TileState, radius);
    EXPECT_OFFSET(TileState, rates);
    EXPECT_OFFSET(TileState, change);
    EXPECT_OFFSET(TileState, shown);
    EXPECT_OFFSET(TileState, needed);
    EXPECT_OFFSET(TileState, held);
    EXPECT_OFFSET(TileState, derived);
    EXPECT_OFFSET(TileState, surface);
    EXPECT_OFFSET(TileState, cached);
    EXPECT_OFFSET(TileState, checked);
    EXPECT_OFFSET(JobTile, tile);
    EXPECT_OFFSET(JobTile, quads);
    EXPECT_OFFSET(JobTile, surface);
    EXPECT_OFFSET(JobTile, visible);
    EXPECT_OFFSET(JobTile, shadows);
    EXPECT_OFFSET(JobTile, lights);
    EXPECT_OFFSET(Mark, tile);
    EXPECT_OFFSET(Mark, verdict);
    EXPECT_OFFSET(Mark, quads);
    EXPECT_OFFSET(Plan, marked);
    EXPECT_OFFSET(Plan, groups);
    EXPECT_OFFSET(Plan, chosen);
    EXPECT_OFFSET(Plan, chosenGroups);
    EXPECT_OFFSET(Plan, unbound);
    EXPECT_OFFSET(Plan, unboundGroups);
    EXPECT_OFFSET(Plan, histogram);
    EXPECT_OFFSET(Plan, threshold);
    EXPECT_OFFSET(Plan, share);
    EXPECT_OFFSET(Plan, tilesLit);
    EXPECT_OFFSET(Plan, quadsMarked);
    EXPECT_OFFSET(Plan, quadsLit);
    EXPECT_OFFSET(Plan, quadsDerived);
    EXPECT_OFFSET(Plan, quadsPending);
    EXPECT_OFFSET(Plan, surfacesTaken);
    EXPECT_OFFSET(Plan, dropped);
    EXPECT_OFFSET(Job, groups);
    EXPECT_OFFSET(Job, count);
    EXPECT_OFFSET(Job, capacity);
    EXPECT_OFFSET(Job, first);
    EXPECT_OFFSET(ObjectFeedback, level);
    EXPECT_OFFSET(ObjectFeedback, samples);
    EXPECT_OFFSET(FeedbackPush, objects);
    EXPECT_OFFSET(FeedbackTotal, elongations);
    EXPECT_OFFSET(FeedbackTotal, carries);
    EXPECT_OFFSET(FeedbackPush, total);
    EXPECT_OFFSET(FeedbackPush, jitter);
    EXPECT_OFFSET(FeedbackPush, divisor);
    EXPECT_OFFSET(FeedbackPush, object);
    EXPECT_OFFSET(FeedbackPush, size);
    EXPECT_OFFSET(ShadowPush, clipFromWorld);
    EXPECT_OFFSET(ShadowPush, object);
    EXPECT_OFFSET(PlanPush, plan);
    EXPECT_OFFSET(PlanPush, marks);
    EXPECT_OFFSET(PlanPush, jobs);
    EXPECT_OFFSET(PlanPush, tiles);
    EXPECT_OFFSET(PlanPush, samples);
    EXPECT_OFFSET(PlanPush, divisor);
    EXPECT_OFFSET(PlanPush, reach);
    EXPECT_OFFSET(PlanPush, objectCount);
    EXPECT_OFFSET(PlanPush, budgetQuads);
    EXPECT_OFFSET(PlanPush, refreshShare);
    EXPECT_OFFSET(PlanPush, tolerance);
    EXPECT_OFFSET(PlanPush, markCapacity);
    EXPECT_OFFSET(PlanPush, marking);
    EXPECT_OFFSET(PlanPush, surfaces);
    EXPECT_OFFSET(SurfaceCacheState, capacity);
    EXPECT_OFFSET(SurfaceCacheState, emptied);
    EXPECT_OFFSET(LightPush, plan);
    EXPECT_OFFSET(LightPush, jobs);
    EXPECT_OFFSET(LightPush, tiles);
    EXPECT_OFFSET(LightPush, job);
    EXPECT_OFFSET(LightPush, surfaces);
    EXPECT_OFFSET(LightPush, surfaceCapacity);
    EXPECT_OFFSET(DrawPush, object);
    EXPECT_OFFSET(DrawPush, opacity);
    EXPECT_OFFSET(DrawPush, level);
    EXPECT_OFFSET(DrawPush, frame);
    EXPECT_OFFSET(LitPush, draw);
    EXPECT_OFFSET(LitPush, tiles);
    EXPECT_OFFSET(LitPush, size);
    EXPECT_OFFSET(LitPush, level);
    EXPECT_OFFSET(LitPush, finest);
    EXPECT_OFFSET(LitPush, anisotropy);
    EXPECT_OFFSET(LitPush, layer);
    EXPECT_OFFSET(LitPush, mips);
    EXPECT_OFFSET(LitPush, tileOffsets);
    EXPECT_OFFSET(ViewPush, draw);
    EXPECT_OFFSET(ViewPush, kind);
    EXPECT_OFFSET(ForwardPush, draw);
    EXPECT_OFFSET(ForwardPush, lights);
    EXPECT_OFFSET(ForwardPush, flags);
    EXPECT_OFFSET(ForwardPush, alphaCutoff);
    EXPECT_OFFSET(ForwardPush, dielectric);
    EXPECT_OFFSET(EdgeList, groups);
    EXPECT_OFFSET(EdgeList, count);
    EXPECT_OFFSET(EdgePixel, place);
    EXPECT_OFFSET(EdgePixel, radiance);
    EXPECT_OFFSET(EdgePush, list);
    EXPECT_OFFSET(EdgePush, pixels);
    EXPECT_OFFSET(EdgePush, size);
    EXPECT_OFFSET(EdgePush, capacity);
    EXPECT_OFFSET(PoolPush, rectangle);
    EXPECT_OFFSET(PoolPush, layer);
    EXPECT_OFFSET(PoolPush, shade);
    EXPECT_OFFSET(DisplayPush, weight);
    EXPECT_OFFSET(DisplayPush, size);
    EXPECT_OFFSET(FloorPush, size);
    EXPECT_OFFSET(FloorPush, lumels);
    EXPECT_OFFSET(MeterPush, histogram);
    EXPECT_OFFSET(MeterPush, size);
    EXPECT_OFFSET(ScalePush, from);
    EXPECT_OFFSET(ScalePush, to);
}

TEST(SharedStructs, ArrayStridesEqualTheSizes)
{
    const auto& strides = spirvLayout().strides;
    EXPECT_EQ(strides.at("Vertex"), sizeof(shared::Vertex));
    EXPECT_EQ(strides.at("Light"), sizeof(shared::Light));
    EXPECT_EQ(strides.at("Object"), sizeof(shared::Object));
    EXPECT_EQ(strides.at("TileState"), sizeof(shared::TileState));
    EXPECT_EQ(strides.at("JobTile"), sizeof(shared::JobTile));
    EXPECT_EQ(strides.at("Mark"), sizeof(shared::Mark));
    EXPECT_EQ(strides.at("Job"), sizeof(shared::Job));
    EXPECT_EQ(strides.at("EdgePixel"), sizeof(shared::EdgePixel));
    EXPECT_EQ(strides.at("ObjectFeedback"), sizeof(shared::ObjectFeedback));
}
