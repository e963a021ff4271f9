#include "expected_messages.h"
#include <algorithm>

namespace lumel::gpu {
namespace {

struct Expected {
    std::string_view id;   // begins like this
    std::string_view text; // contains this
};

constexpr Expected kExpected[] = {
    // The layer says which settings it got, and which features and limits it takes for its own checks.
    {"VALIDATION-SETTINGS", ""},
    {"WARNING-Setting-Limit-Adjusted", ""},
    // Every buffer and image has memory of its own. That wastes some; Device::allocate sees to it that there
    // are not too many.
    {"BestPractices-vkBindBufferMemory-small-dedicated-allocation", ""},
    {"BestPractices-vkBindImageMemory-small-dedicated-allocation", ""},
    // Lit textures stay in the general layout: light, lower, copies and draw take turns on parts of one
    // image.
    {"UNASSIGNED-CoreValidation-DrawState-InvalidImageLayout", "For optimal performance"},
};

} // namespace

bool isExpected(std::string_view id, std::string_view text)
{
    return std::ranges::any_of(kExpected, [&](const Expected& e) {
        return id.substr(0, e.id.size()) == e.id && text.find(e.text) != std::string_view::npos;
    });
}

} // namespace lumel::gpu
