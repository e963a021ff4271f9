// Dynamic objects: those whose light changes frame after frame, because they or lights that reach them move.
// What is lit in texture space of them serves one frame only.
#pragma once
#include <cstddef>
#include <vector>

namespace lumel::tsl {

class DynamicObjects {
public:
    // Once a frame for each object in view: has it moved, or a light that reaches it?
    void note(size_t object, bool changed);
    // More than half of the last dozen frames changed it; until hardly any does.
    bool is(size_t object) const { return object < objects_.size() && objects_[object].dynamic; }

private:
    struct Object {
        float share = 0.0f; // of the frames, recent ones count more
        bool dynamic = false;
    };
    std::vector<Object> objects_;
};

} // namespace lumel::tsl
