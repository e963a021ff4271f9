#include "progress.h"
#include "error.h"
#include <csignal>
#include <cstdio>
#include <unistd.h>

namespace lumel {
namespace {

volatile std::sig_atomic_t signalled = 0;
std::atomic<int> living{0}; // lines that could be drawn
thread_local ProgressMonitor* threadMonitor = nullptr;

void onSignal(int number)
{
    if (signalled)
        _exit(128 + number);
    signalled = 1;
}

} // namespace

void catchInterrupts()
{
    std::signal(SIGINT, onSignal);
    std::signal(SIGTERM, onSignal);
}

bool interrupted()
{
    return signalled != 0;
}

int sayInterrupted()
{
    std::fputs("lumel: interrupted; no incomplete file was written\n", stderr);
    return 130;
}

void checkInterrupted()
{
    if (interrupted() || (threadMonitor && threadMonitor->cancelled))
        throw Interrupted();
}

void ProgressMonitor::set(const std::string& label, size_t done, size_t total)
{
    const std::lock_guard lock(mutex_);
    label_ = label;
    share_ = total > 0 ? float(double(std::min(done, total)) / double(total)) : 0.0f;
}

std::string ProgressMonitor::label() const
{
    const std::lock_guard lock(mutex_);
    return label_;
}

void monitorThisThread(ProgressMonitor* monitor)
{
    threadMonitor = monitor;
}

ProgressMonitor* monitorOfThisThread()
{
    return threadMonitor;
}

Progress::Progress(std::string label, size_t total)
    : label_(std::move(label)), total_(total), start_(std::chrono::steady_clock::now()),
      terminal_(living++ == 0 && isatty(STDERR_FILENO) != 0 && !threadMonitor), monitor_(threadMonitor)
{
    if (monitor_)
        monitor_->set(label_, 0, total_);
}

Progress::Progress(Progress& whole, size_t share, size_t total)
    : total_(std::max<size_t>(total, 1)), terminal_(false), whole_(&whole), share_(share)
{
}

Progress::~Progress()
{
    if (!whole_)
        --living;
    if (!drawn_)
        return;
    draw();
    std::fputc('\n', stderr);
}

void Progress::advance(size_t units)
{
    if (interrupted() || (monitor_ && monitor_->cancelled))
        throw Interrupted();
    const size_t before = done_.fetch_add(units);
    if (whole_) {
        const auto part = [&](size_t done) { return share_ * std::min(done, total_) / total_; };
        whole_->advance(part(before + units) - part(before));
    }
    if (monitor_)
        monitor_->set(label_, done_, total_);
    if (!terminal_)
        return;
    const auto elapsed = std::chrono::steady_clock::now() - start_;
    const int64_t ms = std::chrono::duration_cast<std::chrono::milliseconds>(elapsed).count();
    if (ms < nextDrawMs_)
        return;
    nextDrawMs_ = ms + 100;
    std::lock_guard lock(mutex_);
    drawn_ = true;
    draw();
}

void Progress::advanceTo(size_t units)
{
    const size_t done = done_;
    advance(units > done ? units - done : 0);
}

void Progress::print(const std::string& line)
{
    std::lock_guard lock(mutex_);
    if (drawn_)
        std::fputs("\r\033[K", stderr); // erase the line (ECMA-48)
    drawn_ = false;
    std::fflush(stderr);
    std::printf("%s\n", line.c_str());
    std::fflush(stdout);
}

void Progress::draw()
{
    const size_t done = std::min<size_t>(done_, total_);
    const int percent = total_ ? int(100 * done / total_) : 100;
    const std::string bar(size_t(percent) / 4, '#');
    std::fprintf(stderr, "\r%s [%-25s] %3d %%", label_.c_str(), bar.c_str(), percent);
    std::fflush(stderr);
}

} // namespace lumel
