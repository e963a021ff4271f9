// Frame results: statistics, the picture, what was done with each object.
#include "frame.h"
#include <spdlog/spdlog.h>

namespace lumel {

// Of a frame in texture space that has finished.
void Renderer::countLumels(InFlight& own)
{
    FrameStats& stats = own.stats;
    if (!own.planned) { // settled
        stats.lumelsKept = known_.lumelsMarked;
    } else {
        const shared::Plan& plan = lastPlan_ = plan_.read(own.place);
        if (plan.dropped > 0)
            spdlog::error("{} entries exceeded the tile lists; report this", plan.dropped);
        const auto lumels = [](uint32_t quads) { return size_t(quads) * shared::kQuadLumels; };
        known_.lumelsMarked = lumels(plan.quadsMarked);
        known_.tilesMarked = own.tilesMarked = plan.marked;
        stats.lumelsLit = lumels(plan.quadsLit);
        stats.lumelsDerived = lumels(plan.quadsDerived);
        stats.lumelsPending = own.lumelsPending = lumels(plan.quadsPending);
        stats.tilesLit = plan.tilesLit;
        stats.lumelsKept =
            known_.lumelsMarked - std::min(known_.lumelsMarked, stats.lumelsLit + stats.lumelsDerived);
    }
    stats.lumelsMarked = known_.lumelsMarked;
    stats.tilesMarked = known_.tilesMarked;
}

// Of a frame that is recorded.
void Renderer::countFrame(const Frame& frame, InFlight& own)
{
    own.place = frame.place;
    own.frame = frame.index;
    own.late = frame.late;
    own.planned = !frame.feedback.empty();
    own.sampled = own.planned && sampled_;
    own.unread = true;
    lastPlanned_ = own.planned ? frame.index : lastPlanned_;
    own.divisor = feedback_.divisor();
    own.quality = quality_;
    own.dynamicInView = dynamicInView_;
    FrameStats& stats = own.stats;
    if (settings_.shading == Shading::tsl) {
        stats.pixelsCovered = known_.pixelsCovered;
        stats.levelBias = residency_.levelBias();
        stats.levelOffset = detail_ ? detail_->levelOffset : 0.0f;
        stats.anisotropy = detail_ ? detail_->anisotropy : 1.0f;
    }
    stats.exposure = settings_.exposure;
    stats.renderScale = quality_.renderScale;
    stats.budgetBias = quality_.levelBias;
    stats.lumelBudget = frame.lumelBudget;
    stats.poolUsedBytes = pool_.bookkeeping().usedBytes();
    stats.surfaceBytes = plan_.surfaces().bytes();
    stats.poolCapBytes = pool_.bookkeeping().capBytes();
    stats.memory = device_.memory().report();
    stats.poolTextures = pool_.bookkeeping().textureCount();
    for (size_t i = 0; i < frame.inView.size(); ++i) {
        const bool lit = i < residency_.objects().size() && residency_.objects()[i].texture;
        ++(frame.inView[i] ? (lit ? stats.objectsTsl : stats.objectsForward) : stats.objectsCulled);
    }
}

std::vector<ObjectStats> Renderer::objectStats() const
{
    std::vector<ObjectStats> objects(inView_.size());
    for (size_t i = 0; i < objects.size(); ++i) {
        const bool lit = i < residency_.objects().size() && residency_.objects()[i].texture;
        objects[i].mode = !inView_[i] ? "culled" : lit ? "tsl" : "forward";
        if (i >= knownFeedback_.size() || !knownFeedback_[i].visible)
            continue;
        objects[i].level = knownFeedback_[i].level;
        objects[i].pixels = size_t(knownFeedback_[i].samples) * knownDivisor_ * knownDivisor_;
    }
    return objects;
}

std::map<uint32_t, size_t> Renderer::lumelsByTileSize()
{
    finish();
    if (settings_.shading != Shading::tsl)
        return {};
    return plan_.lumelsByTileSize(device_, lastPlan_);
}

Image Renderer::readRadiance() const
{
    const bool reference = settings_.shading == Shading::reference;
    const gpu::Image& source = reference ? targets_.sum : targets_.hdr;
    const auto bytes =
        gpu::readBack(device_, source, reference ? 16 : 8, gpu::masksOf(gpu::Use::transferRead).layout);
    const size_t pixels = size_t(settings_.size.x) * settings_.size.y;
    std::vector<float> rgba(pixels * 4);
    if (reference)
        std::memcpy(rgba.data(), bytes.data(), bytes.size());
    else
        halfToFloats({reinterpret_cast<const uint16_t*>(bytes.data()), pixels * 4}, rgba.data());
    Image image(int(settings_.size.x), int(settings_.size.y), 3);
    const float weight = reference ? 1.0f / float(sumSamples_) : 1.0f;
    for (size_t i = 0; i < pixels; ++i)
        for (size_t c = 0; c < 3; ++c)
            image.pixels[i * 3 + c] = rgba[i * 4 + c] * weight;
    if (renderSize_ == settings_.size)
        return image;
    Image part(int(renderSize_.x), int(renderSize_.y), 3);
    for (int y = 0; y < part.height; ++y)
        std::copy_n(image.at(0, y), 3 * part.width, part.at(0, y));
    return upscaled(part, image.width, image.height);
}

Image Renderer::readDisplay() const
{
    const auto bytes =
        gpu::readBack(device_, targets_.display, 4, gpu::masksOf(gpu::Use::transferRead).layout);
    Image image(int(settings_.size.x), int(settings_.size.y), 3);
    for (size_t i = 0; i < image.pixels.size() / 3; ++i)
        for (size_t c = 0; c < 3; ++c)
            image.pixels[i * 3 + c] = float(bytes[i * 4 + c]) / 255.0f;
    return image;
}

} // namespace lumel
