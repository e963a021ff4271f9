// One descriptor per setting, from which follow the command line's options, the viewer's widgets, 'copy as
// command', the options in the JSON, and what a renderer does again when a setting changes. A new setting is
// a field of Settings and an entry here.
#pragma once
#include "names.h"
#include <limits>
#include <span>
#include <tuple>

namespace lumel {

// What a change makes invalid.
namespace invalidates {
enum : unsigned {
    display = 1,   // the tone-mapped picture
    radiance = 2,  // what was drawn
    sum = 4,       // the reference's accumulated samples
    targets = 8,   // the images that passes render to, where the new settings take others (Targets::same)
    feedback = 16, // the feedback pass's images
    lumels = 32,   // what is known about the levels that a view needs
    pool = 64,     // all lit textures
    budget = 128   // what the frame budget's controller has learnt
};
}

// Ways of shading as bits.
constexpr unsigned shadingBit(Shading shading)
{
    return 1u << unsigned(shading);
}
inline constexpr unsigned kTslOnly = shadingBit(Shading::tsl);
inline constexpr unsigned kReferenceOnly = shadingBit(Shading::reference);
inline constexpr unsigned kRealTime = kTslOnly | shadingBit(Shading::forward); // all but the reference
inline constexpr unsigned kAllShadings = kRealTime | kReferenceOnly;

// Where the viewer shows a setting's widget; none: nowhere, or a widget of its own kind.
enum class Panel { none, picture, lumels, environment, lights };

struct Widget {
    Panel panel = Panel::none;
    const char* label = "";
    const char* format = "%.2f"; // of a slider's number
    float least = 0.0f, most = 1.0f;
    bool logarithmic = false;
    float scale = 1.0f; // the number shown is so many times the option's
};

template<class T>
struct Setting {
    T Settings::*member;
    const char* name; // of the option, without dashes
    const char* help;
    unsigned shadings = kAllShadings; // that it changes
    unsigned invalidates = invalidates::radiance;
    std::span<const char* const>
        values{};                      // the names of an enumeration, in its order; all that a number may be
    double least = 0.0, most = 0.0;    // else of a number, in the option's unit
    const char* word = nullptr;        // in place of a number ...
    T wordValue{};                     // ... for this value, which may lie outside the range
    const char* unit = "";             // of the option
    double memberPerUnit = 1.0;        // bytes per MiB
    const char* defaultText = nullptr; // where the default depends on the scene
    Widget widget{};
};

inline constexpr std::array kOffOn{"off", "on"};
inline constexpr std::array kSampleCounts{"1", "4"};

inline constexpr std::tuple kSettings{
    Setting<glm::uvec2>{.member = &Settings::size,
                        .name = "size",
                        .help = "size of the picture in pixels",
                        .invalidates = invalidates::radiance | invalidates::targets | invalidates::sum |
                                       invalidates::feedback | invalidates::lumels,
                        .least = 1,
                        .most = 8192},
    Setting<Shading>{
        .member = &Settings::shading,
        .name = "shading",
        .help = "tsl: texture-space lighting; forward: lighting per pixel; reference: forward at the "
                "finest MIP level, many samples per pixel",
        .invalidates = invalidates::radiance | invalidates::targets | invalidates::sum,
        .values = kShadingNames},
    Setting<int>{.member = &Settings::samples,
                 .name = "samples",
                 .help = "samples per pixel",
                 .shadings = kReferenceOnly,
                 .least = 1,
                 .most = 65536},
    Setting<View>{.member = &Settings::view,
                  .name = "view",
                  .help = "debug view shown in place of the picture",
                  .invalidates = invalidates::radiance | invalidates::sum,
                  .values = kViewNames,
                  .widget = {.panel = Panel::picture, .label = "View"}},
    Setting<float>{.member = &Settings::exposure,
                   .name = "exposure",
                   .help = "multiplies radiance before tone mapping; auto: brings the view to middle grey",
                   .invalidates = invalidates::display,
                   .least = 1e-30,
                   .most = 1e30,
                   .defaultText = "1; auto where the scene's own lights would give a white or black picture"},
    Setting<ToneMap>{.member = &Settings::toneMap,
                     .name = "tone-map",
                     .help = "tone mapping: neutral (Khronos PBR Neutral), aces or clamp",
                     .invalidates = invalidates::display,
                     .values = kToneMapNames,
                     .widget = {.panel = Panel::picture, .label = "Tone mapping"}},
    Setting<int>{.member = &Settings::msaa,
                 .name = "msaa",
                 .help = "multisample anti-aliasing: coverage samples per pixel",
                 .shadings = kRealTime,
                 .invalidates = invalidates::radiance | invalidates::targets | invalidates::sum,
                 .values = kSampleCounts,
                 .widget = {.panel = Panel::picture, .label = "MSAA"}},
    Setting<bool>{.member = &Settings::edgeFilter,
                  .name = "edge-filter",
                  .help = "anti-aliasing of edges between objects after drawing, with --msaa 1",
                  .shadings = kRealTime,
                  .values = kOffOn,
                  .widget = {.panel = Panel::picture, .label = "Edge filter"}},
    Setting<int>{
        .member = &Settings::forwardAnisotropy,
        .name = "forward-anisotropy",
        .help = "maximum anisotropy of the material lookups of what is shaded forward; 1 is isotropic",
        .shadings = kRealTime,
        .least = 1,
        .most = 16,
        .widget =
            {.panel = Panel::picture, .label = "Anisotropy", .format = "%.0f taps", .least = 1, .most = 16}},
    Setting<double>{
        .member = &Settings::budgetMs,
        .name = "budget-ms",
        .help = "hold each frame within this time by lighting fewer and coarser lumels, and by "
                "rendering fewer pixels",
        .shadings = kRealTime,
        .invalidates = invalidates::radiance | invalidates::targets | invalidates::sum | invalidates::budget,
        .least = 0.1,
        .most = 10000,
        .word = "none",
        .wordValue = 0.0,
        .unit = "ms",
        .widget =
            {.panel = Panel::lumels, .label = "Frame budget", .format = "%.0f ms", .least = 0, .most = 200}},
    Setting<ResidencyFrom>{
        .member = &Settings::residency,
        .name = "residency",
        .help = "whose needs lit textures are assigned by: exact, those of the frame that is drawn, which "
                "waits until it knows them; latest, those of an earlier frame, so that none waits",
        .shadings = kRealTime,
        .values = kResidencyNames},
    Setting<uint32_t>{.member = &Settings::framesInFlight,
                      .name = "frames-in-flight",
                      .help = "frames that are begun before the first has finished, with --residency latest",
                      .shadings = kRealTime,
                      .least = 1,
                      .most = 3},
    Setting<float>{.member = &Settings::levelOffset,
                   .name = "level-offset",
                   .help = "MIP levels by which lumels are coarser than one per pixel, at least",
                   .shadings = kTslOnly,
                   .invalidates = invalidates::radiance | invalidates::lumels,
                   .least = -2,
                   .most = 8,
                   .unit = "levels",
                   .widget = {.panel = Panel::lumels,
                              .label = "Level offset",
                              .format = "%.2f levels",
                              .least = -1,
                              .most = 4}},
    Setting<float>{
        .member = &Settings::lumelsPerPixel,
        .name = "lumels-per-pixel",
        .help = "density limit: surfaces at grazing angles lose detail before a view needs more lumels "
                "per covered pixel",
        .shadings = kTslOnly,
        .invalidates = invalidates::radiance | invalidates::lumels,
        .least = 0.1,
        .most = 64,
        .widget = {.panel = Panel::lumels,
                   .label = "Density limit",
                   .format = "%.1f lumels per pixel",
                   .least = 0.5f,
                   .most = 16}},
    Setting<uint32_t>{.member = &Settings::lumelBudget,
                      .name = "lumel-budget",
                      .help = "lumels lit per frame at most; the others wait",
                      .shadings = kTslOnly,
                      .least = 64,
                      .most = double(std::numeric_limits<uint32_t>::max()),
                      .word = "unlimited",
                      .wordValue = ~0u,
                      .widget = {.panel = Panel::lumels,
                                 .label = "Lit per frame",
                                 .format = "%.0f lumels",
                                 .least = 64,
                                 .most = 1e7f,
                                 .logarithmic = true}},
    Setting<float>{.member = &Settings::refreshShare,
                   .name = "refresh-share",
                   .help = "share of the visible lumels lit again per frame because the camera moved",
                   .shadings = kTslOnly,
                   .least = 0,
                   .most = 1,
                   .widget = {.panel = Panel::lumels, .label = "Refresh share"}},
    Setting<float>{.member = &Settings::tolerance,
                   .name = "tolerance",
                   .help = "keep lumels whose display value is expected to change by less",
                   .shadings = kTslOnly,
                   .invalidates = invalidates::radiance | invalidates::lumels,
                   .least = 0,
                   .most = 1,
                   .widget = {.panel = Panel::lumels,
                              .label = "Tolerance",
                              .format = "%.2f / 255",
                              .most = 8,
                              .scale = 255}},
    Setting<DrawFilter>{.member = &Settings::filter,
                        .name = "draw-filter",
                        .help = "reconstruction filter of lit textures",
                        .shadings = kTslOnly,
                        .invalidates = invalidates::radiance | invalidates::lumels,
                        .values = kDrawFilterNames,
                        .widget = {.panel = Panel::lumels, .label = "Draw filter"}},
    Setting<float>{.member = &Settings::anisotropy,
                   .name = "anisotropy",
                   .help = "maximum anisotropy of the lookups in lit textures",
                   .shadings = kTslOnly,
                   .invalidates = invalidates::radiance | invalidates::lumels,
                   .least = 1,
                   .most = 16,
                   .widget = {.panel = Panel::lumels,
                              .label = "Anisotropy",
                              .format = "%.0f taps",
                              .least = 1,
                              .most = 16}},
    Setting<size_t>{.member = &Settings::poolBytes,
                    .name = "pool-mb",
                    .help = "memory limit of lit textures and cached surfaces, which grow with the view; "
                            "meshes, texel maps, materials and targets come on top",
                    .shadings = kTslOnly,
                    .invalidates = invalidates::radiance | invalidates::lumels | invalidates::pool,
                    .least = 1,
                    .most = 65536,
                    .unit = "MiB",
                    .memberPerUnit = 1 << 20,
                    .widget = {.panel = Panel::lumels,
                               .label = "Pool",
                               .format = "%.0f MiB",
                               .least = 8,
                               .most = 1024,
                               .logarithmic = true}},
    Setting<float>{
        .member = &Settings::environmentIntensity,
        .name = "environment-intensity",
        .help = "multiplies the environment's radiance",
        .invalidates =
            invalidates::radiance | invalidates::sum,
        .least = 0,
        .most = 1e6,
        .widget = {.panel = Panel::environment, .label = "Intensity", .most = 8, .logarithmic = true}},
    Setting<float>{.member = &Settings::environmentRotation,
                   .name = "environment-rotation",
                   .help = "rotation of the environment about the vertical axis",
                   .invalidates = invalidates::radiance | invalidates::sum,
                   .least = -360,
                   .most = 360,
                   .unit = "degrees",
                   .widget = {.panel = Panel::environment,
                              .label = "Rotation",
                              .format = "%.0f degrees",
                              .least = -180,
                              .most = 180}},
    Setting<std::optional<float>>{
        .member = &Settings::ambient,
        .name = "ambient",
        .help = "radiance of a uniform sky beside the environment; the ground has a third of it",
        .invalidates = invalidates::radiance | invalidates::sum,
        .least = 0,
        .most = 1e6,
        .word = "auto",
        .defaultText = "auto: 4 % of the brightest sun in a scene lit by its own lights, else 0"},
    Setting<bool>{.member = &Settings::shadows,
                  .name = "shadows",
                  .help = "shadow maps of sun and spot lights, for the 8 strongest",
                  .invalidates = invalidates::radiance | invalidates::sum,
                  .values = kOffOn,
                  .widget = {.panel = Panel::lights, .label = "Shadows"}},
    Setting<uint32_t>{.member = &Settings::shadowSize,
                      .name = "shadow-size",
                      .help = "width and height of each shadow map",
                      .invalidates = invalidates::radiance | invalidates::sum,
                      .least = 64,
                      .most = 8192,
                      .unit = "texels"}};

template<class Visit>
constexpr void forEachSetting(const Visit& visit)
{
    std::apply([&](const auto&... settings) { (visit(settings), ...); }, kSettings);
}

template<class T, class Member>
constexpr bool describes(const Setting<T>& setting, Member Settings::*member)
{
    if constexpr (std::is_same_v<T, Member>)
        return setting.member == member;
    return false;
}

// Whether the picture depends on it. Debug views show quantities of texture space whatever the shading.
template<class T>
constexpr bool appliesTo(const Setting<T>& setting, const Settings& settings)
{
    return settings.view != View::none || (setting.shadings & shadingBit(settings.shading)) != 0;
}

// All that changing from `before` to `after` invalidates.
unsigned changes(const Settings& before, const Settings& after);

// With the default in place of each setting that the picture does not depend on.
Settings applicable(const Settings& settings);

} // namespace lumel
