// Ten turned pieces, of the kinds that stand on boards and shelves.
#pragma once
#include "geometry.h"
#include <array>

namespace lumel::assets {

using Outline = std::vector<glm::vec2>;
struct Piece {
    const char* name;
    Outline outline;
};

inline constexpr size_t kPieceCount = 10;
extern const std::array<Piece, kPieceCount> kPieces; // the first is a ball

// Distance from the middle of a piece's map to its foot, in units of the map's width.
inline constexpr float kUvRadius = 0.49f;

// `steps` between two points of the outline, `segments` around.
Shape turnedPiece(const Outline& outline, int steps = 3, int segments = 40);

} // namespace lumel::assets
