#include "pipeline_compiler.h"
#include <algorithm>

namespace lumel::gpu {

vk::raii::Pipeline Compilation::take()
{
    if (claim())
        run();
    return result_.get();
}

void Compilation::drop()
{
    if (!claim())
        result_.wait();
}

PipelineCompiler::~PipelineCompiler()
{
    for (std::jthread& thread : threads_)
        thread.request_stop();
    threads_.clear();
}

void PipelineCompiler::add(std::shared_ptr<Compilation> compilation)
{
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(compilation));
    const size_t most = std::max(2u, std::thread::hardware_concurrency()) - 1;
    if (threads_.size() < std::min(most, queue_.size()))
        threads_.emplace_back([this](const std::stop_token& stop) { work(stop); });
    added_.notify_one();
}

void PipelineCompiler::work(const std::stop_token& stop)
{
    std::unique_lock lock(mutex_);
    while (added_.wait(lock, stop, [this] { return !queue_.empty(); })) {
        const std::shared_ptr<Compilation> next = std::move(queue_.front());
        queue_.pop_front();
        lock.unlock();
        if (!stop.stop_requested() && next->claim())
            next->run();
        lock.lock();
    }
}

} // namespace lumel::gpu
