// Validation messages that are expected here.
#pragma once
#include <string_view>

namespace lumel::gpu {

// id: the layer's name of the message, as in "BestPractices-...".
bool isExpected(std::string_view id, std::string_view text);

} // namespace lumel::gpu
