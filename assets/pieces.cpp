#include "pieces.h"

namespace lumel::assets {

// Outlines from the axis on top, outwards and down to the ground: (radius, height), about 1 m high.
const std::array<Piece, kPieceCount> kPieces{{
    {"ball",
     {{0, 1}, {0.25f, 0.93f}, {0.43f, 0.75f}, {0.5f, 0.5f}, {0.43f, 0.25f}, {0.25f, 0.07f}, {0.12f, 0}}},
    {"egg",
     {{0, 1.2f}, {0.18f, 1.12f}, {0.34f, 0.85f}, {0.42f, 0.5f}, {0.36f, 0.2f}, {0.22f, 0.04f}, {0.14f, 0}}},
    {"pawn",
     {{0, 1},
      {0.14f, 0.96f},
      {0.2f, 0.84f},
      {0.14f, 0.7f},
      {0.2f, 0.66f},
      {0.1f, 0.58f},
      {0.14f, 0.3f},
      {0.26f, 0.16f},
      {0.3f, 0.08f},
      {0.3f, 0}}},
    {"bishop",
     {{0, 1.5f},
      {0.05f, 1.46f},
      {0.05f, 1.4f},
      {0.17f, 1.2f},
      {0.15f, 1.05f},
      {0.1f, 0.98f},
      {0.2f, 0.94f},
      {0.1f, 0.86f},
      {0.13f, 0.4f},
      {0.28f, 0.2f},
      {0.32f, 0.1f},
      {0.32f, 0}}},
    {"vase",
     {{0, 0.86f},
      {0.1f, 0.87f},
      {0.16f, 1.0f},
      {0.2f, 1.0f},
      {0.13f, 0.85f},
      {0.3f, 0.66f},
      {0.38f, 0.45f},
      {0.28f, 0.18f},
      {0.18f, 0.05f},
      {0.2f, 0}}},
    {"bottle",
     {{0, 1.3f},
      {0.07f, 1.3f},
      {0.09f, 1.24f},
      {0.07f, 1.18f},
      {0.08f, 0.95f},
      {0.24f, 0.75f},
      {0.28f, 0.6f},
      {0.28f, 0.08f},
      {0.24f, 0}}},
    {"bell",
     {{0, 0.85f},
      {0.07f, 0.82f},
      {0.05f, 0.75f},
      {0.2f, 0.7f},
      {0.27f, 0.55f},
      {0.3f, 0.3f},
      {0.38f, 0.1f},
      {0.48f, 0}}},
    {"goblet",
     {{0, 0.7f},
      {0.12f, 0.74f},
      {0.24f, 0.98f},
      {0.27f, 1.0f},
      {0.26f, 0.8f},
      {0.16f, 0.62f},
      {0.05f, 0.5f},
      {0.08f, 0.42f},
      {0.05f, 0.3f},
      {0.12f, 0.08f},
      {0.26f, 0}}},
    {"urn",
     {{0, 1.1f},
      {0.05f, 1.06f},
      {0.04f, 1.0f},
      {0.2f, 0.94f},
      {0.33f, 0.9f},
      {0.3f, 0.82f},
      {0.42f, 0.62f},
      {0.36f, 0.36f},
      {0.14f, 0.2f},
      {0.13f, 0.14f},
      {0.28f, 0.06f},
      {0.28f, 0}}},
    {"cone",
     {{0, 1.6f},
      {0.06f, 1.55f},
      {0.2f, 1.0f},
      {0.34f, 0.3f},
      {0.36f, 0.2f},
      {0.44f, 0.14f},
      {0.46f, 0.06f},
      {0.44f, 0}}},
}};

namespace {

// Catmull-Rom through the outline's points; past its ends the curve continues straight.
glm::vec2 onOutline(const Outline& outline, float along)
{
    const int last = int(outline.size()) - 1, i = std::min(int(along), last - 1);
    const float t = along - float(i);
    const auto at = [&](int k) {
        if (k < 0)
            return glm::vec2(-outline[1].x, outline[1].y); // mirrored at the axis
        return k > last ? 2.0f * outline[size_t(last)] - outline[size_t(last) - 1] : outline[size_t(k)];
    };
    const glm::vec2 a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
    const glm::vec2 p =
        0.5f *
        (2.0f * b + t * (c - a + t * (2.0f * a - 5.0f * b + 4.0f * c - d + t * (3.0f * (b - c) + d - a))));
    return {std::max(p.x, 0.0f), p.y};
}

} // namespace

Shape turnedPiece(const Outline& outline, int steps, int segments)
{
    std::vector<ProfilePoint> profile;
    float length = 0.0f;
    const int count = steps * (int(outline.size()) - 1);
    for (int i = 0; i <= count; ++i) {
        const float along = float(i) / float(steps);
        const glm::vec2 p = onOutline(outline, along);
        const glm::vec2 after = onOutline(outline, std::min(along + 0.02f, float(count) / float(steps))),
                        before = onOutline(outline, std::max(along - 0.02f, 0.0f));
        const glm::vec2 forward = glm::normalize(after - before);
        if (i > 0)
            length += glm::distance(p, glm::vec2(profile.back().radius, profile.back().y));
        profile.push_back(
            {i == 0 ? 0.0f : p.x, p.y, i == 0 ? glm::vec2(0, 1) : glm::vec2(-forward.y, forward.x), length});
    }
    for (ProfilePoint& p : profile)
        p.uvRadius *= kUvRadius / length;
    return lathe(profile, segments);
}

} // namespace lumel::assets
