// The viewer's renderers: one for each side of the split, one for the reference that both are measured by.
// They share the scene's resources; sides of other filters have other materials. Used by one thread at a
// time.
#pragma once
#include "app/playback.h"
#include "loader.h"
#include "view_state.h"
#include <chrono>
#include <mutex>

namespace lumel {

bool sameCamera(const scene::Camera& a, const scene::Camera& b);
// Whether both ask for the same pictures.
bool sameView(const ui::ViewState& a, const ui::ViewState& b);

// What the renderers report of a view.
struct SceneReport {
    std::array<ui::SideReport, 2> sides;
    std::array<baker::Method, 2> methods{}; // of the materials that are shown
    int referenceSamples = 0;
};

class ViewRenderers {
public:
    explicit ViewRenderers(const gpu::Device& device) : device_(device) {}

    // The same scene with other materials. False, and nothing is done, where their maps have other sizes or
    // other filters are shown too.
    bool setMaterials(const scene::LoadedScene& loaded);
    // Another scene, or the same with other materials: all renderers are replaced. Throws Error and keeps the
    // old ones when the new ones do not fit into memory.
    void setScene(scene::LoadedScene loaded, const ui::ViewState& state);
    // The materials of another method, for the same scene; or of one that there is, with fewer placeholders.
    void addMaterials(scene::LoadedScene loaded);
    // In place of placeholders, of a method that there is. What shows them is lit again.
    void replace(baker::Method method, const std::vector<scene::FinishedBake>& bakes);
    // Its placeholders stay: they cannot be baked.
    void keepPlaceholders(baker::Method method);
    std::shared_ptr<const scene::Scene> scene() const { return scene_; }
    // These two from any thread.
    std::shared_ptr<const std::vector<scene::BakedMaterial>> materials(baker::Method method) const;
    // A method that a side asks for and that has no materials yet; or one with placeholders.
    std::optional<baker::Method> missing(const ui::ViewState& state) const;
    std::optional<baker::Method> unfinished(const ui::ViewState& state) const;

    // Renders what the state asks for, unless it is up to date. True if anything was rendered. Within a frame
    // budget, a view that has been still for a moment is rendered once more as `lumel shot` does; `stop`
    // ends that early.
    bool render(const ui::ViewState& state, glm::uvec2 size, SceneReport& report, ProgressMonitor& stop);
    // The luminances of what the left side is to show; nothing without a scene.
    std::optional<LuminanceHistogram> meter(const ui::ViewState& state, glm::uvec2 size);
    // Further frames would not change the picture.
    bool finished() const { return finished_; }

    // The last render() replaced this side's picture by the one without a budget.
    bool refined(size_t side) const { return rendererOf(side)->refined; }

    // In place of the scene's.
    void setLights(const std::vector<scene::Light>& lights);
    // In place of the scene's.
    void setEnvironment(std::shared_ptr<const scene::Environment> environment);
    // Per object: the lit texture of a side lit in texture space; lumels of level 0.
    std::vector<tsl::ObjectResidency> residency(size_t side) const;
    std::vector<glm::uvec2> lumelGrids() const;

    float ambient() const; // sky radiance, as the lights give it

    // Whose picture a side shows; null before the first one.
    Renderer* shown(size_t side);
    // The picture of a side as a new renderer would render it, display values or radiance. The arguments of
    // the command that does are settings(side) and method(side).
    Image screenshot(const ui::ViewState& state, size_t side, bool radiance);
    const Settings& settings(size_t side) const { return rendererOf(side)->renderer->settings(); }
    int samples(size_t side) const { return rendererOf(side)->renderer->samples(); }
    baker::Method method(size_t side) const { return rendererOf(side)->method; }
    // For shaders that have changed: the next frames are of new renderers.
    void restart();

private:
    struct Slot {
        std::unique_ptr<Renderer> renderer;
        baker::Method method = baker::Method::fit;
        // Renders still views without a budget, from nothing, so that a picture is the one of `lumel shot`,
        // while `renderer` keeps the lumels that the next motion needs.
        std::unique_ptr<Renderer> exact;
        std::optional<double> exactSeconds;
        bool isExact = false;  // that of `exact` is shown
        bool isFirst = false;  // nothing of the scene has been shown
        bool refined = false;  // by the last frame
        bool rendered = false; // up to date
        bool stale = false;    // no more, from the next frame on
        bool expects = false;  // was told which materials may gain second lobes
        std::chrono::steady_clock::time_point changed;
        std::optional<LuminanceHistogram> metered; // of that view
        scene::Camera camera;
        std::optional<double> seconds; // of the animation; nothing: as the file's nodes stand
        FrameStats stats;
    };
    // The materials by one method.
    struct Bake {
        std::shared_ptr<const std::vector<scene::BakedMaterial>> baked;
        std::set<size_t> placeholders;
        scene::MaterialOptions options;
        std::shared_ptr<MaterialResources> uploaded; // when first shown
    };
    static constexpr size_t kReference = 2;
    Slot* rendererOf(size_t side);
    const Slot* rendererOf(size_t side) const;
    template<class Asked>
    std::optional<baker::Method> firstOf(const ui::ViewState& state, const Asked& asked) const;
    void replace(Bake& bake, baker::Method method, size_t material, const scene::Reflectance& reflectance);
    bool upload(const Bake& bake, size_t material, const scene::Reflectance& reflectance);
    void expectSecondLobes(Slot& slot, Shading shading);
    SceneResources resourcesOf(baker::Method method); // of materials that are there
    static void restart(Slot& slot);
    void prepare(Slot& slot, const ui::ViewState& state, baker::Method method, const Settings& settings);
    // The slot of a side as the state asks for.
    Slot& prepareSide(const ui::ViewState& state, glm::uvec2 size, size_t side);
    Slot& prepareReference(const ui::ViewState& state, glm::uvec2 size);
    bool renderSlot(Slot& slot, const ui::ViewState& state, ProgressMonitor& stop);
    // False when it was stopped.
    bool renderExact(Slot& slot, const ui::ViewState& state, ProgressMonitor* stop);
    static void forgetExact(Slot& slot);
    static Renderer& shown(const Slot& slot) { return slot.isExact ? *slot.exact : *slot.renderer; }
    bool isDone(const Slot& slot) const; // of a side that is no reference
    template<class Change>
    void changeAll(const Change& change); // lights, environment
    void forgetUnused(const ui::ViewState& state);
    void measure(const ui::ViewState& state, SceneReport& report);

    const gpu::Device& device_;
    std::shared_ptr<const scene::Scene> scene_;
    std::optional<Playback> playback_; // of a scene that is animated
    std::shared_ptr<const GeometryResources> geometry_;
    std::map<baker::Method, Bake> materials_;
    mutable std::mutex materialsMutex_;                 // of changes to the map
    std::shared_ptr<const EnvironmentMap> environment_; // the scene's, until another is set
    std::array<Slot, 3> slots_;
    std::array<bool, 2> isReference_{}; // what the sides show
    // That the renderers have; nothing: the scene's.
    std::optional<std::vector<scene::Light>> lights_;
    int measuredSamples_ = 0;
    bool finished_ = false;
};

} // namespace lumel
