// The renderer: one scene, one picture size, frame after frame.
#pragma once
#include "frame_flight.h"
#include "renderer/passes/deform_pass.h"
#include "renderer/passes/display_pass.h"
#include "renderer/passes/draw_pass.h"
#include "renderer/passes/edge_pass.h"
#include "renderer/passes/feedback_pass.h"
#include "renderer/passes/floor_pass.h"
#include "renderer/passes/light_pass.h"
#include "renderer/passes/meter_pass.h"
#include "renderer/passes/plan_pass.h"
#include "renderer/passes/shadow_pass.h"
#include "tsl/dynamic_objects.h"

namespace lumel {

class Renderer {
public:
    // Shows the objects of `scene`, which `resources` are of; other renderers may share these.
    Renderer(const gpu::Device& device, const scene::Scene& scene, const SceneResources& resources,
             const Settings& settings);
    // With resources of its own.
    Renderer(const gpu::Device& device, const scene::Scene& scene,
             const std::vector<scene::BakedMaterial>& materials, const Settings& settings);

    // Renders one frame. Within Settings::framesInFlight it is not waited for, unless the textures of its
    // objects are to be exact: the result then is of the last frame that has finished, at first of none.
    // Throws Interrupted after Ctrl-C.
    FrameStats render(const scene::Camera& camera);
    // Waits for the frames in flight. Changes no picture to come.
    void finish();
    // Of the frames that have finished since the last call, in order: of a few, where that was long ago.
    std::vector<FrameStats> takeFinished() { return std::exchange(finished_, {}); }
    // Reference only: adds settings().samples to those of this very view, or starts over.
    FrameStats accumulate(const scene::Camera& camera);
    // The luminances of the view, for automatic exposure; changes no picture.
    LuminanceHistogram meter(const scene::Camera& camera);
    // The least that the passes of the last frame, which `camera` saw, could take; changes no picture. Of
    // texture space and of forward shading.
    FloorStats measureFloors(const scene::Camera& camera);
    // The last frame changed nothing: a further one of the same view would be the same.
    bool settled() const { return settled_ && lastPlanned_ <= knownFrame_; }
    int samples() const { return sumSamples_; } // behind the reference's picture

    const Settings& settings() const { return settings_; }
    // From the next frame on. What a change does not touch is kept.
    void setSettings(const Settings& settings);
    // Drops all state of earlier frames: the next is as a new renderer's first.
    void restart();
    // For frames that take long beside others' work: each pass is a submission, and Ctrl-C or a monitor is
    // heard after each: a frame that throws Interrupted is followed by restart().
    void submitPassesAlone() { passesAlone_ = true; }

    // From the next frame on; what they reach is lit again.
    void setLights(const std::vector<scene::Light>& lights);
    void setEnvironment(std::shared_ptr<const EnvironmentMap> environment);
    void moveObject(size_t object, const glm::mat4& worldFromObject)
    {
        scene_.moveObject(object, worldFromObject, frameIndex_ + 1);
    }
    // Whose maps hold something else from the next frame on.
    void changeMaterial(size_t material);
    // So that their pipelines are there when changeMaterial() tells that they have them.
    void expectSecondLobes(const std::set<size_t>& materials);
    void deform(const scene::Shapes& shapes) { scene_.deform(shapes, frameIndex_ + 1); }

    // Of the last frame, in the scene's order; without names.
    std::vector<ObjectStats> objectStats() const;
    std::map<uint32_t, size_t> lumelsByTileSize(); // texture space only, see PlanPass

    const gpu::Image& display() const { return targets_.display; } // in use transferRead after a frame
    // Commands that read it: they follow the last frame, and it is not replaced before they have finished.
    void submitCopy(vk::CommandBuffer commands, vk::Fence fence) { ring_.submit(commands, fence); }
    const SceneState& scene() const { return scene_; }
    const tsl::Residency& residency() const { return residency_; } // of the objects, in the scene's order
    Image readRadiance() const;                                    // RGB, linear, after render()
    Image readDisplay() const; // RGB, sRGB-encoded display values in [0, 1]

private:
    void preparePipelines();
    void recordFrame(Frame& frame);
    void recordTextureSpace(Frame& frame);
    void recordReference(Frame& frame);
    bool isStill(const Frame& frame) const;
    bool isSettled(const Frame& frame) const;
    uint32_t sampleSpacing(const Frame& frame) const;
    void findFeedback(Frame& frame, uint32_t spacing);
    bool chooseDetail(Frame& frame); // true: the feedback pass is to count again
    size_t surfacePages(const Frame& frame) const;
    void assignTextures(Frame& frame, uint32_t spacing);
    void noteOffsets(const Frame& frame, uint32_t spacing);
    void noteDynamic(const Frame& frame);
    void keepToBudget(const InFlight& own);
    void countLumels(InFlight& own);
    void countFrame(const Frame& frame, InFlight& own);
    uint32_t places() const; // frames in flight
    bool isLate(const scene::Camera& camera) const;
    bool isCut(const scene::Camera& camera) const;
    void read(InFlight& own);
    void learn(InFlight& from);
    void learnAll();
    Frame makeFrame(const Settings& settings, Targets& targets, uint32_t index);
    Frame makeFrame(const scene::Camera& camera, const Settings& settings, Targets& targets, uint32_t index);
    FrameStats renderFrame(const scene::Camera& camera);
    glm::mat4 clipFromWorld(const scene::Camera& camera) const;
    InFlight& own() { return *inFlight_[place_]; } // of the frame being made
    void begin(Frame& frame);
    void submit(Frame& frame);
    void submitAndWait(Frame& frame); // adds up the pass times, and goes on recording
    void endPass(Frame& frame);
    shared::View makeView(const Frame& frame, glm::vec2 shiftInPixels = glm::vec2(0.0f)) const;
    void writeView(const Frame& frame);

    const gpu::Device& device_;
    Settings settings_;
    Targets targets_;
    SceneState scene_;
    ShadowPass shadow_;
    LitPool pool_;
    DeformPass deform_;
    FeedbackPass feedback_;
    PlanPass plan_;
    LightPass light_;
    DrawPass draw_;
    EdgePass edges_;
    DisplayPass display_;
    std::unique_ptr<MeterPass> meter_;  // made when first needed
    std::unique_ptr<FloorPass> floors_; // likewise
    std::array<std::unique_ptr<InFlight>, gpu::FrameRing::kMostFrames> inFlight_;
    uint32_t place_ = 0; // of the last frame
    BusyClock clock_;
    double readMs_ = 0.0;              // when the last frame was found to have finished
    FrameStats last_;                  // of the last frame that has finished
    std::vector<FrameStats> finished_; // since they were taken
    tsl::Residency residency_;
    std::optional<tsl::BudgetController> budget_;
    tsl::DynamicObjects dynamicObjects_;
    size_t dynamicInView_ = 0;
    tsl::Quality quality_;      // of this frame
    bool budgetMissed_ = false; // said so
    uint32_t frameIndex_ = 0;
    glm::uvec2 renderSize_{0};
    bool passesAlone_ = false;
    bool settled_ = false;
    bool sampled_ = false; // the feedback pass ran in this frame
    bool first_ = true;    // nothing is known of any view
    int sumSamples_ = 0;
    glm::mat4 sumView_{0.0f};
    uint32_t sumFrame_ = 0; // in which the sum was begun
    // What the lumels in the pool stand for, and whether that is all that this view needs.
    glm::mat4 knownView_{0.0f};
    tsl::Quality knownQuality_;
    uint32_t knownChange_ = 0;          // frame up to which changes of lights and objects are in
    std::optional<tsl::Detail> detail_; // of the frame before, without the frame budget's bias
    uint32_t offsetsSeen_ = 0;          // of the feedback pass's cycle, in this very view
    uint32_t seenSince_ = 0;            // the first frame that sees just this
    uint32_t lastPlanned_ = 0;          // frame
    // What frames go by: of the latest one whose place in the rings has come round, or that was waited for.
    // Not of whichever happens to have finished: the same frames give the same pictures.
    Feedback latest_;
    uint32_t knownFrame_ = 0; // that the next two are of, or a later one that had nothing to do
    size_t lumelsPending_ = 0;
    size_t tilesMarked_ = 0;
    float sceneRadius_ = 0.0f; // metres
    std::optional<scene::Camera> lastCamera_;
    std::vector<tsl::ObjectFeedback> knownFeedback_;
    uint32_t knownDivisor_ = 1;
    std::vector<uint8_t> inView_;
    FrameStats known_;        // marks and pixels
    shared::Plan lastPlan_{}; // that was read
    gpu::FrameRing ring_;     // goes first: it waits for what uses the others
};

} // namespace lumel
