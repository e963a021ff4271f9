// Residency: which lit texture each visible object draws this frame, at which level, and which objects are so
// small, or whose light changes so often, that shading them forward is as good.
#pragma once
#include "texture_pool.h"
#include <span>

namespace lumel::tsl {

// What the feedback pass found of one object, and its lumel grid.
struct ObjectFeedback {
    bool inView = false;                        // its bounds meet the view volume
    bool visible = false;                       // a sample saw it
    bool lightable = true;                      // unique UVs, opaque
    float level = 0.0f;                         // finest level that any sample needs
    uint32_t samples = 0;                       // of the feedback pass that saw it
    float coarsest = float(shared::kMaxLevels); // level from which its charts run into each other
    glm::uvec2 litSize{0};                      // lumels of level 0
    bool dynamic = false;                       // its light changes too often to be worth lumels
};

struct ObjectResidency {
    TextureId texture;     // none: drawn forward
    uint32_t litLevel = 0; // the level lit into its MIP 0
    bool fresh = false;    // new to the object in this frame: holds nothing of it
    TextureId previous;    // fresh: whose lumels of equal levels can be taken over, none if there is none
    float finest = 0.0f;   // least MIP drawn: a texture that became finer fades in
    float share = 0.0f;    // of the lit texture in the picture; the rest is shaded forward
};

// The level whose lumels are lit for an object that needs `level`: the finer of the two that drawing blends,
// never past a single tile.
uint32_t litLevelFor(float level, glm::uvec2 litSize);

// An object leaves texture space when its lit texture has become smaller than kLeave lumels across, and
// returns when it would exceed kReturn.
inline constexpr float kLeave = 6.0f, kReturn = 9.0f;
// Likewise when it needs a level so much coarser than ObjectFeedback::coarsest: drawing blends in the next
// level's seams from three quarters of a level on, fully from one.
inline constexpr float kLeaveLevel = 0.75f, kReturnLevel = 0.5f;
// A texture that is one level finer than needed is kept until the required level is this much coarser still.
inline constexpr float kLevelHysteresis = 0.25f;

class Residency {
public:
    // Allocates textures for all. When the cap binds, all objects move coarser together, by eighths of a
    // level; one that still does not fit takes a coarser texture, and is drawn forward if there is none.
    // late: the feedback is of an earlier frame. Objects that are seen by then have been drawn forward since,
    // unless the pool still has a texture of theirs.
    void assign(TexturePool& pool, std::span<const ObjectFeedback> feedback, uint64_t frame,
                bool late = false);

    const std::vector<ObjectResidency>& objects() const { return objects_; }
    float levelBias() const { return levelBias_; } // levels that everything gave up because the cap binds
    bool steady() const { return steady_; }        // nothing fades
    bool anyFresh() const;                         // an object has got a texture

private:
    void assignObject(TexturePool& pool, const ObjectFeedback& feedback, size_t object, uint64_t frame);
    void enter(TexturePool& pool, const ObjectFeedback& feedback, size_t object, uint64_t frame);
    void take(TexturePool& pool, const ObjectFeedback& feedback, size_t object, uint64_t frame);
    std::vector<ObjectResidency> objects_;
    // kEntered: drawn, by what there was, before it was known how; kSeen: by what a sample saw of it. Changes
    // fade in either case.
    enum Known : uint8_t { kUnknown, kEntered, kSeen };
    std::vector<Known> known_;
    float levelBias_ = 0.0f;
    bool steady_ = false;
    bool late_ = false;
};

} // namespace lumel::tsl
