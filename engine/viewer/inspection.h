// One texel of a baked material: its lobe, the average that it stands for, LEAN's lobe with its
// best Ks.
#pragma once
#include "baker/bake.h"
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

// A square of the half-angle disc: side * side values of reflectance, row 0 on top (+y up, +x right).
struct DiscPicture {
    std::vector<float> values;
    double error = 0.0; // relative to the energy of the average
};

struct Inspection {
    bool valid = false;
    Texel texel;
    std::string material;
    int width = 0, height = 0; // of the level
    std::array<float, baker::kChannels> baked{};
    int side = 0;                                    // points of a picture's side
    double centreX = 0.0, centreY = 0.0, half = 1.0; // the part of the disc that is shown
    double peak = 1.0;                               // the largest value of the average
    DiscPicture average, fit, lean;
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
