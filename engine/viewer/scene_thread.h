// The scene is rendered on a thread of its own, so that the panels and the mouse wait for no frame of it.
#pragma once
#include "core/progress.h"
#include "picture_stream.h"
#include "renderers.h"
#include <condition_variable>
#include <functional>
#include <thread>

namespace lumel {

// What is to be rendered.
struct SceneRequest {
    ui::ViewState state;
    bool meter = false;     // for automatic exposure
    bool pictures = true;   // false: not yet, until the exposure is known
    bool suspended = false; // nothing until another request: paused, hidden
};

// What has been, since the last result was taken.
struct SceneResult {
    SceneReport report;
    std::vector<ui::FrameSample> frames;
    std::vector<tsl::ObjectResidency> residency; // of the left side
    float ambient = 0.0f;
    std::optional<LuminanceHistogram> metered;
    bool finished = false; // further frames would not change the pictures
};

class SceneThread {
public:
    // What is to be done on the window's thread with what a task found out.
    using Answer = std::function<void()>;
    using Task = std::function<Answer(ViewRenderers&)>;

    // wake: called on the scene's thread when there is something to take().
    SceneThread(const gpu::Device& renders, const gpu::Device& shows, std::function<void()> wake);
    ~SceneThread();

    // All below: on the window's thread.
    // Ends it: no other call may follow. False when it still is at a frame then; tasks are waited for.
    bool endsWithin(std::chrono::milliseconds time);
    void post(SceneRequest request); // in place of the one before
    bool hasResult() const;          // take() has something
    // Nothing when there is nothing new. Throws what a frame threw.
    std::optional<SceneResult> take();
    // Work with the renderers, before the next frame, for which another request is awaited. The answer is
    // called by take().
    void ask(Task task);
    // Calls `use` with the renderers between two frames; another request is then awaited.
    template<class Use>
    decltype(auto) withRenderers(const Use& use)
    {
        const Pause pause(*this);
        return use(renderers_);
    }
    std::shared_ptr<const std::vector<scene::BakedMaterial>> materials(baker::Method method) const
    {
        return renderers_.materials(method);
    }
    std::optional<baker::Method> missing(const ui::ViewState& state) const
    {
        return renderers_.missing(state);
    }
    std::optional<baker::Method> unfinished(const ui::ViewState& state) const
    {
        return renderers_.unfinished(state);
    }
    PictureStream& pictures(size_t side) { return side == 0 ? left_ : right_; }

private:
    // The thread stands still.
    class Pause {
    public:
        explicit Pause(SceneThread& thread);
        ~Pause();

    private:
        SceneThread& thread_;
        std::unique_lock<std::mutex> lock_;
    };
    void run();
    void end();
    void setWorking(bool working);
    bool pause();
    bool runTasks();
    void work(const SceneRequest& request);
    void copyPictures(size_t sides);
    void publish(const SceneRequest& request, SceneResult result, bool idle);

    PictureStream left_, right_;
    ViewRenderers renderers_;
    std::function<void()> wake_;
    SceneReport report_;
    bool rendered_ = false;    // by the last round
    ProgressMonitor stop_;     // of what a newer request makes needless
    std::mutex using_;         // the renderers
    mutable std::mutex mutex_; // of all below
    std::condition_variable changed_;
    std::optional<SceneRequest> next_;
    SceneRequest current_{.state = {}, .meter = false, .pictures = true, .suspended = true};
    SceneResult result_;
    bool resulted_ = false, ended_ = false;
    bool working_ = false, done_ = false; // at a frame; at its end
    bool idle_ = false;                   // nothing to do until the next request
    int pauses_ = 0;
    std::optional<LuminanceHistogram> metered_; // as published
    std::vector<Task> tasks_;
    std::vector<Answer> answers_;
    std::exception_ptr failure_;
    std::thread thread_;
};

} // namespace lumel
