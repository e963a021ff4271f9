// Progress of long work on a terminal, and the point where Ctrl-C takes effect.
#pragma once
#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

namespace lumel {

// Watches the long work of one thread from another, and can stop it.
struct ProgressMonitor {
    std::atomic<bool> cancelled = false; // the work throws Interrupted soon after
    void set(const std::string& label, size_t done, size_t total);
    // What is being done, and the share of it in [0, 1] that is.
    std::string label() const;
    float share() const { return share_; }

private:
    mutable std::mutex mutex_;
    std::string label_;
    std::atomic<float> share_ = 0.0f;
};
// From now on this thread's work is told to `monitor` in place of stderr. Null: no more.
void monitorThisThread(ProgressMonitor* monitor);
ProgressMonitor* monitorOfThisThread();

// One line on stderr, redrawn at most ten times a second, only when stderr is a terminal and the work
// has taken longer than 0.2 s. While one line lives, others stay silent. Safe to call from several threads.
class Progress {
public:
    explicit Progress(std::string label, size_t total);
    // A part of `whole`: `total` units here are `share` units there.
    Progress(Progress& whole, size_t share, size_t total);
    ~Progress(); // ends the line
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // Work done since the last call. Throws Interrupted after Ctrl-C.
    void advance(size_t units);
    // Work done since the start, if that is more than was counted.
    void advanceTo(size_t units);
    // One line of results on stdout, clear of the progress line.
    void print(const std::string& line);

private:
    void draw();
    std::string label_;
    size_t total_;
    std::atomic<size_t> done_{0};
    std::chrono::steady_clock::time_point start_;
    std::atomic<int64_t> nextDrawMs_{200};
    std::mutex mutex_;
    bool terminal_;
    bool drawn_ = false;
    ProgressMonitor* monitor_ = nullptr;
    Progress* whole_ = nullptr;
    size_t share_ = 0;
};

// Installs handlers for SIGINT and SIGTERM that only set a flag; a second signal ends the process.
void catchInterrupts();
bool interrupted();
int sayInterrupted(); // for users; returns the exit code
// Throws Interrupted after Ctrl-C, and when the monitor of this thread's work says to stop.
void checkInterrupted();

} // namespace lumel
