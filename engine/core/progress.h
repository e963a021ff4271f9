// Progress of long work on a terminal, and the point where Ctrl-C takes effect.
#pragma once
#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

namespace lumel {

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
    Progress* whole_ = nullptr;
    size_t share_ = 0;
};

// Installs handlers for SIGINT and SIGTERM that only set a flag; a second signal ends the process.
void catchInterrupts();
bool interrupted();

} // namespace lumel
