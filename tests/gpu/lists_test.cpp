// The plan's shaders on their own, over lists too short and tiles that several invocations change at a time.
#include "gpu/barrier.h"
#include "gpu/pipeline.h"
#include "gpu/resource.h"
#include "test_scene.h"

using namespace lumel;
using namespace lumel::test;

namespace {

constexpr uint32_t kFrame = 20, kMarking = 7;
constexpr uint32_t kGuard = 0xdeadbeef;
constexpr uint32_t kMips = 8; // of 128 x 128 lumels; the last four are the tail, a tile each

// Buffers of one frame's plan, all readable by the CPU.
class PlanShaders : public GpuTest {
protected:
    template<class T>
    static gpu::Buffer list(size_t count)
    {
        gpu::Buffer buffer(device(), count * sizeof(T), gpu::Buffer::MemoryUsage::host, "list");
        std::fill_n(buffer.mapped<uint32_t>(), count * sizeof(T) / sizeof(uint32_t), 0u);
        return buffer;
    }

    // Those within a MIP of so many lumels across, of its first tile.
    static uint32_t quadsOf(uint32_t lumels)
    {
        uint32_t quads = 0;
        for (uint32_t i = 0; i < 16; ++i)
            if (2 * (i % 4) < lumels && 2 * (i / 4) < lumels)
                quads |= 1u << i;
        return quads;
    }

    void makeObjects(uint32_t count)
    {
        objectCount_ = count;
        shared::Object object{};
        object.litSize = glm::uvec2(128);
        object.mips = kMips;
        uint32_t texels = 0, tiles = 0;
        for (uint32_t mip = 0; mip < kMips; ++mip) {
            const uint32_t lumels = 128u >> mip, across = (lumels + 7) / 8;
            object.texelOffsets[mip] = texels;
            object.tileOffsets[mip] = tiles;
            texels += 2 * across * across; // masks and texels
            tiles += across * across;
        }
        tilesAnObject_ = tiles;
        texels_ = list<uint32_t>(texels);            // no surface: no vertices are read
        for (uint32_t mip = 0; mip < kMips; ++mip) { // though there is some, say the masks
            const uint32_t lumels = 128u >> mip, across = (lumels + 7) / 8;
            for (uint32_t tile = 0; tile < across * across; ++tile)
                texels_.mapped<uint32_t>()[object.texelOffsets[mip] + 2 * tile] = quadsOf(lumels);
        }
        states_ = list<shared::TileState>(size_t(count) * tiles);
        objects_ = list<shared::Object>(count);
        object.texels = texels_.address();
        object.lowerJob = 1;
        for (uint32_t i = 0; i < count; ++i) {
            object.tiles = states_.address() + size_t(i) * tiles * sizeof(shared::TileState);
            objects_.mapped<shared::Object>()[i] = object;
        }
        view_ = list<shared::View>(1);
        view_.mapped<shared::View>()->frame = kFrame;
        view_.mapped<shared::View>()->objects = objects_.address();
    }

    shared::TileState& state(uint32_t object, uint32_t mip, uint32_t tile = 0)
    {
        const auto& data = objects_.mapped<shared::Object>()[object];
        return states_
            .mapped<shared::TileState>()[size_t(object) * tilesAnObject_ + data.tileOffsets[mip] + tile];
    }

    // Capacities of the list of marks and of each job's list of tiles; guard words follow.
    void makeLists(uint32_t marks, const std::vector<uint32_t>& jobs)
    {
        plan_ = list<shared::Plan>(1);
        marks_ = list<shared::Mark>(3 * marks + 64); // marked, chosen, without a ball
        jobs_ = list<shared::Job>(std::max<size_t>(jobs.size(), 1));
        uint32_t first = 0;
        for (size_t i = 0; i < jobs.size(); first += jobs[i++])
            jobs_.mapped<shared::Job>()[i] = {
                .groups = {0, 1, 1}, .count = 0, .capacity = jobs[i], .first = first};
        tiles_ = list<shared::JobTile>(first + 64);
        std::fill_n(marks_.mapped<uint32_t>(), marks_.size() / 4, kGuard);
        std::fill_n(tiles_.mapped<uint32_t>(), tiles_.size() / 4, kGuard);
        push_ = {.plan = plan_.address(),
                 .marks = marks_.address(),
                 .jobs = jobs_.address(),
                 .tiles = tiles_.address(),
                 .samples = {0, 0},
                 .divisor = 1.0f,
                 .margin = 0.0f,
                 .reach = 2.0f,
                 .objectCount = objectCount_,
                 .budgetQuads = ~0u,
                 .refreshShare = 1.0f,
                 .tolerance = 0.0f,
                 .markCapacity = marks,
                 .marking = kMarking,
                 .surfaces = {}};
    }

    // FrameSet's, of which the plan's shaders read the view, the lights and the object table.
    static gpu::SetLayout makeFrameLayout()
    {
        using Type = vk::DescriptorType;
        return gpu::makeSetLayout(device(), {Type::eUniformBuffer, Type::eUniformBuffer, Type::eUniformBuffer,
                                             Type::eUniformBuffer, Type::eUniformTexelBuffer});
    }

    void run(const std::string& shader, uint32_t invocations)
    {
        using Type = vk::DescriptorType;
        const auto frameLayout = makeFrameLayout();
        const auto seenLayout = gpu::makeSetLayout(device(), {Type::eStorageImage});
        const auto frameSet = gpu::makeSet(device(), frameLayout),
                   seenSet = gpu::makeSet(device(), seenLayout);
        const gpu::Buffer lights = list<shared::Light>(shared::kMaxLights);
        for (uint32_t binding = 0; binding < 4; ++binding)
            gpu::writeUniform(device(), *frameSet, binding, view_.handle());
        const vk::raii::BufferView table = gpu::makeTexelView(device(), objects_);
        gpu::writeTexels(device(), *frameSet, 4, *table);
        gpu::writeUniform(device(), *frameSet, 1, lights.handle());
        const gpu::Image seen(
            device(), {.format = vk::Format::eR32G32B32A32Uint, .usage = vk::ImageUsageFlagBits::eStorage},
            "seen");
        gpu::writeStorage(device(), *seenSet, 0, seen.view());
        const gpu::Pipeline pipeline =
            gpu::makeComputePipeline(device(), shader, {*frameLayout, *seenLayout}, sizeof(shared::PlanPush));
        device().runOnce([&](vk::CommandBuffer commands) {
            gpu::imageBarrier(commands, seen.handle(), seen.aspect(), gpu::Use::undefined,
                              gpu::Use::computeRead);
            commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline.handle);
            commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *pipeline.layout, 0,
                                        {*frameSet, *seenSet}, nullptr);
            pushConstants(commands, pipeline, push_);
            dispatchList(commands, invocations);
            gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::hostRead);
        });
    }

    // feedback.comp over `samples` that all see object 0, as long as wide.
    void countSamples(uint32_t samples, const gpu::Buffer& needs, const gpu::Buffer& total)
    {
        using Type = vk::DescriptorType;
        const auto frameLayout = makeFrameLayout();
        const auto seenLayout = gpu::makeSetLayout(device(), {Type::eStorageImage});
        const auto frameSet = gpu::makeSet(device(), frameLayout),
                   seenSet = gpu::makeSet(device(), seenLayout);
        for (uint32_t binding = 0; binding < 4; ++binding)
            gpu::writeUniform(device(), *frameSet, binding, view_.handle());
        const vk::raii::BufferView table = gpu::makeTexelView(device(), objects_);
        gpu::writeTexels(device(), *frameSet, 4, *table);
        using Usage = vk::ImageUsageFlagBits;
        const gpu::Image seen(device(),
                              {.format = vk::Format::eR32G32B32A32Uint,
                               .width = samples,
                               .usage = Usage::eStorage | Usage::eTransferDst},
                              "seen");
        gpu::writeStorage(device(), *seenSet, 0, seen.view());
        const gpu::Pipeline pipeline = gpu::makeComputePipeline(
            device(), "feedback.comp", {*frameLayout, *seenLayout}, sizeof(shared::FeedbackPush));
        const shared::FeedbackPush push{.objects = needs.address(),
                                        .total = total.address(),
                                        .jitter = {},
                                        .divisor = 1.0f,
                                        .object = 0,
                                        .size = {samples, 1}};
        // Object, UV, and half floats of 1/64: two of 128 lumels per pixel, along x and along y.
        const vk::ClearColorValue sample(std::array<uint32_t, 4>{1u, 0u, 0x2400u, 0x24000000u});
        device().runOnce([&](vk::CommandBuffer commands) {
            gpu::imageBarrier(commands, seen.handle(), seen.aspect(), gpu::Use::undefined,
                              gpu::Use::transferWrite);
            commands.clearColorImage(seen.handle(), vk::ImageLayout::eTransferDstOptimal, sample,
                                     vk::ImageSubresourceRange{seen.aspect(), 0, 1, 0, 1});
            gpu::imageBarrier(commands, seen.handle(), seen.aspect(), gpu::Use::transferWrite,
                              gpu::Use::computeRead);
            commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline.handle);
            commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *pipeline.layout, 0,
                                        {*frameSet, *seenSet}, nullptr);
            pushConstants(commands, pipeline, push);
            dispatchList(commands, samples);
            gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::hostRead);
        });
    }

    const shared::Plan& plan() const { return *plan_.mapped<shared::Plan>(); }
    const shared::Job& job(size_t i) const { return jobs_.mapped<shared::Job>()[i]; }

    uint32_t objectCount_ = 0, tilesAnObject_ = 0;
    gpu::Buffer texels_, states_, objects_, view_, plan_, marks_, jobs_, tiles_;
    shared::PlanPush push_{};
};

TEST_F(PlanShaders, MarksKeepToTheirList)
{
    makeObjects(10);
    makeLists(16, {});
    run("mark.comp", objectCount_); // four tail tiles of each
    EXPECT_EQ(plan().dropped, 24u);
    const auto* marks = marks_.mapped<shared::Mark>();
    for (uint32_t i = 0; i < 16; ++i)
        EXPECT_LT(marks[i].tile.object, objectCount_);
    for (uint32_t i = 16; i < 80; ++i)
        EXPECT_EQ(marks[i].tile.object, kGuard) << i;
    // What is not in the list does not count as marked.
    uint32_t marked = 0;
    for (uint32_t object = 0; object < objectCount_; ++object)
        for (uint32_t mip = 4; mip < kMips; ++mip)
            marked += (state(object, mip).needed & shared::kAllQuads) != 0 ? 1 : 0;
    EXPECT_EQ(marked, 16u);
    run("budget.comp", 1);
    EXPECT_EQ(plan().marked, 16u);
}

// A tile enters the list once a marking; what former ones have left in it does not count.
TEST_F(PlanShaders, EachMarkingBeginsAnew)
{
    makeObjects(1);
    makeLists(16, {});
    const uint32_t before[4] = {kMarking - 1, kMarking - 2, kMarking, 0}; // of the four tail tiles
    for (uint32_t i = 0; i < 4; ++i)
        state(0, 4 + i).needed = before[i] << 16 | (before[i] != 0 ? 0x0fffu : 0u);
    run("mark.comp", objectCount_);
    EXPECT_EQ(plan().marked, 3u);
    for (uint32_t i = 0; i < 4; ++i)
        EXPECT_EQ(state(0, 4 + i).needed, kMarking << 16 | shared::kAllQuads) << i;
    for (uint32_t i = 0; i < 3; ++i) {
        const uint32_t place = marks_.mapped<shared::Mark>()[i].tile.place, mip = place >> 24 & 0xfu;
        EXPECT_NE(mip, 6u);
        EXPECT_EQ((place & shared::kPlaceWaited) != 0, mip == 4) << mip;
    }
}

TEST_F(PlanShaders, JobsKeepToTheirLists)
{
    makeObjects(1);
    makeLists(8, {3, 0});
    for (uint32_t i = 0; i < 8; ++i)
        marks_.mapped<shared::Mark>()[i] = {
            .tile = {.object = 0, .place = i}, .verdict = shared::kPriorityAlways, .quads = 0x11u};
    plan_.mapped<shared::Plan>()->marked = 8;
    run("select.comp", 8);
    EXPECT_EQ(plan().chosen, 8u);
    EXPECT_EQ(plan().chosenGroups[0], 1u);
    run("enlist.comp", 8);
    EXPECT_EQ(plan().dropped, 5u);
    EXPECT_EQ(plan().tilesLit, 3u);
    EXPECT_EQ(plan().quadsLit, 3u * 2u);
    EXPECT_EQ(plan().quadsPending, 5u * 2u);
    EXPECT_EQ(job(0).groups[0], 3u);
    for (uint32_t i = 3; i < 67; ++i)
        EXPECT_EQ(tiles_.mapped<shared::JobTile>()[i].tile.object, kGuard) << i;
    // Tiles beyond the capacity are still to be lit.
    uint32_t lit = 0, held = 0;
    for (uint32_t i = 0; i < 8; ++i) {
        lit += state(0, 0, i).lit == kFrame ? 1 : 0;
        held += state(0, 0, i).held == 0x11u ? 1 : 0;
    }
    EXPECT_EQ(lit, 3u);
    EXPECT_EQ(held, 3u);
}

// A quad is derived where the view needs all 2 x 2 quads under it, whatever tiles these lie in, and lit
// elsewhere.
TEST_F(PlanShaders, QuadsAreDerivedWhereTheViewNeedsTheirChildren)
{
    constexpr uint32_t kMip = 1;
    makeObjects(1);
    makeLists(1, {8, 8, 0, 0, 0, 0});
    // Tile (0, 0) of MIP 1 lies over tiles (0, 0) to (1, 1) of MIP 0.
    const uint32_t under[4] = {0x0133u, 0xffffu, 0x0f0fu, 0xc8ecu};
    uint32_t expected = 0;
    for (uint32_t quad = 0; quad < 16; ++quad) {
        bool all = true;
        for (uint32_t i = 0; i < 4; ++i) {
            const uint32_t x = 2 * (quad % 4) + i % 2, y = 2 * (quad / 4) + i / 2; // of 8 x 8 quads
            all = all && (under[y / 4 * 2 + x / 4] >> (y % 4 * 4 + x % 4) & 1u) != 0;
        }
        expected |= all ? 1u << quad : 0u;
    }
    for (uint32_t i = 0; i < 4; ++i)
        state(0, 0, i / 2 * 16 + i % 2).needed = kMarking << 16 | under[i];
    state(0, kMip).needed = kMarking << 16 | 0xfff7u;
    marks_.mapped<shared::Mark>()[0] = {.tile = {.object = 0, .place = kMip << 24}, .verdict = 0, .quads = 0};
    plan_.mapped<shared::Plan>()->marked = 1;
    run("classify.comp", 1);
    const shared::Mark& mark = marks_.mapped<shared::Mark>()[0];
    EXPECT_EQ(mark.quads, 0xfff7u & ~expected);
    EXPECT_LT(mark.verdict, shared::kPriorities);
    ASSERT_EQ(job(1).count, 1u);
    EXPECT_EQ(tiles_.mapped<shared::JobTile>()[job(1).first].quads, 0xfff7u & expected);
    EXPECT_EQ(plan().quadsMarked, 15u);
}

// What a tile holds already is not lit again because more of it is needed.
TEST_F(PlanShaders, OnlyQuadsWithoutLightAreAdded)
{
    makeObjects(1);
    makeLists(1, {8, 8, 0, 0, 0, 0});
    shared::TileState& tile = state(0, 0);
    tile.needed = kMarking << 16 | 0x00ffu;
    tile.held = 0x000fu | 0x0010u << 16; // lit, and derived
    tile.lit = tile.derived = kFrame - 1;
    marks_.mapped<shared::Mark>()[0] = {.tile = {.object = 0, .place = 0}, .verdict = 0, .quads = 0};
    plan_.mapped<shared::Plan>()->marked = 1;
    run("classify.comp", 1);
    EXPECT_EQ(marks_.mapped<shared::Mark>()[0].quads, 0x00e0u | shared::kMarkMore);
    run("select.comp", 1);
    run("enlist.comp", 1);
    EXPECT_EQ(plan().quadsLit, 3u);
    EXPECT_EQ(tile.held, 0x00efu | 0x0010u << 16);
    EXPECT_EQ(tile.lit, kFrame - 1);
    EXPECT_EQ(tile.needed, kMarking << 16 | 0x00ffu);
    EXPECT_NE(marks_.mapped<shared::Mark>()[0].tile.place & shared::kPlaceWaited, 0u);
    EXPECT_EQ(tiles_.mapped<shared::JobTile>()[job(0).first].quads, 0x00e0u);
}

// At 7680 x 4320, 33 million samples in 1/256 are more than 32 bits hold.
TEST_F(PlanShaders, SumsOfManySamplesCarry)
{
    makeObjects(1);
    objects_.mapped<shared::Object>()->flags = shared::kObjectLightable;
    view_.mapped<shared::View>()->anisotropy = 1.0f;
    const gpu::Buffer needs = list<shared::ObjectFeedback>(1), total = list<shared::FeedbackTotal>(1);
    auto& sums = *total.mapped<shared::FeedbackTotal>();
    std::fill_n(sums.elongations, shared::kElongations, ~0u);
    countSamples(640, needs, total);
    EXPECT_EQ(needs.mapped<shared::ObjectFeedback>()->samples, 640u);
    EXPECT_EQ(sums.elongations[0], 640u * shared::kFeedbackScale - 1u);
    EXPECT_EQ(sums.carries[0], 1u);
    EXPECT_EQ(sums.carries[1], 0u);
}

} // namespace
