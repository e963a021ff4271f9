// The plan's shaders on their own, over lists too short and tiles that several invocations change at a time.
#include "gpu/barrier.h"
#include "gpu/pipeline.h"
#include "gpu/resource.h"
#include "test_scene.h"

using namespace lumel;
using namespace lumel::test;

namespace {

constexpr uint32_t kFrame = 20;
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
            texels += lumels * lumels;
            tiles += across * across;
        }
        tilesAnObject_ = tiles;
        texels_ = list<uint32_t>(texels);                       // no surface: no vertices are read
        texels_.mapped<uint32_t>()[object.texelOffsets[7]] = 1; // but on tiles of MIP 4, says the gutter
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
        marks_ = list<shared::Mark>(marks + 64);
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
                 .reach = 2.0f,
                 .objectCount = objectCount_,
                 .budgetTiles = ~0u,
                 .refreshShare = 1.0f,
                 .tolerance = 0.0f,
                 .markCapacity = marks};
    }

    void run(const std::string& shader, uint32_t invocations)
    {
        using Type = vk::DescriptorType;
        const auto frameLayout = gpu::makeSetLayout(device(), {Type::eUniformBuffer, Type::eUniformBuffer});
        const auto seenLayout = gpu::makeSetLayout(device(), {Type::eStorageImage});
        const auto frameSet = gpu::makeSet(device(), frameLayout),
                   seenSet = gpu::makeSet(device(), seenLayout);
        const gpu::Buffer lights = list<shared::Light>(shared::kMaxLights);
        gpu::writeUniform(device(), *frameSet, 0, view_.handle());
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
        const auto frameLayout = gpu::makeSetLayout(device(), {Type::eUniformBuffer});
        const auto seenLayout = gpu::makeSetLayout(device(), {Type::eStorageImage});
        const auto frameSet = gpu::makeSet(device(), frameLayout),
                   seenSet = gpu::makeSet(device(), seenLayout);
        gpu::writeUniform(device(), *frameSet, 0, view_.handle());
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

} // namespace

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
            marked += state(object, mip).marked == kFrame ? 1 : 0;
    EXPECT_EQ(marked, 16u);
    run("budget.comp", 1);
    EXPECT_EQ(plan().marked, 16u);
}

TEST_F(PlanShaders, JobsKeepToTheirLists)
{
    makeObjects(1);
    makeLists(8, {3, 0});
    for (uint32_t i = 0; i < 8; ++i)
        marks_.mapped<shared::Mark>()[i] = {.tile = {.object = 0, .place = i},
                                            .verdict = shared::kPriorityAlways};
    plan_.mapped<shared::Plan>()->marked = 8;
    run("select.comp", 8);
    EXPECT_EQ(plan().dropped, 5u);
    EXPECT_EQ(plan().tilesLit, 3u);
    EXPECT_EQ(plan().lumelsPending, 5u * 64u);
    EXPECT_EQ(job(0).groups[0], 3u);
    for (uint32_t i = 3; i < 67; ++i)
        EXPECT_EQ(tiles_.mapped<shared::JobTile>()[i].tile.object, kGuard) << i;
    // Tiles beyond the capacity are still to be lit.
    uint32_t lit = 0;
    for (uint32_t i = 0; i < 8; ++i)
        lit += state(0, 0, i).lit == kFrame ? 1 : 0;
    EXPECT_EQ(lit, 3u);
}

// The first tile of each tail is lit while two others queue the tail on it.
TEST_F(PlanShaders, ATailIsQueuedOnceWhileItsFirstTileIsLit)
{
    constexpr uint32_t kObjects = 64, kTail = 4;
    makeObjects(kObjects);
    makeLists(3 * kObjects, {kObjects, 0, 0, 0, kObjects});
    for (uint32_t i = 0; i < kObjects; ++i) {
        state(i, kTail).lit = kFrame - 1;
        for (uint32_t mip = kTail + 1; mip < kTail + 3; ++mip)
            state(i, mip).derive = kFrame << shared::kDeriveBits | shared::kDeriveFromChildren;
        state(i, kTail + 1).lit = 5;
        auto* marks = marks_.mapped<shared::Mark>();
        for (uint32_t k = 0; k < 3; ++k)
            marks[k * kObjects + i] = {.tile = {.object = i, .place = (kTail + k) << 24},
                                       .verdict = k == 0 ? shared::kPriorityChanged : shared::kVerdictDerive};
    }
    plan_.mapped<shared::Plan>()->marked = 3 * kObjects;
    run("select.comp", 3 * kObjects);
    EXPECT_EQ(plan().tilesLit, kObjects);
    EXPECT_EQ(plan().dropped, 0u);
    EXPECT_EQ(job(4).count, kObjects);
    for (uint32_t i = 0; i < kObjects; ++i) {
        EXPECT_EQ(state(i, kTail).lit, kFrame);
        EXPECT_TRUE(state(i, kTail).derive & shared::kDeriveTail) << i;
    }
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
