#include "dynamic_objects.h"

namespace lumel::tsl {
namespace {

constexpr float kMemory = 1.0f / 12.0f; // weight of the newest frame
constexpr float kBecomes = 0.5f, kCeases = 0.1f;

} // namespace

void DynamicObjects::note(size_t object, bool changed)
{
    if (object >= objects_.size())
        objects_.resize(object + 1);
    Object& o = objects_[object];
    o.share += kMemory * ((changed ? 1.0f : 0.0f) - o.share);
    o.dynamic = o.share > (o.dynamic ? kCeases : kBecomes);
}

} // namespace lumel::tsl
