// The documented form of the statistics (engine/app/bench/README.md), field by field.
#pragma once
#include <nlohmann/json.hpp>
#include <set>
#include <string>

namespace lumel::cli {

// What one run of `shot --stats` or `bench --json` must be; each difference is a test failure that names the
// field. floors: measured too.
void expectRunOfSchema(const nlohmann::json& run, bool floors = false);

// All names of fields in the document, but those inside `options` and `lumels_by_tile_size`: options and
// numbers.
std::set<std::string> fieldNames(const nlohmann::json& document);

} // namespace lumel::cli
