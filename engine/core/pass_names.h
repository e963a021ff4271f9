// The passes of a frame, in order. Timers, statistics, CSV and panels all take their rows from here.
#pragma once
#include <array>
#include <stdexcept>
#include <string_view>

namespace lumel {

inline constexpr std::array kPassNames{"deform", "shadow", "feedback", "plan",
                                       "light",  "lower",  "draw",     "display"};

// A name of that list, or of the exposure's metering, which is no part of a frame: any other fails to
// compile.
struct PassName {
    consteval PassName(const char* name) : text(name)
    {
        bool known = std::string_view(name) == "meter";
        for (const std::string_view pass : kPassNames)
            known = known || pass == name;
        if (!known)
            throw std::invalid_argument("add the pass to kPassNames");
    }
    const char* text;
};

} // namespace lumel
