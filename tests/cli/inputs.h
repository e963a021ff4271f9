// Small generated inputs.
#pragma once
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace lumel::cli {

// An uneven relief as an 8-bit PNG.
void writeHeightMap(const std::filesystem::path& file, int width, int height);

// One textured square, 2 m wide, facing +Z, with its buffer beside it (<stem>.bin).
nlohmann::json squareScene(const std::filesystem::path& gltf);
// Moves a node of such a scene from a place to another in two seconds; the keys go into <stem>.bin.
void addMotion(nlohmann::json& document, const std::filesystem::path& gltf, int node,
               std::array<float, 3> from, std::array<float, 3> to);
// A light of squareScene()'s own (KHR_lights_punctual): an oblique sun, or a lamp 2 m in front of the square.
void addLight(nlohmann::json& document, const char* type, float intensity);

void writeScene(const std::filesystem::path& gltf, const nlohmann::json& document);

} // namespace lumel::cli
