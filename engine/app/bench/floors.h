// What passes cost beside the least that they could (renderer/passes/floor_pass.h), both measured in turns.
#pragma once
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace lumel::bench {

struct FloorFrame {
    double ms = 0.0;
    std::map<std::string, double> passMs;
    double lit = 0.0, derived = 0.0, pixels = 0.0; // lumels lit and derived; pixels that anything covers
    std::map<std::string, double> floorNs;         // by kFloorNames, for each of these
};

// A run's `floors`: medians over its frames, at least one.
nlohmann::json floorsOf(const std::vector<FloorFrame>& frames);
// A table for each run of a document that has floors.
std::string floorTables(const nlohmann::json& document);

} // namespace lumel::bench
