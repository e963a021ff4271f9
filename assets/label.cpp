#include "label.h"
#include "core/math.h"
#include "maps.h"
#include <array>
#include <cmath>
#include <string_view>

namespace lumel::assets {
namespace {

// Strokes of a letter on a grid of 6 x 9, two digits per point (x, y down), strokes separated by blanks.
std::string_view strokesOf(char letter)
{
    switch (letter) {
    case 'A':
        return "0903306369 0666";
    case 'D':
        return "00406267490900";
    case 'E':
        return "60000969 0454";
    case 'F':
        return "600009 0454";
    case 'G':
        return "61402002072949676535";
    case 'H':
        return "0009 6069 0464";
    case 'I':
        return "3039";
    case 'L':
        return "000969";
    case 'M':
        return "0900356069";
    case 'P':
        return "09005061635404";
    case 'R':
        return "09005061634404 3469";
    case 'S':
        return "615010010314546568591908";
    case 'T':
        return "0060 3039";
    case 'U':
        return "000729496760";
    case '3':
        return "006034446567492907";
    default:
        return "";
    }
}

float distanceToSegment(glm::vec2 p, glm::vec2 a, glm::vec2 b)
{
    const glm::vec2 ab = b - a;
    const float t = glm::clamp(glm::dot(p - a, ab) / glm::dot(ab, ab), 0.0f, 1.0f);
    return glm::length(p - a - t * ab);
}

// A centred line of text; lengths in mm.
struct Line {
    std::string_view text;
    float top, letterHeight, advance, stroke;
};

// Signed distance from p to the ink, negative inside.
float distanceToText(glm::vec2 p, const Line& line)
{
    const float unit = line.letterHeight / 9.0f;
    float nearest = 1e9f;
    if (p.y < line.top - 2.0f || p.y > line.top + line.letterHeight + 2.0f)
        return nearest;
    const float width = line.advance * float(line.text.size() - 1) + 6.0f * unit;
    for (size_t i = 0; i < line.text.size(); ++i) {
        const glm::vec2 origin(-0.5f * width + line.advance * float(i), line.top);
        const std::string_view strokes = strokesOf(line.text[i]);
        for (size_t k = 0; k + 3 < strokes.size(); k += 2) {
            if (strokes[k] == ' ')
                ++k;
            if (k + 3 >= strokes.size() || strokes[k + 2] == ' ')
                continue;
            const glm::vec2 a(strokes[k] - '0', strokes[k + 1] - '0');
            const glm::vec2 b(strokes[k + 2] - '0', strokes[k + 3] - '0');
            nearest = std::min(nearest, distanceToSegment(p, origin + unit * a, origin + unit * b));
        }
    }
    return nearest - 0.5f * line.stroke;
}

glm::vec3 hex(uint32_t srgb)
{
    const auto channel = [&](int shift) { return srgbToLinear(float((srgb >> shift) & 255) / 255.0f); };
    return {channel(16), channel(8), channel(0)};
}

// Lays `ink` over `paper` where the signed distance is negative, over a border of `texel` mm.
glm::vec3 over(glm::vec3 paper, glm::vec3 ink, float distance, float texel)
{
    return glm::mix(paper, ink, glm::clamp(0.5f - distance / texel, 0.0f, 1.0f));
}

constexpr float kHorizon = 7.0f; // mm below the hole

glm::vec3 sky(glm::vec2 p, float texel)
{
    constexpr std::array<uint32_t, 6> kBands{0x3d1f47, 0x8c2f45, 0xc8442f, 0xe57b2d, 0xf2b441, 0xf9e3b0};
    constexpr std::array<float, 6> kRadii{60.0f, 44.0f, 36.0f, 28.0f, 20.5f, 13.0f}; // mm around the sun
    const float r = glm::length(p - glm::vec2(0.0f, kHorizon));
    glm::vec3 colour = hex(kBands[0]);
    for (size_t i = 1; i < kBands.size(); ++i)
        colour = over(colour, hex(kBands[i]), r - kRadii[i], texel);
    return colour;
}

glm::vec3 water(glm::vec2 p, float texel)
{
    glm::vec3 colour = hex(0x12303c);
    // The sun's reflection: bars that get thinner and narrower with depth.
    constexpr std::array<uint32_t, 4> kBars{0xf9e3b0, 0xf2b441, 0xe57b2d, 0xc8442f};
    for (size_t i = 0; i < kBars.size(); ++i) {
        const float y = kHorizon + 1.5f + 2.1f * float(i),
                    halfWidth = 13.0f + 3.5f * float(i % 2) - 2.2f * float(i);
        const float bar = distanceToSegment(p, {-halfWidth, y}, {halfWidth, y}) - (0.62f - 0.09f * float(i));
        colour = over(colour, hex(kBars[i]), bar, texel);
    }
    return colour;
}

} // namespace

Image makeLabel(int size)
{
    const float texel = kLabelMapWidth / float(size); // mm
    constexpr std::array<Line, 4> kLines{{{"LUMEL", 18.5f, 9.5f, 9.6f, 1.7f},
                                          {"FIRST LIGHT", 31.4f, 2.7f, 3.0f, 0.42f},
                                          {"33 RPM", 36.2f, 2.2f, 2.5f, 0.34f},
                                          {"SIDE A", 40.2f, 2.2f, 2.5f, 0.34f}}};
    return makeColour(size, [=](glm::vec2 at) {
        const glm::vec2 p = at * texel - 0.5f * kLabelMapWidth; // mm from the hole, y down
        const glm::vec3 cream = hex(0xf9e3b0);
        glm::vec3 colour = over(sky(p, texel), water(p, texel), kHorizon - p.y, texel);
        for (const Line& line : kLines)
            colour = over(colour, cream, distanceToText(p, line), texel);
        const float r = glm::length(p);
        colour = over(colour, cream, std::abs(r - 47.3f) - 0.35f, texel);
        colour = over(colour, hex(0x12303c), 47.65f - r, texel); // the rim
        return colour;
    });
}

} // namespace lumel::assets
