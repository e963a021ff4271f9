// Loads and bakes on a thread of its own, so that a window stays alive meanwhile.
#pragma once
#include "core/progress.h"
#include "scene/materials.h"
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <thread>

namespace lumel::scene {

// A scene with its materials by one method, some of which may be placeholders.
struct LoadedScene {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const std::vector<BakedMaterial>> materials;
    std::set<size_t> placeholders; // of these
    MaterialOptions options;
};

class Loader {
public:
    // changed: called on the loader's thread when there is something to take.
    explicit Loader(std::function<void()> changed) : report_(std::move(changed)) {}
    ~Loader() { cancel(); }

    // Begins; cancels a load in progress. Without `known` the file is loaded first. `finish` may change
    // the scene before its materials are baked. They are in two steps: take() gives the scene as soon as it
    // can be shown, and once proceed() has been called, takeBakes() what was missing, as it is finished.
    void begin(const std::filesystem::path& file, const MaterialOptions& options,
               std::shared_ptr<const Scene> known = {}, std::function<void(Scene&)> finish = {});
    bool busy() const { return thread_.joinable(); }
    // The scene has been taken, and some of its materials are not baked.
    bool baking() const { return busy() && taken_; }
    const ProgressMonitor& progress() const { return *monitor_; }
    // The scene once it is there. Throws Error when the work failed; the loader is then idle.
    std::unique_ptr<LoadedScene> take();
    void proceed();
    // Finished since the last call. Throws as take().
    std::vector<FinishedBake> takeBakes();
    // Cancels a load in progress, and waits for it.
    void cancel();

private:
    void load(const std::filesystem::path& file, const MaterialOptions& options,
              std::shared_ptr<const Scene> known, const std::function<void(Scene&)>& finish);
    void deliver(std::unique_ptr<LoadedScene> loaded);
    bool mayProceed(); // waits
    void join();       // when the thread has done all

    std::function<void()> report_;
    std::unique_ptr<ProgressMonitor> monitor_ = std::make_unique<ProgressMonitor>();
    std::thread thread_;
    bool taken_ = false;
    std::mutex mutex_; // of all below
    std::condition_variable proceeds_;
    bool mayProceed_ = false, done_ = false;
    std::unique_ptr<LoadedScene> result_;
    std::vector<FinishedBake> bakes_;
    std::string error_;
};

} // namespace lumel::scene
