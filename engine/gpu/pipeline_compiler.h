// Compiles pipelines in the background: drivers take from milliseconds to a second for each.
#pragma once
#include <atomic>
#include <condition_variable>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

namespace lumel::gpu {

// One pipeline's. The first to claim it does the work.
class Compilation {
public:
    template<class Make>
    explicit Compilation(Make make) : work_(std::move(make)), result_(work_.get_future())
    {
    }
    bool claim() { return !claimed_.exchange(true); }
    void run() { work_(); } // by whom has claimed it
    // Once: compiles it now, or waits for it. Throws what went wrong.
    vk::raii::Pipeline take();
    // It is not wanted any more: waits if it is being compiled, and else it never will be.
    void drop();

private:
    std::packaged_task<vk::raii::Pipeline()> work_;
    std::future<vk::raii::Pipeline> result_;
    std::atomic<bool> claimed_ = false;
};

// In the order in which they were added, on all cores but the one that renders.
class PipelineCompiler {
public:
    PipelineCompiler() = default;
    ~PipelineCompiler(); // those that were not begun are dropped
    void add(std::shared_ptr<Compilation> compilation);

private:
    void work(const std::stop_token& stop);
    std::mutex mutex_; // guards what follows
    std::condition_variable_any added_;
    std::deque<std::shared_ptr<Compilation>> queue_;
    std::vector<std::jthread> threads_; // from when there is something to do
};

} // namespace lumel::gpu
