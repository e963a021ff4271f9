// Device memory: ranges of blocks, the choice of memory types, and what the driver is asked for.
#include "core/error.h"
#include "gpu/memory.h"
#include "gpu/resource.h"
#include "test_scene.h"
#include <random>
#include <thread>

using namespace lumel;
using namespace lumel::test;

namespace {

using Property = vk::MemoryPropertyFlagBits;
using Usage = gpu::MemoryUsage;

TEST(FreeRanges, NeighboursMergeWhateverTheOrderTheyAreFreedIn)
{
    std::vector<size_t> order = {0, 1, 2, 3};
    do {
        gpu::FreeRanges ranges(400);
        for (size_t i = 0; i < 4; ++i)
            ASSERT_EQ(ranges.take(100, 1), i * 100);
        EXPECT_EQ(ranges.count(), 0u);
        EXPECT_FALSE(ranges.take(1, 1));
        for (const size_t i : order)
            ranges.give(i * 100, 100);
        EXPECT_TRUE(ranges.allFree());
        EXPECT_EQ(ranges.count(), 1u);
    } while (std::ranges::next_permutation(order).found);
}

TEST(FreeRanges, AlignmentLeavesTheRangeBeforeItFree)
{
    gpu::FreeRanges ranges(1000);
    EXPECT_EQ(ranges.take(10, 1), 0u);
    EXPECT_EQ(ranges.take(100, 256), 256u);
    EXPECT_EQ(ranges.take(200, 2), 10u); // before it
    EXPECT_FALSE(ranges.take(1000, 1));
    EXPECT_FALSE(ranges.take(500, 512)) << "488 are left at 512";
    EXPECT_EQ(ranges.take(488, 512), 512u);
}

TEST(FreeRanges, TheSmallestThatFitsIsTaken)
{
    gpu::FreeRanges ranges(1000);
    EXPECT_EQ(ranges.take(300, 1), 0u);
    EXPECT_EQ(ranges.take(10, 1), 300u);
    EXPECT_EQ(ranges.take(50, 1), 310u);
    EXPECT_EQ(ranges.take(10, 1), 360u);
    ranges.give(0, 300);
    ranges.give(310, 50);
    EXPECT_EQ(ranges.take(40, 1), 310u);
}

TEST(FreeRanges, RangesInUseNeverOverlapAndAllComesBack)
{
    struct Range {
        uint64_t offset, size;
    };
    std::mt19937 random(7);
    gpu::FreeRanges ranges(1 << 16);
    std::vector<Range> used;
    for (int step = 0; step < 20000; ++step) {
        if (!used.empty() && random() % 2) {
            std::swap(used[random() % used.size()], used.back());
            ranges.give(used.back().offset, used.back().size);
            used.pop_back();
            continue;
        }
        const uint64_t size = 1 + random() % 3000, alignment = 1u << random() % 10;
        const auto offset = ranges.take(size, alignment);
        if (!offset)
            continue;
        ASSERT_EQ(*offset % alignment, 0u);
        ASSERT_LE(*offset + size, ranges.size());
        for (const Range& r : used)
            ASSERT_TRUE(*offset + size <= r.offset || r.offset + r.size <= *offset);
        used.push_back({*offset, size});
    }
    for (const Range& r : used)
        ranges.give(r.offset, r.size);
    EXPECT_TRUE(ranges.allFree());
    EXPECT_EQ(ranges.count(), 1u);
}

vk::PhysicalDeviceMemoryProperties memoryOf(const std::vector<vk::MemoryPropertyFlags>& types)
{
    vk::PhysicalDeviceMemoryProperties memory;
    memory.memoryHeapCount = 1;
    memory.memoryHeaps[0].size = uint64_t(8) << 30;
    for (const vk::MemoryPropertyFlags flags : types)
        memory.memoryTypes[memory.memoryTypeCount++].propertyFlags = flags;
    return memory;
}

constexpr auto kUncached = Property::eHostVisible | Property::eHostCoherent;

std::vector<uint32_t> typesFor(const vk::PhysicalDeviceMemoryProperties& memory, Usage usage)
{
    return gpu::memoryTypesFor(memory, ~0u, usage);
}

TEST(MemoryTypes, OfADiscreteDevice)
{
    const auto memory = memoryOf({{},
                                  Property::eDeviceLocal,
                                  kUncached,
                                  kUncached | Property::eHostCached,
                                  kUncached | Property::eDeviceLocal});
    using List = std::vector<uint32_t>;
    EXPECT_EQ(typesFor(memory, Usage::device), (List{1, 4}));
    EXPECT_EQ(typesFor(memory, Usage::host), (List{4, 2, 3})) << "what the GPU reads each frame is near it";
    EXPECT_EQ(typesFor(memory, Usage::staging), (List{2, 3, 4}));
    EXPECT_EQ(typesFor(memory, Usage::readback), (List{3, 2, 4})) << "cached";
    EXPECT_EQ(gpu::memoryTypesFor(memory, 1u << 2, Usage::host), List{2});
    EXPECT_EQ(gpu::memoryTypesFor(memory, 1u << 0, Usage::host), List{});
}

TEST(MemoryTypes, OfADeviceThatSharesTheHostsMemory)
{
    const auto all = kUncached | Property::eHostCached | Property::eDeviceLocal;
    const auto memory = memoryOf({all});
    for (const Usage usage : {Usage::device, Usage::host, Usage::staging, Usage::readback})
        EXPECT_EQ(typesFor(memory, usage), std::vector<uint32_t>{0});
}

TEST(MemoryTypes, CachedMemoryNeedNotBeCoherentAndVendorsTypesAreLeftAlone)
{
    const auto memory = memoryOf({Property::eDeviceLocal | Property::eLazilyAllocated,
                                  Property::eDeviceLocal | Property::eProtected,
                                  kUncached | Property::eDeviceLocal | Property::eDeviceCoherentAMD,
                                  kUncached | Property::eDeviceLocal,
                                  Property::eHostVisible | Property::eHostCached | Property::eDeviceLocal});
    EXPECT_EQ(typesFor(memory, Usage::device), (std::vector<uint32_t>{3, 4}));
    EXPECT_EQ(typesFor(memory, Usage::host), std::vector<uint32_t>{3});
    EXPECT_EQ(typesFor(memory, Usage::readback), (std::vector<uint32_t>{4, 3}));
}

class MemoryTest : public GpuTest {
protected:
    gpu::Allocator makeAllocator() { return {device().handle(), memory_, limits_}; }
    static gpu::MemoryRequest request(uint64_t size, Usage usage = Usage::device, uint64_t alignment = 16)
    {
        gpu::MemoryRequest r;
        r.requirements = vk::MemoryRequirements{.size = size, .alignment = alignment, .memoryTypeBits = ~0u};
        r.usage = usage;
        r.remedy = "use less";
        return r;
    }

    vk::PhysicalDeviceMemoryProperties memory_ = device().physical().getMemoryProperties();
    gpu::Limits limits_ = device().limits();
};

gpu::Image smallTexture()
{
    using Usage = vk::ImageUsageFlagBits;
    return {device(), {.width = 16, .height = 16, .usage = Usage::eSampled | Usage::eTransferDst}, "small"};
}

TEST_F(MemoryTest, TenThousandTexturesTakeFewAllocationsAndGiveThemBack)
{
    const gpu::MemoryReport before = device().memory().report();
    {
        std::vector<gpu::Image> textures;
        for (int i = 0; i < 10000; ++i)
            textures.push_back(smallTexture());
        const gpu::MemoryReport all = device().memory().report();
        EXPECT_LT(all.allocations - before.allocations, 100u);
        EXPECT_LT(all.allocatedBytes - before.allocatedBytes,
                  2 * (all.usedBytes() - before.usedBytes()) + (8 << 20));
        // Holes are filled before new blocks are asked for.
        for (size_t i = 0; i < textures.size(); i += 2)
            textures[i] = {};
        for (size_t i = 0; i < textures.size(); i += 2)
            textures[i] = smallTexture();
        EXPECT_EQ(device().memory().report().allocatedBytes, all.allocatedBytes);
    }
    const gpu::MemoryReport after = device().memory().report();
    EXPECT_EQ(after.usedBytes(), before.usedBytes());
    EXPECT_LE(after.allocations, before.allocations + 1) << "a small block may be kept";
}

TEST_F(MemoryTest, LargeResourcesHaveAllocationsOfTheirOwn)
{
    gpu::Allocator allocator = makeAllocator();
    const gpu::Memory small = allocator.allocate(request(1000));
    const uint64_t block = allocator.report().allocatedBytes;
    gpu::Memory large = allocator.allocate(request(gpu::Allocator::kOwnBytes));
    EXPECT_NE(large.handle(), small.handle());
    EXPECT_EQ(large.offset(), 0u);
    EXPECT_EQ(allocator.report().allocatedBytes, block + gpu::Allocator::kOwnBytes);
    large = {};
    EXPECT_EQ(allocator.report().allocatedBytes, block);
    EXPECT_EQ(allocator.report().usedBytes(), 1000u);
}

// What bufferImageGranularity asks for.
TEST_F(MemoryTest, BuffersAndImagesShareNoBlock)
{
    gpu::Allocator allocator = makeAllocator();
    const gpu::Memory buffer = allocator.allocate(request(1000));
    const gpu::Image texture = smallTexture();
    gpu::MemoryRequest ofImage = request(1000);
    ofImage.image = texture.handle();
    const gpu::Memory image = allocator.allocate(ofImage);
    EXPECT_NE(buffer.handle(), image.handle());
    EXPECT_EQ(buffer.handle(), allocator.allocate(request(1000)).handle());
}

TEST_F(MemoryTest, RangesThatAreNotCoherentKeepToWholeAtoms)
{
    for (uint32_t i = 0; i < memory_.memoryTypeCount; ++i)
        memory_.memoryTypes[i].propertyFlags &= ~vk::MemoryPropertyFlags(Property::eHostCoherent);
    limits_.core.nonCoherentAtomSize = 512;
    gpu::Allocator allocator = makeAllocator();
    const gpu::Memory first = allocator.allocate(request(10, Usage::readback));
    const gpu::Memory second = allocator.allocate(request(513, Usage::readback));
    const gpu::Memory third = allocator.allocate(request(10, Usage::readback));
    EXPECT_EQ(second.offset() - first.offset(), 512u);
    EXPECT_EQ(third.offset() - second.offset(), 1024u);
    EXPECT_FALSE(first.coherent());
    first.invalidate();
    second.invalidate();
}

TEST_F(MemoryTest, AlignmentsAreKept)
{
    gpu::Allocator allocator = makeAllocator();
    std::vector<gpu::Memory> held;
    for (const uint64_t alignment : {1u, 16u, 4096u, 64u, 65536u, 256u}) {
        held.push_back(allocator.allocate(request(100, Usage::device, alignment)));
        EXPECT_EQ(held.back().offset() % std::max<uint64_t>(alignment, 64), 0u);
    }
    EXPECT_EQ(allocator.report().allocations, 1u);
}

// Blocks that exist go on serving when the device allows no more of them.
TEST_F(MemoryTest, ExhaustionIsAnErrorWithARemedy)
{
    limits_.core.maxMemoryAllocationCount = 1;
    gpu::Allocator allocator = makeAllocator();
    std::vector<gpu::Memory> held;
    const auto fill = [&] {
        for (;;)
            held.push_back(allocator.allocate(request(1 << 20)));
    };
    EXPECT_THROW(fill(), Error);
    ASSERT_GE(held.size(), 4u);
    const size_t most = held.size();
    held.pop_back();
    EXPECT_THROW(fill(), Error);
    EXPECT_EQ(held.size(), most);

    limits_.maxMemoryAllocationSize = 1 << 20;
    gpu::Allocator tight = makeAllocator();
    try {
        tight.allocate(request(64 << 20));
        FAIL();
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("use less"), std::string::npos) << e.what();
    }
}

TEST_F(MemoryTest, ThreadsShareIt)
{
    gpu::Allocator allocator = makeAllocator();
    const auto work = [&](unsigned seed) {
        std::mt19937 random(seed);
        std::vector<gpu::Memory> held(50);
        for (int i = 0; i < 5000; ++i) {
            gpu::Memory& memory = held[random() % held.size()];
            memory = {};
            memory = allocator.allocate(request(1 + random() % 100000, Usage::host));
            *memory.mapped() = std::byte(seed);
        }
    };
    std::vector<std::jthread> threads;
    for (unsigned i = 0; i < 4; ++i)
        threads.emplace_back(work, i);
    threads.clear();
    EXPECT_EQ(allocator.report().usedBytes(), 0u);
    EXPECT_LE(allocator.report().allocations, 1u);
}

} // namespace
