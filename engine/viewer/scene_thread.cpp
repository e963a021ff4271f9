#include "scene_thread.h"
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

namespace lumel {

SceneThread::SceneThread(const gpu::Device& renders, const gpu::Device& shows, std::function<void()> wake)
    : left_(renders, shows), right_(renders, shows), renderers_(renders), wake_(std::move(wake)),
      thread_([this] { run(); })
{
}

SceneThread::~SceneThread()
{
    end();
    thread_.join();
}

void SceneThread::end()
{
    {
        const std::lock_guard lock(mutex_);
        ended_ = true;
        stop_.cancelled = true;
    }
    changed_.notify_all();
}

bool SceneThread::endsWithin(std::chrono::milliseconds time)
{
    end();
    std::unique_lock lock(mutex_);
    const bool done = changed_.wait_for(lock, time, [this] { return done_; });
    return done || !working_;
}

void SceneThread::post(SceneRequest request)
{
    {
        const std::lock_guard lock(mutex_);
        if (!sameView(request.state, current_.state))
            stop_.cancelled = true;
        next_ = std::move(request);
    }
    changed_.notify_all();
}

bool SceneThread::hasResult() const
{
    const std::lock_guard lock(mutex_);
    return resulted_ || failure_ || !answers_.empty() || left_.fresh() || right_.fresh();
}

std::optional<SceneResult> SceneThread::take()
{
    std::unique_lock lock(mutex_);
    if (failure_)
        std::rethrow_exception(failure_);
    const auto answers = std::exchange(answers_, {});
    std::optional<SceneResult> result;
    if (std::exchange(resulted_, false)) {
        result = result_;
        result_.frames.clear();
        result_.metered.reset();
    }
    lock.unlock();
    for (const Answer& answer : answers)
        answer();
    return result;
}

void SceneThread::ask(Task task)
{
    {
        const std::lock_guard lock(mutex_);
        tasks_.push_back(std::move(task));
    }
    changed_.notify_all();
}

SceneThread::Pause::Pause(SceneThread& thread) : thread_(thread)
{
    {
        const std::lock_guard lock(thread_.mutex_);
        ++thread_.pauses_;
        thread_.stop_.cancelled = true;
    }
    lock_ = std::unique_lock(thread_.using_);
}

SceneThread::Pause::~Pause()
{
    lock_.unlock();
    {
        const std::lock_guard lock(thread_.mutex_);
        --thread_.pauses_;
        thread_.next_.reset(); // earlier requests are about what was before
        thread_.idle_ = true;
    }
    thread_.changed_.notify_all();
}

// Until there is something to do. False: the thread is to end.
bool SceneThread::pause()
{
    // In a still view, the next look at what time brings.
    constexpr auto kStep = std::chrono::milliseconds(20);
    std::unique_lock lock(mutex_);
    const auto due = [this] { return ended_ || (pauses_ == 0 && (next_ || !tasks_.empty())); };
    if (idle_ || pauses_ > 0)
        changed_.wait(lock, [&] { return due() || (pauses_ == 0 && !idle_); });
    else if (!rendered_)
        changed_.wait_for(lock, kStep, due);
    stop_.cancelled = ended_;
    if (next_)
        current_ = *std::exchange(next_, std::nullopt);
    return !ended_;
}

void SceneThread::run()
{
    try {
        idle_ = true;
        while (pause()) {
            const std::lock_guard lock(using_);
            if (!runTasks())
                work(current_); // only pause() changes it
        }
    } catch (...) {
        const std::lock_guard lock(mutex_);
        failure_ = std::current_exception();
    }
    {
        const std::lock_guard lock(mutex_);
        done_ = true;
    }
    changed_.notify_all();
    wake_();
}

bool SceneThread::runTasks()
{
    std::vector<Task> tasks;
    {
        const std::lock_guard lock(mutex_);
        tasks = std::exchange(tasks_, {});
        if (!tasks.empty())
            idle_ = true;
    }
    for (const Task& task : tasks) {
        Answer answer = task(renderers_);
        const std::lock_guard lock(mutex_);
        answers_.push_back(std::move(answer));
    }
    if (!tasks.empty())
        wake_();
    return !tasks.empty();
}

void SceneThread::work(const SceneRequest& request)
{
    const bool active = !request.suspended && renderers_.scene();
    const glm::uvec2 size = request.state.settings.size;
    SceneResult result;
    setWorking(true);
    if (active && request.meter)
        result.metered = renderers_.meter(request.state, size);
    rendered_ = false;
    if (active && request.pictures) {
        rendered_ = renderers_.render(request.state, size, report_, stop_);
        if (rendered_) {
            // Of the last frames that have finished: with others in flight, render() returns at once.
            ui::FrameSample sample{.at = glfwGetTime(), .ms = 0.0f, .passMs = {}};
            for (size_t side = 0; side < (request.state.split ? 2u : 1u); ++side) {
                sample.ms += float(report_.sides[side].stats.ms);
                for (const auto& [pass, passMs] : report_.sides[side].stats.passMs)
                    sample.passMs[pass] += passMs;
            }
            result.frames.push_back(std::move(sample));
            copyPictures(request.state.split ? 2 : 1);
        }
        result.finished = renderers_.finished();
    }
    setWorking(false);
    const bool idle = !active || !request.pictures || result.finished;
    publish(request, std::move(result), idle);
}

void SceneThread::setWorking(bool working)
{
    const std::lock_guard lock(mutex_);
    working_ = working;
}

void SceneThread::copyPictures(size_t sides)
{
    constexpr auto kStep = std::chrono::milliseconds(30);
    for (size_t side = 0; side < sides; ++side) {
        Renderer* shown = renderers_.shown(side);
        if (!shown)
            continue;
        if (!renderers_.refined(side)) {
            pictures(side).write(*shown);
            continue;
        }
        pictures(side).fadeTo(*shown, [&] {
            wake_();
            std::unique_lock lock(mutex_);
            return !changed_.wait_for(lock, kStep, [this] { return stop_.cancelled.load(); });
        });
    }
}

void SceneThread::publish(const SceneRequest& request, SceneResult result, bool idle)
{
    std::unique_lock lock(mutex_);
    idle_ = idle;
    const bool finished = std::exchange(result_.finished, result.finished);
    const bool metered = result.metered && (!request.pictures || result.metered != metered_);
    if (!rendered_ && finished == result.finished && !metered)
        return;
    metered_ = result.metered;
    resulted_ = true;
    if (rendered_) {
        result_.report = report_;
        result_.residency = renderers_.residency(0);
        result_.ambient = renderers_.ambient();
        std::move(result.frames.begin(), result.frames.end(), std::back_inserter(result_.frames));
    }
    if (result.metered)
        result_.metered = result.metered;
    lock.unlock();
    wake_();
}

} // namespace lumel
