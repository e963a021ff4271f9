// Runs as plain data, from the JSON that `bench --json` and `shot --stats` write.
#pragma once
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace lumel::bench {

struct FrameRecord {
    double ms = 0.0;
    std::map<std::string, double> passMs;
    double marked = 0.0, lit = 0.0, derived = 0.0, kept = 0.0, pending = 0.0; // lumels
    double poolBytes = 0.0, renderScale = 1.0;
    std::optional<double> errorRmse, flickerRmse;
};

struct Run {
    std::string scene, shading, filter;
    int width = 0, height = 0;
    std::map<std::string, std::string> options;
    std::vector<FrameRecord> frames; // at least one
    double meanMs = 0.0, p50Ms = 0.0, p95Ms = 0.0, p99Ms = 0.0, maxMs = 0.0;
    size_t missed = 0;
    std::optional<double> errorRmse, flickerRmse, changeRmse;

    // "stress tsl 960x540 64 lights": what tells it from the others of a file.
    std::string name() const;
    double budgetMs() const; // 0: none
    double mean(double FrameRecord::*value) const;
    double meanPass(const std::string& pass) const;
};

// Throws nlohmann::json::exception for a document of another form.
std::vector<Run> runsOf(const nlohmann::json& document);
// Throws Error, one line, for a file that is no such document or holds no run.
std::vector<Run> readRuns(const std::filesystem::path& file);

// A table for the terminal: one line a run.
std::string tableOf(const std::vector<Run>& runs);
// One line per frame, the run's description in each: comma-separated values with a header (RFC 4180).
std::string csvOf(const std::vector<Run>& runs);

} // namespace lumel::bench
