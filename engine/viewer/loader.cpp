#include "loader.h"
#include "core/error.h"
#include "gltf/gltf.h"
#include <utility>

namespace lumel::scene {

void Loader::begin(const std::filesystem::path& file, const MaterialOptions& options,
                   std::shared_ptr<const Scene> known, std::function<void(Scene&)> finish)
{
    cancel();
    mayProceed_ = monitor_->cancelled = false;
    monitor_->set("loading " + file.filename().string(), 0, 0);
    thread_ = std::thread([this, file, options, known = std::move(known), finish = std::move(finish)] {
        monitorThisThread(monitor_.get());
        std::string error;
        try {
            load(file, options, known, finish);
        } catch (const std::bad_alloc&) {
            error = file.string() + ": out of memory; use smaller maps";
        } catch (const std::exception& e) { // Interrupted too: nobody asks for the result then
            error = e.what();
        }
        {
            const std::lock_guard lock(mutex_);
            error_ = std::move(error);
            done_ = true;
        }
        report_();
    });
}

void Loader::load(const std::filesystem::path& file, const MaterialOptions& options,
                  std::shared_ptr<const Scene> known, const std::function<void(Scene&)>& finish)
{
    auto loaded = std::make_unique<LoadedScene>();
    loaded->options = options;
    if (!known) {
        Scene scene = loadGltf(file);
        if (finish)
            finish(scene);
        known = std::make_shared<const Scene>(std::move(scene));
    }
    loaded->scene = known;
    MaterialBaker baker(*known, options);
    loaded->materials = std::make_shared<const std::vector<BakedMaterial>>(baker.placeholders());
    loaded->placeholders = baker.pending();
    deliver(std::move(loaded));
    if (baker.pending().empty() || !mayProceed())
        return;
    while (auto bake = baker.next()) {
        {
            const std::lock_guard lock(mutex_);
            bakes_.push_back(std::move(*bake));
        }
        report_();
    }
}

void Loader::deliver(std::unique_ptr<LoadedScene> loaded)
{
    {
        const std::lock_guard lock(mutex_);
        result_ = std::move(loaded);
    }
    report_();
}

bool Loader::mayProceed()
{
    std::unique_lock lock(mutex_);
    proceeds_.wait(lock, [this] { return mayProceed_ || monitor_->cancelled; });
    return !monitor_->cancelled;
}

void Loader::proceed()
{
    {
        const std::lock_guard lock(mutex_);
        mayProceed_ = true;
    }
    proceeds_.notify_all();
}

void Loader::join()
{
    {
        const std::lock_guard lock(mutex_);
        if (!done_ || result_ || !bakes_.empty())
            return;
    }
    thread_.join();
    taken_ = mayProceed_ = done_ = false;
    if (!error_.empty())
        throw Error(std::exchange(error_, {}));
}

std::unique_ptr<LoadedScene> Loader::take()
{
    std::unique_ptr<LoadedScene> result;
    if (!busy())
        return result;
    {
        const std::lock_guard lock(mutex_);
        result = std::move(result_);
    }
    taken_ = taken_ || result;
    join();
    return result;
}

std::vector<FinishedBake> Loader::takeBakes()
{
    std::vector<FinishedBake> bakes;
    if (!baking())
        return bakes;
    {
        const std::lock_guard lock(mutex_);
        bakes = std::exchange(bakes_, {});
    }
    return bakes;
}

void Loader::cancel()
{
    if (!busy())
        return;
    {
        const std::lock_guard lock(mutex_);
        monitor_->cancelled = true;
    }
    proceeds_.notify_all();
    thread_.join();
    taken_ = mayProceed_ = done_ = false;
    result_.reset();
    bakes_.clear();
    error_.clear();
}

} // namespace lumel::scene
