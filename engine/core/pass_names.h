// The passes of a frame, in order. Timers, statistics, CSV and panels all take their rows from here.
#pragma once
#include <array>
#include <stdexcept>
#include <string_view>

namespace lumel {

inline constexpr std::array kPassNames{"deform", "shadow", "feedback", "plan",
                                       "light",  "lower",  "draw",     "display"};

// The least that passes could take, measured beside them (FloorPass): of the passes of these names, and of
// draw in texture space (with one bilinear lookup, bicubic on one and on two levels) and forward.
inline constexpr std::array kFloorNames{"feedback",           "light",  "lower", "bilinear", "bicubic",
                                        "bicubic_two_levels", "forward"};

// A name of these lists, or of the exposure's metering, which is no part of a frame: any other fails to
// compile.
struct PassName {
    consteval PassName(const char* name) : text(name)
    {
        bool known = std::string_view(name) == "meter";
        for (const std::string_view pass : kPassNames)
            known = known || pass == name;
        for (const std::string_view floor : kFloorNames)
            known = known || floor == name;
        if (!known)
            throw std::invalid_argument("add the pass to kPassNames");
    }
    const char* text;
};

} // namespace lumel
