// Draws of one pipeline that differ in the object only: one call where they share buffers and culling and the
// device draws several at a time, else one each. Shaders have the object from gl_InstanceIndex, and must not
// use gl_VertexIndex.
#pragma once
#include "frame_context.h"

namespace lumel {

class DrawList {
public:
    DrawList(const gpu::Device& device, size_t objects);
    // Outside of rendering: the objects to draw, in this order. What was to be drawn before has been
    // recorded.
    void write(Frame& frame, std::vector<uint32_t> objects);
    // With the bound pipeline.
    void draw(Frame& frame) const;

private:
    uint32_t most_; // draws a call
    std::vector<uint32_t> objects_;
    gpu::Buffer commands_;
};

} // namespace lumel
