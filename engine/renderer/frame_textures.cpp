// Texture space: whether a view needs anything, how finely it is lit, and which textures its objects get.
#include "frame.h"

namespace lumel {

// Neither the view nor what it shows has changed since the frame before.
bool Renderer::isStill(const Frame& frame) const
{
    return frame.clipFromWorld == knownView_ && quality_.samePicture(knownQuality_) &&
           scene_.changed() <= knownChange_;
}

// Nothing to find, to light or to fade: every pixel of the still view was looked at.
bool Renderer::isSettled(const Frame& frame) const
{
    return isStill(frame) && offsetsSeen_ >= FeedbackPass::kCycle && lumelsPending_ == 0 &&
           residency_.steady();
}

// Of the feedback pass, in pixels.
uint32_t Renderer::sampleSpacing(const Frame& frame) const
{
    const bool moves = frame.clipFromWorld != knownView_, changes = scene_.changed() > knownChange_;
    // What changes in a view at rest is lit again at once, all that any pixel reads.
    const bool rested = !moves && knownChange_ + 1 < frame.index;
    if (first_ || (changes && rested))
        return 1;
    // Where a frame budget has to save pixels, it saves samples too.
    return moves && (!changes || !quality_.samePicture({})) ? FeedbackPass::kSparse : FeedbackPass::kDense;
}

// This frame's, waited for.
void Renderer::findFeedback(Frame& frame, uint32_t spacing)
{
    const auto read = [&] {
        latest_ = feedback_.read(frame.place);
        latest_.frame = frame.index;
        latest_.divisor = spacing;
    };
    feedback_.record(frame, spacing);
    submitAndWait(frame);
    read();
    if (!chooseDetail(frame))
        return;
    feedback_.recount(frame); // the same samples once more, at that detail
    submitAndWait(frame);
    read();
}

// How finely is the view to be lit? Known levels are those of the frame before's detail, which changes
// slowly: only after the first detail of all are the samples to be counted once more. Then true.
bool Renderer::chooseDetail(Frame& frame)
{
    float pixels = 0.0f;
    for (size_t i = 0; i < latest_.objects.size(); ++i)
        pixels += scene_.objects()[i].texelMap ? float(latest_.objects[i].samples) : 0.0f;
    const tsl::Detail finest{settings_.levelOffset, settings_.anisotropy};
    const bool first = !detail_;
    detail_ = tsl::detailFor(latest_.elongations, pixels, finest, settings_.lumelsPerPixel, detail_);
    frame.detail = *detail_;
    frame.detail.levelOffset += quality_.levelBias;
    writeView(frame);
    return first && *detail_ != finest;
}

// Of the surface cache, for the tiles that the latest known view needs: as many of them have two lobes as
// pixels do.
size_t Renderer::surfacePages(const Frame& frame) const
{
    double pages = 0.0, samples = 0.0;
    for (size_t i = 0; i < frame.feedback.size(); ++i) {
        const GpuObject& object = scene_.objects()[i];
        const double seen = object.texelMap ? frame.feedback[i].samples : 0.0;
        samples += seen;
        pages += seen * shared::surfacePages(object.data.flags);
    }
    return size_t(double(tilesMarked_) * (samples > 0.0 ? pages / samples : shared::kSurfaceWords));
}

void Renderer::assignTextures(Frame& frame, uint32_t spacing)
{
    for (tsl::ObjectFeedback& object : frame.feedback) {
        object.level += frame.detail.levelOffset;
        object.coarsest += quality_.levelBias; // within a frame budget, seams are the lesser evil
    }
    for (size_t i = 0; quality_.dynamicPerPixel && i < frame.feedback.size(); ++i)
        frame.feedback[i].dynamic = dynamicObjects_.is(i);
    // Under the memory cap textures in view come first, then cached surfaces, then textures out of view.
    tsl::TexturePool& textures = pool_.bookkeeping();
    const size_t pages = surfacePages(frame);
    textures.leaveFree(std::min(SurfaceCache::roomFor(pages), textures.capBytes() / 2));
    residency_.assign(textures, frame.feedback, frame.index, frame.late);
    plan_.surfaces().reserve(ring_, pages,
                             textures.capBytes() - std::min(textures.usedBytes(), textures.capBytes()));
    pool_.update(ring_);
    plan_.prepare(frame, pool_);
    knownFeedback_ = frame.feedback;
    knownDivisor_ = latest_.divisor;
    known_.pixelsCovered = 0;
    for (size_t i = 0; i < frame.feedback.size(); ++i)
        if (residency_.objects()[i].texture)
            known_.pixelsCovered += frame.feedback[i].samples * latest_.divisor * latest_.divisor;
    noteOffsets(frame, spacing);
    knownView_ = frame.clipFromWorld;
    knownQuality_ = quality_;
    knownChange_ = frame.index;
}

// What changes once more is lit again where this frame's samples see it: the other offsets find the rest.
void Renderer::noteOffsets(const Frame& frame, uint32_t spacing)
{
    if (!isStill(frame))
        offsetsSeen_ = 0;
    if (frame.clipFromWorld != knownView_ || !quality_.samePicture(knownQuality_) ||
        scene_.moved() > knownChange_)
        seenSince_ = frame.index;
    // So are textures that are new, or of another view.
    if (frame.late && (latest_.frame < seenSince_ || residency_.anyFresh()))
        offsetsSeen_ = 0;
    offsetsSeen_ += spacing == 1 ? FeedbackPass::kCycle : spacing == FeedbackPass::kDense;
}

} // namespace lumel
