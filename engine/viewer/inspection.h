// The texel under the cursor: which it is, what the baker says of it (baker/inspect.h).
#pragma once
#include "baker/inspect.h"
#include "scene/materials.h"
#include <array>
#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>

namespace lumel::ui {

// Which texel.
struct Texel {
    size_t material = 0;
    int level = 0, x = 0, y = 0;
    bool operator==(const Texel&) const = default;
};

using baker::DiscPicture;

struct Inspection : baker::TexelLobes {
    bool valid = false;
    Texel texel;
    std::string material;
    int width = 0, height = 0; // of the level
    std::array<float, baker::kChannels> baked{};
};

// Works on a thread of its own: averages over thousands of texels take their time.
class Inspector {
public:
    ~Inspector();
    // Inspects this texel unless it was the last one. Ignored while one is in progress.
    void look(std::shared_ptr<const scene::Scene> scene,
              std::shared_ptr<const std::vector<scene::BakedMaterial>> baked, const Texel& texel);
    // Moves a new result to `inspection`.
    bool take(Inspection& inspection);
    bool busy() const { return thread_.joinable() && !done_; }

private:
    struct Maps;
    void work(const scene::Scene& scene, const std::vector<scene::BakedMaterial>& baked, const Texel& texel);
    std::thread thread_;
    std::atomic<bool> done_ = false;
    Inspection result_;
    std::optional<Texel> last_;
    const void* lastScene_ = nullptr;
    std::shared_ptr<Maps> maps_; // of the material looked at last
};

} // namespace lumel::ui
