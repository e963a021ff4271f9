// What the panels and keys change, and what they show. The viewer acts on it between frames.
#pragma once
#include "baker/bake.h"
#include "gpu/window.h"
#include "inspection.h"
#include "renderer/settings.h"
#include "renderer/stats.h"
#include "scene/view_camera.h"
#include "tsl/residency.h"
#include <array>
#include <deque>
#include <filesystem>
#include <optional>

namespace lumel::ui {

// What a side of the split is rendered with.
struct Side {
    Shading shading = Shading::tsl;
    baker::Method filter = baker::Method::fit;
    bool operator==(const Side&) const = default;
};

// Asked for by a key, a panel or a drop; cleared by the viewer once done.
struct Requests {
    std::vector<std::filesystem::path> open; // dropped files
    glm::vec2 openAt{0.0f};                  // in the picture, (0, 0) upper left to (1, 1)
    bool copyCommand = false, screenshotPng = false, screenshotExr = false;
    bool reloadShaders = false, reset = false, quit = false, fullscreen = false;
    int camera = -1;                  // of the file
    bool pick = false, focus = false; // select what is at `pickAt`; look at it
    glm::vec2 pickAt{0.0f};
};

struct ViewState {
    Settings settings; // of both sides but for shading and filter
    std::array<Side, 2> sides;
    bool split = false;
    float splitAt = 0.5f; // share of the picture's width
    bool panels = true, help = false;
    bool hint = false; // a few keys, for who is here for the first time
    bool paused = false, step = false;
    bool playing = false;          // the scene's animation, again and again
    std::optional<double> seconds; // of the animation; nothing: as the file's nodes stand
    bool continuous = false;       // render even when nothing changes
    gpu::PresentMode presentMode = gpu::PresentMode::fifo;
    scene::ViewCamera camera;
    std::vector<scene::Light> lights;
    bool lightsEdited = false;
    std::string environment;        // none, sky or a file
    bool autoExposure = false;      // settings.exposure follows what is seen
    bool exposureChosen = false;    // by hand or an option: other scenes keep it
    std::optional<size_t> selected; // object
    bool materialTab = false;       // the inspector is shown
    glm::vec2 cursor{-1.0f};        // in the picture; negative: elsewhere
    Requests requests;

    const Side& activeSide() const { return sides[split && cursor.x > splitAt ? 1 : 0]; }
    Side& activeSide() { return sides[split && cursor.x > splitAt ? 1 : 0]; }
};

struct SideReport {
    FrameStats stats;
    std::optional<double> psnr; // against the reference of this view, dB
    int samples = 0;            // reference only
};

struct FrameSample {
    double at = 0.0; // when it was finished, in seconds of glfwGetTime()
    float ms = 0.0f;
    std::map<std::string, double> passMs;
};

// What the last frame reports.
struct ViewReport {
    const scene::Scene* scene = nullptr; // null: none loaded yet
    std::string device, sceneName;
    std::array<SideReport, 2> sides;
    std::vector<tsl::ObjectResidency>
        residency;                      // of the left side, in the scene's order; empty unless it is tsl
    std::vector<glm::uvec2> lumelGrids; // of the objects, level 0
    std::deque<FrameSample> history;    // the newest last
    std::string loading;                // what is being done; empty: nothing
    float loadingShare = 0.0f;
    std::string message; // shown until `messageUntil`, in seconds of glfwGetTime()
    bool messageIsError = false;
    double messageUntil = 0.0;
    float ambient = 0.0f;                   // radiance of the uniform sky
    int referenceSamples = 0;               // behind psnr
    std::array<baker::Method, 2> methods{}; // of the materials that the sides show
    bool finished = false;                  // further frames would not change the pictures
    Inspection inspection;
};

} // namespace lumel::ui
