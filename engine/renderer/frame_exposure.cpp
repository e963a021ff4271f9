// How bright is the view? A small picture of it is drawn and its luminances are counted.
#include "frame.h"

namespace lumel {

// Forward at one sample per pixel, whatever the renderer's own shading, size and display: so all of them
// agree on a view's exposure, and it is known before anything is lit.
LuminanceHistogram Renderer::meter(const scene::Camera& camera)
{
    constexpr float kLongerSide = 256.0f; // pixels
    Settings settings = settings_;
    settings.shading = Shading::forward;
    settings.view = View::none;
    settings.msaa = 1;
    settings.edgeFilter = false; // alpha is to be the share that is covered
    settings.budgetMs = 0.0;
    const glm::vec2 size(settings_.size);
    settings.size =
        glm::max(glm::uvec2(glm::round(size * std::min(1.0f, kLongerSide / std::max(size.x, size.y)))), 1u);
    if (!meter_)
        meter_ = std::make_unique<MeterPass>(device_, scene_);
    Targets targets(device_, settings);
    learnAll();
    Frame frame = makeFrame(camera, settings, targets, frameIndex_ + 1);
    writeView(frame);
    begin(frame);
    deform_.record(frame);
    shadow_.record(frame);
    draw_.record(frame, pool_);
    meter_->record(frame);
    submit(frame);
    ring_.wait(own().submission);
    return meter_->read();
}

} // namespace lumel
