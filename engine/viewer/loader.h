// Loads and bakes on a thread of its own, so that a window stays alive meanwhile.
#pragma once
#include "core/progress.h"
#include "scene/materials.h"
#include <functional>
#include <memory>
#include <thread>

namespace lumel::scene {

// A scene with its materials baked by one method.
struct LoadedScene {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const std::vector<BakedMaterial>> materials;
    MaterialOptions options;
};

class Loader {
public:
    // done: called on the loader's thread when there is something to take().
    explicit Loader(std::function<void()> done) : report_(std::move(done)) {}
    ~Loader() { cancel(); }

    // Begins; cancels a load in progress. Without `known` the file is loaded first. `finish` may change
    // the scene before its materials are baked.
    void begin(const std::filesystem::path& file, const MaterialOptions& options,
               std::shared_ptr<const Scene> known = {}, std::function<void(Scene&)> finish = {});
    bool busy() const { return thread_.joinable(); }
    const ProgressMonitor& progress() const { return *monitor_; }
    // The result once it is there. Throws Error when the work failed; the loader is then idle.
    std::unique_ptr<LoadedScene> take();
    // Cancels a load in progress, and waits for it.
    void cancel();

private:
    std::function<void()> report_;
    std::unique_ptr<ProgressMonitor> monitor_ = std::make_unique<ProgressMonitor>();
    std::thread thread_;
    std::atomic<bool> done_ = false;
    std::unique_ptr<LoadedScene> result_;
    std::string error_; // written before done_
};

} // namespace lumel::scene
