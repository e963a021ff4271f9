// What commands and panels call the settings' values: one list each, in the order of its enum.
#pragma once
#include "settings.h"
#include <array>

namespace lumel {

inline constexpr std::array kShadingNames{"tsl", "forward", "reference"};
inline constexpr std::array kFilterNames{"fit",     "average", "flat",     "height",
                                         "toksvig", "lean",    "fit-power"}; // Method
inline constexpr std::array kModelNames{"blinn-phong", "ashikhmin-shirley"}; // Model
inline constexpr std::array kLobeNames{"1", "2", "auto"};                    // LobeCount
inline constexpr std::array kDrawFilterNames{"bilinear", "b-spline", "catmull-rom", "catmull-rom-16",
                                             "quadratic"};
inline constexpr std::array kToneMapNames{"neutral", "aces", "clamp"};
inline constexpr std::array kResidencyNames{"exact", "latest"};
inline constexpr std::array kViewNames{"none",   "level",       "age",   "lit",        "density", "mode",
                                       "charts", "normal",      "power", "anisotropy", "diffuse", "specular",
                                       "error",  "overshading", "pool",  "lobes"};

} // namespace lumel
