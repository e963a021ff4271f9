// Deform: where joints and morph targets move vertices, once a frame for all that reads them. What has not
// moved since it last was in view or cast a shadow keeps its vertices.
#pragma once
#include "frame_context.h"

namespace lumel {

class DeformPass {
public:
    void prepare(const Frame& frame); // begins to make its pipeline, for a scene that needs it
    void record(Frame& frame);

private:
    gpu::Pipeline pipeline_;
};

} // namespace lumel
