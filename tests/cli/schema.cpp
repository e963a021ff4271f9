#include "schema.h"
#include "core/pass_names.h"
#include <gtest/gtest.h>

namespace lumel::cli {
namespace {

using nlohmann::json;

// A template: objects have exactly its fields, or with the single field "*" any of that kind; 0 stands for a
// number, "" for a text, null for a number or null. Arrays hold elements like the template's first.
void expectLike(const json& value, const json& form, const std::string& where)
{
    if (form.is_number()) {
        EXPECT_TRUE(value.is_number() && value >= 0) << where << ": " << value;
    } else if (form.is_string()) {
        EXPECT_TRUE(value.is_string()) << where << ": " << value;
    } else if (form.is_null()) {
        EXPECT_TRUE(value.is_null() || value.is_number()) << where << ": " << value;
    } else if (form.is_array()) {
        ASSERT_TRUE(value.is_array()) << where;
        for (const json& element : value)
            expectLike(element, form.front(), where + "[]");
    } else {
        ASSERT_TRUE(value.is_object()) << where;
        const bool any = form.contains("*");
        for (const auto& [name, part] : value.items()) {
            EXPECT_TRUE(any || form.contains(name)) << where << "." << name << " is not documented";
            if (any || form.contains(name))
                expectLike(part, form.at(any ? "*" : name), where + "." + name);
        }
        for (const auto& [name, part] : form.items())
            EXPECT_TRUE(any || value.contains(name)) << where << "." << name << " is missing";
    }
}

json formOfRun()
{
    json passes;
    for (const char* pass : kPassNames)
        passes[pass] = 0;
    const json frame = {
        {"ms", 0},
        {"passes", passes},
        {"lumels", {{"marked", 0}, {"lit", 0}, {"derived", 0}, {"kept", 0}, {"pending", 0}}},
        {"pixels_covered", 0},
        {"tiles", {{"marked", 0}, {"lit", 0}}},
        {"pool", {{"used_bytes", 0}, {"surface_bytes", 0}, {"cap_bytes", 0}, {"textures", 0}}},
        {"memory",
         {{"allocated_bytes", 0},
          {"allocations", 0},
          {"lit_textures", 0},
          {"surface_cache", 0},
          {"materials", 0},
          {"geometry", 0},
          {"texel_maps", 0},
          {"targets", 0},
          {"buffers", 0},
          {"staging", 0}}},
        {"host_waits", 0},
        {"ring_waits", 0},
        {"uploaded_bytes", 0},
        {"pipelines_created", 0},
        {"objects", {{"tsl", 0}, {"forward", 0}, {"culled", 0}}},
        {"exposure", 0},
        {"render_scale", 0},
        {"lumel_budget", nullptr},
        {"budget_bias", 0},
        {"level_bias", 0},
        {"level_offset", 0},
        {"anisotropy", 0},
        {"error_rmse", nullptr},
        {"flicker_rmse", nullptr},
        {"change_rmse", nullptr}};
    const json summary = {
        {"mean_ms", 0},          {"p50_ms", 0}, {"p95_ms", 0},           {"p99_ms", 0},
        {"max_ms", 0},           {"missed", 0}, {"error_rmse", nullptr}, {"flicker_rmse", nullptr},
        {"change_rmse", nullptr}};
    return {{"schema", 0},
            {"version", ""},
            {"device", ""},
            {"driver", ""},
            {"size", {0}},
            {"scene", ""},
            {"shading", ""},
            {"filter", ""},
            {"options", {{"*", ""}}},
            {"objects", json::array({{{"name", ""}, {"mode", ""}, {"level", nullptr}, {"pixels", 0}}})},
            {"lumels_by_tile_size", {{"*", 0}}},
            {"frames", json::array({frame})},
            {"summary", summary}};
}

// What --floors adds.
json formOfFloors()
{
    json passes;
    for (const char* pass : kPassNames)
        passes[pass] = {{"ms", 0}, {"unit", ""}, {"ns", nullptr}, {"floor_ns", nullptr}, {"ratio", nullptr}};
    return {{"pixels", 0},
            {"overhead_share", 0},
            {"lumels_per_pixel", nullptr},
            {"floor_ns", {{"*", 0}}},
            {"passes", passes}};
}

} // namespace

void expectRunOfSchema(const json& run, bool floors)
{
    json form = formOfRun();
    if (floors)
        form["floors"] = formOfFloors();
    expectLike(run, form, "run");
    EXPECT_EQ(run.at("schema"), 1);
    EXPECT_EQ(run.at("size").size(), 2u);
    EXPECT_FALSE(run.at("frames").empty());
    const json& summary = run.at("summary");
    double sum = 0.0, most = 0.0;
    for (const json& frame : run.at("frames")) {
        EXPECT_GT(frame.at("ms"), 0.0);
        sum += frame.at("ms").get<double>();
        most = std::max(most, frame.at("ms").get<double>());
        const json& lumels = frame.at("lumels");
        EXPECT_EQ(lumels.at("lit").get<int>() + lumels.at("derived").get<int>() +
                      lumels.at("kept").get<int>(),
                  lumels.at("marked").get<int>());
    }
    EXPECT_NEAR(summary.at("mean_ms"), sum / double(run.at("frames").size()), 1e-9 * sum);
    EXPECT_EQ(summary.at("max_ms"), most);
    EXPECT_LE(summary.at("p50_ms"), summary.at("p95_ms"));
    EXPECT_LE(summary.at("p95_ms"), summary.at("p99_ms"));
    EXPECT_LE(summary.at("p99_ms"), summary.at("max_ms"));
}

std::set<std::string> fieldNames(const json& document)
{
    std::set<std::string> names;
    if (document.is_object()) {
        for (const auto& [name, part] : document.items()) {
            names.insert(name);
            if (name != "options" && name != "lumels_by_tile_size")
                names.merge(fieldNames(part));
        }
    } else if (document.is_array()) {
        for (const json& element : document)
            names.merge(fieldNames(element));
    }
    return names;
}

} // namespace lumel::cli
