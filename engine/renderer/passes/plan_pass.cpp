#include "plan_pass.h"
#include <algorithm>
#include <set>

namespace lumel {
namespace {

// Makes the buffer at least this large; grows by half more, so that a steady view allocates nothing.
// What held less may be in use until the frames in flight have finished. True when its contents are lost.
bool reserve(Frame& frame, gpu::Buffer& buffer, size_t bytes, gpu::Buffer::MemoryUsage memoryUsage,
             const char* name)
{
    if (bytes <= buffer.size())
        return false;
    if (buffer)
        frame.ring.waitForAll();
    buffer = gpu::Buffer(frame.device, bytes + bytes / 2, memoryUsage, name);
    return true;
}

// Lumels around a point that the draw filter reads: the centres of the outermost lie half a lumel, one or
// one and a half from those around it.
float reachOf(DrawFilter filter)
{
    return filter == DrawFilter::bilinear ? 0.5f : filter == DrawFilter::quadratic ? 1.0f : 1.5f;
}

} // namespace

PlanPass::PlanPass(const gpu::Device& device, const SceneState& scene, const FeedbackPass& feedback)
    : mark_(gpu::makeComputePipeline(device, "mark.comp", {*scene.frameSet().layout(), *feedback.layout()},
                                     sizeof(shared::PlanPush))),
      classify_(gpu::makeComputePipeline(device, "classify.comp", {*scene.frameSet().layout()},
                                         sizeof(shared::PlanPush))),
      classifyWaiting_(gpu::makeComputePipeline(device, "classify.comp", {*scene.frameSet().layout()},
                                                sizeof(shared::PlanPush), shared::kFeatureWaiting)),
      budget_(gpu::makeComputePipeline(device, "budget.comp", {*scene.frameSet().layout()},
                                       sizeof(shared::PlanPush))),
      select_(gpu::makeComputePipeline(device, "select.comp", {*scene.frameSet().layout()},
                                       sizeof(shared::PlanPush))),
      bound_(gpu::makeComputePipeline(device, "bound.comp", {*scene.frameSet().layout()},
                                      sizeof(shared::PlanPush))),
      enlist_(gpu::makeComputePipeline(device, "enlist.comp", {*scene.frameSet().layout()},
                                       sizeof(shared::PlanPush))),
      surfaces_(device), plan_(device, sizeof(shared::Plan), gpu::Buffer::MemoryUsage::device, "plan")
{
    for (gpu::Buffer& readback : readbacks_)
        readback =
            gpu::Buffer(device, sizeof(shared::Plan), gpu::Buffer::MemoryUsage::readback, "plan readback");
}

uint32_t PlanPass::lightJobOf(const LightJob& job)
{
    const auto [entry, isNew] = lightJobIndex_.try_emplace(
        {job.surface, job.material, job.vertices, job.twoLobes, job.block}, uint32_t(lightJobs_.size()));
    if (isNew)
        lightJobs_.push_back(job);
    return entry->second;
}

uint32_t PlanPass::lowerJobOf(int block, uint32_t tail)
{
    const auto [entry, isNew] = lowerJobIndex_.try_emplace(block, uint32_t(lowerJobs_.size()));
    if (isNew)
        lowerJobs_.push_back({.block = block, .capacity = std::vector<uint32_t>(tail)});
    return entry->second;
}

void PlanPass::prepare(Frame& frame, const LitPool& pool)
{
    lightJobs_.clear();
    lowerJobs_.clear();
    lightJobIndex_.clear();
    lowerJobIndex_.clear();
    const auto& residency = frame.residency.objects();
    const auto& objects = frame.scene.objects();
    std::vector<ObjectJobs> jobs(residency.size());
    uint32_t tiles = 0;
    for (size_t i = 0; i < residency.size(); ++i) {
        if (!residency[i].texture)
            continue;
        const tsl::TextureLayout& layout = pool.block(residency[i].texture).layout;
        const int block = residency[i].texture.block;
        const GpuObject& object = objects[i];
        const bool two = (object.data.flags & shared::kObjectSecondLobe) != 0;
        jobs[i].light = lightJobOf({object.coloured ? Surface::coloured : Surface::found, object.material,
                                    object.vertexTexels, two, block});
        jobs[i].cached = lightJobOf({Surface::cachedAndShadows, nullptr, {}, two, block});
        const uint32_t shadowsUnknown = lightJobOf({Surface::cached, nullptr, {}, two, block}); // the next
        const uint32_t tail = shared::derivedTail(layout.mips);
        jobs[i].lower = lowerJobOf(block, tail);
        lightJobs_[jobs[i].light].capacity += layout.tiles;
        lightJobs_[jobs[i].cached].capacity += layout.tiles;
        lightJobs_[shadowsUnknown].capacity += layout.tiles;
        std::vector<uint32_t>& capacity = lowerJobs_[jobs[i].lower].capacity;
        for (uint32_t mip = 1; mip < tail; ++mip)
            capacity[mip - 1] += layout.tileOffsets[mip + 1] - layout.tileOffsets[mip];
        ++capacity[tail - 1]; // of the tail together
        tiles += layout.tiles;
    }

    std::vector<shared::Job> table;
    uint32_t first = 0;
    const auto addJob = [&](uint32_t capacity) {
        table.push_back({.groups = {0, 1, 1}, .count = 0, .capacity = capacity, .first = first});
        first += capacity;
    };
    for (const LightJob& job : lightJobs_)
        addJob(job.capacity);
    for (LowerJobs& block : lowerJobs_) {
        block.job = uint32_t(table.size());
        for (const uint32_t capacity : block.capacity)
            addJob(capacity);
    }
    for (size_t i = 0; i < residency.size(); ++i)
        if (residency[i].texture)
            jobs[i].lower = lowerJobs_[jobs[i].lower].job;
    jobCount_ = uint32_t(table.size());

    using MemoryUsage = gpu::Buffer::MemoryUsage;
    if (reserve(frame, marks_, 3 * tiles * sizeof(shared::Mark), MemoryUsage::device, "marks"))
        marked_ = {};
    reserve(frame, tiles_, first * sizeof(shared::JobTile), MemoryUsage::device, "tiles");
    reserve(frame, jobs_, table.size() * sizeof(shared::Job), MemoryUsage::device, "jobs");
    gpu::Buffer& upload = uploads_[frame.place];
    if (table.size() * sizeof(shared::Job) > upload.size()) // of no frame in flight
        upload = gpu::Buffer(frame.device, 2 * table.size() * sizeof(shared::Job), MemoryUsage::staging,
                             "jobs upload");
    upload.write<shared::Job>(table);
    writeObjects(frame, pool, jobs);
}

// The lit textures, and where their tiles are listed, into the object table.
void PlanPass::writeObjects(Frame& frame, const LitPool& pool, const std::vector<ObjectJobs>& jobs)
{
    auto* table = frame.scene.objectTable().mapped<shared::Object>(); // which is never read here
    toMark_.objects.assign(jobs.size(), {});
    for (size_t i = 0; i < jobs.size(); ++i) {
        const tsl::ObjectResidency& resident = frame.residency.objects()[i];
        if (!resident.texture)
            continue;
        const LitBlock& block = pool.block(resident.texture);
        shared::Object& object = table[i];
        object.mips = block.layout.mips;
        object.layer = resident.texture.layer;
        object.litLevel = resident.litLevel;
        object.finest = resident.finest;
        object.lightJob = jobs[i].light;
        object.cachedJob = jobs[i].cached;
        object.lowerJob = jobs[i].lower;
        std::copy(block.layout.tileOffsets.begin(), block.layout.tileOffsets.end(), object.tileOffsets);
        object.tiles = block.states.address() + block.stateOffset(resident.texture.layer);
        toMark_.objects[i] = {object.tiles, resident.litLevel, resident.finest};
    }
}

shared::LightPush PlanPass::push(uint32_t job) const
{
    return {.plan = plan_.address(),
            .jobs = jobs_.address(),
            .tiles = tiles_.address(),
            .surfaces = surfaces_.address(),
            .job = job,
            .surfaceCapacity = surfaces_.capacity()};
}

std::map<uint32_t, size_t> PlanPass::lumelsByTileSize(const gpu::Device& device,
                                                      const shared::Plan& plan) const
{
    const auto bytes = gpu::readBack(device, marks_, plan.marked * sizeof(shared::Mark));
    std::vector<shared::Mark> marks(bytes.size() / sizeof(shared::Mark));
    if (!marks.empty())
        std::memcpy(marks.data(), bytes.data(), bytes.size());
    std::map<uint32_t, size_t> lumels;
    for (uint32_t shift = 0; shift < 4; ++shift) {
        std::set<std::pair<uint32_t, uint32_t>> pieces; // object, place
        for (const shared::Mark& mark : marks) {
            if (mark.verdict == shared::kVerdictNone)
                continue;
            const uint32_t place = mark.tile.place & ~shared::kPlaceWaited;
            const uint32_t x = (place & 0xfffu) >> shift, y = (place >> 12u & 0xfffu) >> shift;
            pieces.insert({mark.tile.object, (place & 0xff000000u) | y << 12u | x});
        }
        lumels[shared::kTileSize << shift] = pieces.size() * shared::kTileLumels << (2 * shift);
    }
    return lumels;
}

// Whether the list of marks must be rebuilt; if so, it counts as rebuilt.
bool PlanPass::needsMarks(const Frame& frame, const FeedbackPass& feedback)
{
    toMark_.samples = feedback.frame();
    toMark_.detail = frame.detail;
    toMark_.reach = reachOf(frame.settings.filter);
    if (frame.late && toMark_ == marked_)
        return false;
    marked_ = toMark_;
    marking_ = marking_ % 0xffffu + 1;
    return true;
}

// Of all but what it keeps from frame to frame. marks: they are to be made.
void PlanPass::recordReset(vk::CommandBuffer commands, bool marks)
{
    const size_t first = marks ? 0 : offsetof(shared::Plan, chosen);
    constexpr size_t kKept = offsetof(shared::Plan, surfacesBefore);
    if (!std::exchange(planKnown_, true)) {
        commands.fillBuffer(plan_.handle(), 0, VK_WHOLE_SIZE, 0);
    } else {
        commands.copyBuffer(plan_.handle(), plan_.handle(),
                            vk::BufferCopy{offsetof(shared::Plan, surfacesTaken), kKept, sizeof(uint32_t)});
        gpu::memoryBarrier(commands, gpu::Use::transferRead, gpu::Use::transferWrite);
        commands.fillBuffer(plan_.handle(), first, kKept - first, 0);
    }
    gpu::memoryBarrier(commands, gpu::Use::transferWrite, gpu::Use::transferWrite);
}

void PlanPass::record(Frame& frame, const FeedbackPass& feedback)
{
    const PassScope scope(frame, "plan");
    const vk::CommandBuffer commands = frame.commands;
    const bool marks = needsMarks(frame, feedback);
    recordReset(commands, marks);
    commands.fillBuffer(plan_.handle(), offsetof(shared::Plan, groups) + 2 * sizeof(uint32_t),
                        sizeof(uint32_t), 1);
    for (const size_t groups : {offsetof(shared::Plan, chosenGroups), offsetof(shared::Plan, unboundGroups)})
        commands.fillBuffer(plan_.handle(), groups + sizeof(uint32_t), 2 * sizeof(uint32_t), 1);
    if (jobCount_ > 0)
        commands.copyBuffer(uploads_[frame.place].handle(), jobs_.handle(),
                            vk::BufferCopy{.size = jobCount_ * sizeof(shared::Job)});
    gpu::memoryBarrier(commands, gpu::Use::transferWrite, gpu::Use::indirectRead);

    const glm::uvec2 samples = feedback.samples();
    const Settings& settings = frame.settings;
    const auto objectCount = uint32_t(frame.scene.objects().size());
    const shared::PlanPush push{.plan = plan_.address(),
                                .marks = marks_.address(),
                                .jobs = jobs_.address(),
                                .tiles = tiles_.address(),
                                .samples = samples,
                                .divisor = float(feedback.divisor()),
                                .margin = feedback.margin(),
                                .reach = reachOf(settings.filter),
                                .objectCount = objectCount,
                                .budgetQuads = frame.lumelBudget / shared::kQuadLumels,
                                .refreshShare = settings.refreshShare,
                                .tolerance = settings.tolerance,
                                .markCapacity = uint32_t(marks_.size() / (3 * sizeof(shared::Mark))),
                                .marking = marking_,
                                .surfaces = surfaces_.next()};
    const auto bind = [&](const gpu::Pipeline& pipeline, std::initializer_list<vk::DescriptorSet> sets = {}) {
        bindSets(frame, vk::PipelineBindPoint::eCompute, pipeline, sets);
        pushConstants(commands, pipeline, push);
    };
    const auto wait = [&] { gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::indirectRead); };
    const auto run = [&](const gpu::Pipeline& pipeline, size_t groups) { // over a list, by its Plan's groups
        bind(pipeline);
        commands.dispatchIndirect(plan_.handle(), groups);
        wait();
    };
    const auto count = [&] {
        bind(budget_);
        commands.dispatch(1, 1, 1);
        wait();
    };
    if (marks) {
        bind(mark_, {feedback.set()});
        dispatchList(commands, std::max(samples.x * samples.y, objectCount));
        wait();
        count();
    }
    run(frame.lumelBudget < ~0u ? classifyWaiting_ : classify_, offsetof(shared::Plan, groups));
    count();
    run(select_, offsetof(shared::Plan, groups));
    run(bound_, offsetof(shared::Plan, unboundGroups));
    run(enlist_, offsetof(shared::Plan, chosenGroups));
}

void PlanPass::recordReadback(Frame& frame) const
{
    const vk::CommandBuffer commands = frame.commands;
    gpu::memoryBarrier(commands, gpu::Use::computeWrite, gpu::Use::transferRead);
    commands.copyBuffer(plan_.handle(), readbacks_[frame.place].handle(),
                        vk::BufferCopy{.size = sizeof(shared::Plan)});
    gpu::memoryBarrier(commands, gpu::Use::transferWrite, gpu::Use::hostRead);
}

} // namespace lumel
