#include "loader.h"
#include "core/error.h"
#include "gltf/gltf.h"
#include <utility>

namespace lumel::scene {

void Loader::begin(const std::filesystem::path& file, const MaterialOptions& options,
                   std::shared_ptr<const Scene> known, std::function<void(Scene&)> finish)
{
    cancel();
    monitor_->cancelled = false;
    monitor_->set("loading " + file.filename().string(), 0, 0);
    thread_ = std::thread([this, file, options, known, finish] {
        monitorThisThread(monitor_.get());
        try {
            auto loaded = std::make_unique<LoadedScene>();
            loaded->options = options;
            loaded->scene = known;
            if (!known) {
                Scene scene = loadGltf(file);
                if (finish)
                    finish(scene);
                loaded->scene = std::make_shared<const Scene>(std::move(scene));
            }
            loaded->materials =
                std::make_shared<const std::vector<BakedMaterial>>(bakeMaterials(*loaded->scene, options));
            result_ = std::move(loaded);
        } catch (const std::bad_alloc&) {
            error_ = file.string() + ": out of memory; use smaller maps";
        } catch (const std::exception& e) { // Interrupted too: nobody asks for the result then
            error_ = e.what();
        }
        done_ = true;
        report_();
    });
}

std::unique_ptr<LoadedScene> Loader::take()
{
    if (!done_)
        return nullptr;
    thread_.join();
    done_ = false;
    if (!error_.empty())
        throw Error(std::exchange(error_, {}));
    return std::move(result_);
}

void Loader::cancel()
{
    if (!thread_.joinable())
        return;
    monitor_->cancelled = true;
    thread_.join();
    done_ = false;
    result_.reset();
    error_.clear();
}

} // namespace lumel::scene
