// What a frame did and what it cost; `--stats` and `bench --json` write it in one schema
// (app/bench/README.md).
#pragma once
#include "gpu/host_work.h"
#include "gpu/memory_report.h"
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace lumel {

struct FrameStats {
    double ms = 0.0;                      // wall time, CPU and GPU together
    std::map<std::string, double> passMs; // GPU time by pass
    size_t lumelsMarked = 0, lumelsLit = 0, lumelsDerived = 0, lumelsKept = 0;
    size_t lumelsPending = 0; // left for later frames
    size_t tilesMarked = 0, tilesLit = 0;
    size_t pixelsCovered = 0; // by objects in texture space, from the feedback pass: a multiple of 16
    size_t poolUsedBytes = 0, poolCapBytes = 0, poolTextures = 0;
    size_t surfaceBytes = 0;  // of the surface cache, which shares the cap
    gpu::MemoryReport memory; // of the device: of all that it renders
    gpu::HostWork hostWork;   // between the frame's begin and end
    size_t objectsTsl = 0, objectsForward = 0, objectsCulled = 0;
    float levelBias = 0.0f, levelOffset = 0.0f, anisotropy = 1.0f;
    // RMSE in display values, where measured: of the picture against the reference's; of its difference to
    // the frame before against the reference's; and of that difference of the reference alone.
    std::optional<double> errorRmse, flickerRmse, changeRmse;
    float exposure = 1.0f;
    float renderScale = 1.0f, budgetBias = 0.0f; // budgetBias: levels given up for the frame budget
    size_t lumelBudget = ~0u;                    // lumels that the frame might light
};

// One object in a frame.
struct ObjectStats {
    std::string name;
    std::string mode;           // tsl, forward or culled
    std::optional<float> level; // the finest of its lumel grid that the view needs; nothing: no sample saw it
    size_t pixels = 0;          // that it covers, from the feedback pass: a multiple of 16
};

// What a run was: the head of the JSON.
struct RunInfo {
    std::string version, device, driver, scene, shading, filter;
    unsigned width = 0, height = 0;
    double budgetMs = 0.0;                      // 0 = none
    std::map<std::string, std::string> options; // what else the picture depends on
};

// objects: of the last frame, empty where they were not asked for.
nlohmann::json statsJson(const RunInfo& run, const std::vector<FrameStats>& frames,
                         const std::vector<ObjectStats>& objects = {},
                         const std::map<uint32_t, size_t>& lumelsByTileSize = {});

} // namespace lumel
