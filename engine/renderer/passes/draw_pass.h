// Draw: objects with a lit texture sample it; the others are shaded forward; blended ones last, back to
// front.
#pragma once
#include "lit_pool.h"

namespace lumel {

class DrawPass {
public:
    // Begins to make all pipelines that frames of these settings can need, with the lights' kFeature...
    void prepare(const Frame& frame, const LitPool& pool, uint32_t lights);
    // Those of texture space in which objects fade, which no first frame needs.
    void prepareFades(const Frame& frame, const LitPool& pool, uint32_t lights);
    void record(Frame& frame, const LitPool& pool);
    static void begin(Frame& frame);                             // to draw into the cleared targets
    static std::vector<size_t> nearestFirst(const Frame& frame); // objects in view

private:
    enum class Kind { lit, forward, blended, background, view, pool };
    // Made when first needed and kept: settings change back and forth.
    const gpu::Pipeline& pipeline(const Frame& frame, const LitPool& pool, Kind kind, uint32_t features = 0);
    void drawObjects(Frame& frame, const LitPool& pool);
    void drawLit(Frame& frame, const LitPool& pool, size_t object);
    // opacity < 1: over what is there.
    void drawForward(Frame& frame, const LitPool& pool, size_t object, float opacity);
    void drawBackground(Frame& frame, const LitPool& pool);
    void drawView(Frame& frame, const LitPool& pool, size_t object);
    void drawPool(Frame& frame, const LitPool& pool); // every texture, side by side
    // By multisampling, features, filter and anisotropy.
    std::map<std::tuple<Kind, bool, uint32_t, uint32_t, uint32_t>, gpu::Pipeline> pipelines_;
};

} // namespace lumel
