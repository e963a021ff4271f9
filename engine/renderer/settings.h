// What a frame is rendered with. setting_table.h describes every field: option, panel, what a change
// invalidates.
#pragma once
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>

namespace lumel {

enum class ToneMap { neutral, aces, clamp }; // same order as kToneMap...
enum class Shading { tsl, forward, reference };
enum class DrawFilter {
    bilinear,
    bspline,
    catmullRom,
    catmullRomExact,
    quadratic
}; // same order as kFilter...

// Whose feedback decides which lit texture each object draws: the frame's own, which is waited for, or that
// of the latest frame that is known to have finished.
enum class ResidencyFrom { exact, latest };

// What is shown in place of the picture; same order as kView...
enum class View {
    none,
    level,
    age,
    lit,
    density,
    mode,
    charts,
    normal,
    power,
    anisotropy,
    diffuse,
    specular,
    error,
    overshading,
    pool,
    lobes
};

struct Settings {
    View view = View::none;
    Shading shading = Shading::tsl;
    glm::uvec2 size{960, 540};
    DrawFilter filter = DrawFilter::quadratic;
    float anisotropy = 8.0f;   // most taps along a footprint's major axis when drawing lit textures
    int forwardAnisotropy = 1; // the same of forward shading's material lookups; 1 = isotropic
    int msaa = 1;              // coverage samples of tsl and forward: 1 or 4
    bool edgeFilter = true;    // edges between objects are smoothed after drawing, where msaa is 1
    int samples = 64;          // reference: jittered frames per picture
    bool shadows = true;
    uint32_t shadowSize = 2048; // texels along a side of each map
    float environmentIntensity = 1.0f;
    float environmentRotation = 0.0f; // degrees about +Y
    // Radiance of a uniform sky, and a third of it from the ground, beside the environment. Nothing: 4 %
    // of the brightest sun's illuminance where there is no environment, else 0.
    std::optional<float> ambient;
    float exposure = 1.0f;
    ToneMap toneMap = ToneMap::neutral;
    size_t poolBytes = size_t(512) << 20;
    float levelOffset = 0.2f;        // levels that lumels are coarser than one per pixel, at least
    float lumelsPerPixel = 2.8f;     // grazing angles lose detail before a view needs more
    uint32_t lumelBudget = ~0u;      // lit per frame at most, by quads
    float refreshShare = 0.155f;     // of the marked lumels, lit again per frame because the eye moved
    float tolerance = 0.5f / 255.0f; // display value: tiles expected to change less are kept
    double budgetMs = 0.0;           // to hold a frame's time within; 0 = none
    ResidencyFrom residency = ResidencyFrom::exact;
    uint32_t framesInFlight = 2; // that the CPU is ahead of the device at most, where residency is not exact
};

} // namespace lumel
