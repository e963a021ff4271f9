// What would the last frame's passes take at the very least?
#include "frame.h"

namespace lumel {

FloorStats Renderer::measureFloors(const scene::Camera& camera)
{
    learnAll();
    const bool first = !floors_;
    if (first)
        floors_ = std::make_unique<FloorPass>(device_, scene_, settings_);
    Frame frame = makeFrame(camera, settings_, floors_->targets(), frameIndex_);
    frame.renderSize = renderSize_;
    const auto run = [&](size_t lumelsLit, size_t lumelsDerived) {
        begin(frame);
        floors_->record(frame, pool_, lumelsLit, lumelsDerived);
        submit(frame);
        ring_.wait(own().submission);
    };
    if (first)
        run(~size_t(0), ~size_t(0)); // compiles, and fills the textures
    run(last_.lumelsLit, last_.lumelsDerived);
    return floors_->read(device_, own().timer);
}

} // namespace lumel
