#include "stats.h"
#include "core/pass_names.h"
#include "core/statistics.h"
#include <cmath>
#include <nlohmann/json.hpp>

namespace lumel {
namespace {

using nlohmann::json;

json orNull(std::optional<double> value)
{
    return value ? json(*value) : json(nullptr);
}

json memoryJson(const gpu::MemoryReport& memory)
{
    json result{{"allocated_bytes", memory.allocatedBytes}, {"allocations", memory.allocations}};
    for (size_t i = 0; i < memory.bytes.size(); ++i)
        result[gpu::kMemoryKindNames[i]] = memory.bytes[i];
    return result;
}

json frameJson(const FrameStats& f)
{
    json passes;
    for (const char* name : kPassNames) {
        const auto ms = f.passMs.find(name);
        passes[name] = ms == f.passMs.end() ? 0.0 : ms->second;
    }
    return {{"ms", f.ms},
            {"passes", passes},
            {"lumels",
             {{"marked", f.lumelsMarked},
              {"lit", f.lumelsLit},
              {"derived", f.lumelsDerived},
              {"kept", f.lumelsKept},
              {"pending", f.lumelsPending}}},
            {"pixels_covered", f.pixelsCovered},
            {"tiles", {{"marked", f.tilesMarked}, {"lit", f.tilesLit}}},
            {"pool",
             {{"used_bytes", f.poolUsedBytes},
              {"surface_bytes", f.surfaceBytes},
              {"cap_bytes", f.poolCapBytes},
              {"textures", f.poolTextures}}},
            {"memory", memoryJson(f.memory)},
            {"host_waits", f.hostWork.waits},
            {"ring_waits", f.hostWork.ringWaits},
            {"uploaded_bytes", f.hostWork.uploadedBytes},
            {"pipelines_created", f.hostWork.pipelinesCreated},
            {"objects", {{"tsl", f.objectsTsl}, {"forward", f.objectsForward}, {"culled", f.objectsCulled}}},
            {"exposure", f.exposure},
            {"render_scale", f.renderScale},
            {"lumel_budget", f.lumelBudget == ~0u ? json(nullptr) : json(f.lumelBudget)},
            {"budget_bias", f.budgetBias},
            {"level_bias", f.levelBias},
            {"level_offset", f.levelOffset},
            {"anisotropy", f.anisotropy},
            {"error_rmse", orNull(f.errorRmse)},
            {"flicker_rmse", orNull(f.flickerRmse)},
            {"change_rmse", orNull(f.changeRmse)}};
}

// Root mean square over the frames that have the value.
std::optional<double> overFrames(const std::vector<FrameStats>& frames,
                                 std::optional<double> FrameStats::*value)
{
    double sum = 0.0;
    size_t count = 0;
    for (const FrameStats& f : frames)
        if (const auto& v = f.*value) {
            sum += *v * *v;
            ++count;
        }
    return count > 0 ? std::optional(std::sqrt(sum / double(count))) : std::nullopt;
}

} // namespace

json statsJson(const RunInfo& run, const std::vector<FrameStats>& frames,
               const std::vector<ObjectStats>& objects, const std::map<uint32_t, size_t>& lumelsByTileSize)
{
    json list = json::array();
    std::vector<double> times;
    double sum = 0.0;
    size_t missed = 0;
    for (const FrameStats& f : frames) {
        list.push_back(frameJson(f));
        times.push_back(f.ms);
        sum += f.ms;
        missed += run.budgetMs > 0.0 && f.ms > run.budgetMs ? 1 : 0;
    }
    json summary = json::object();
    if (!times.empty())
        summary = {{"mean_ms", sum / double(times.size())},
                   {"p50_ms", percentile(times, 0.50)},
                   {"p95_ms", percentile(times, 0.95)},
                   {"p99_ms", percentile(times, 0.99)},
                   {"max_ms", percentile(times, 1.0)},
                   {"error_rmse", orNull(overFrames(frames, &FrameStats::errorRmse))},
                   {"flicker_rmse", orNull(overFrames(frames, &FrameStats::flickerRmse))},
                   {"change_rmse", orNull(overFrames(frames, &FrameStats::changeRmse))},
                   {"missed", missed}}; // frames over the budget
    json table = json::array();
    for (const ObjectStats& o : objects)
        table.push_back({{"name", o.name},
                         {"mode", o.mode},
                         {"level", o.level ? json(*o.level) : json(nullptr)},
                         {"pixels", o.pixels}});
    json tileSizes = json::object();
    for (const auto& [side, lumels] : lumelsByTileSize)
        tileSizes[std::to_string(side)] = lumels;
    return {{"schema", 1},
            {"version", run.version},
            {"options", run.options},
            {"device", run.device},
            {"driver", run.driver},
            {"size", {run.width, run.height}},
            {"scene", run.scene},
            {"shading", run.shading},
            {"filter", run.filter},
            {"frames", list},
            {"summary", summary},
            {"objects", table},
            {"lumels_by_tile_size", tileSizes}};
}

} // namespace lumel
