// The window and its loop: requests from keys, panels and drops, then a frame, then the panels over it.
#pragma once
#include "app/commands.h"
#include "input.h"
#include "scene_thread.h"

struct GLFWwindow;

namespace lumel {

class Viewer {
public:
    // Throws Error when the window or the device cannot be created.
    explicit Viewer(const ViewArguments& arguments);
    ~Viewer();
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;

    // Until the window is closed. Throws Error when the first scene cannot be shown.
    void run();
    // After Ctrl-C. Ends the process where a frame does not: drivers may compile for seconds, and cannot be
    // stopped.
    void abandon();
    std::vector<std::string> validationMessages() const;

private:
    // GLFW's window and ImGui's context, on which all else stands.
    struct Frontend {
        explicit Frontend(const ViewArguments& arguments);
        ~Frontend();
        GLFWwindow* window = nullptr;
        float scale = 1.0f; // of the panels
        std::unique_ptr<ui::Input> input;
    };

    // What the loader is at work on.
    struct Load {
        // Another scene; a material of the one that is shown, replaced; its materials by another filter.
        enum class Kind { scene, material, filter } kind = Kind::scene;
        std::filesystem::path file;                // the scene, or the material's baked one
        std::string material;                      // its name
        baker::Method method = baker::Method::fit; // of all materials
    };
    void await();
    double untilRedraw() const;
    void frame();
    void collect();
    void play(double seconds);
    void expose(double seconds);
    void request();
    bool minimised() const;
    void show(const ui::Layout& layout);
    void inspect(const ui::Layout& layout);
    glm::uvec2 pictureSize(const ui::Layout& layout) const;

    // What was asked for.
    void act(const ui::Layout& layout);
    void actOnCamera(const ui::Requests& asked, const ui::Layout& layout);
    void open(const std::filesystem::path& file, glm::vec2 at, const ui::Layout& layout);
    void replaceMaterial(const std::filesystem::path& file, glm::vec2 at, const ui::Layout& layout);
    void ask(std::function<SceneThread::Answer(ViewRenderers&)> work);
    void copyCommand();
    void takeScreenshot(const char* extension, const ui::ViewState& state);
    void takeWaitingScreenshots();
    void reloadShaders();
    void toggleFullscreen();

    // Loading.
    void beginLoading(const std::filesystem::path& file);
    void finishLoading();
    void take(const std::shared_ptr<scene::LoadedScene>& loaded);
    void takeBakes();
    void meterAgain();
    void taken(const Load& load, bool first);
    void loadFailed(const Load& load, const std::string& why);
    void beginView(const Load& load, bool first);
    void keepView(const Load& load);
    void forgetSceneOptions();
    void resetView();
    void changeEnvironment();                        // to what the panels ask for
    std::vector<scene::Light> defaultLights() const; // of the scene, or of its environment
    scene::MaterialOptions bakeOptions(baker::Method method) const;
    void loadMissing();

    void say(const std::string& message, bool isError = false);
    void setTitle();

    ViewArguments arguments_; // `scene` is the one shown
    Frontend frontend_;
    std::unique_ptr<gpu::Device> device_;
    // Of the window and its panels: where the CPU is the device, one of its own, whose queue holds no frame
    // of the scene.
    std::unique_ptr<gpu::Device> ownDevice_;
    std::unique_ptr<gpu::Window> window_;
    std::unique_ptr<SceneThread> thread_;
    std::shared_ptr<const scene::Scene> scene_; // that the renderers have
    scene::Loader loader_;
    bool uploading_ = false; // what it loaded
    bool baking_ = false;    // and is baking of it
    ui::Inspector inspector_;
    ui::ViewState state_;
    ui::ViewReport report_;
    Load load_;
    std::shared_ptr<const scene::Environment> environment_; // as shown
    std::string environmentName_;
    double asked_ = 0.0;    // when the scene was, seconds
    bool reported_ = false; // that it is shown
    int screenshots_ = 0;
    std::vector<std::pair<const char*, ui::ViewState>> waiting_; // screenshots whose materials are not baked
    ExposureAdaptation adaptation_;
    bool exposureAsked_ = false; // is automatic exposure needed?
    bool exposureKnown_ = false; // of this view; until then nothing is rendered
    std::optional<LuminanceHistogram> metered_;
    int redraws_ = 3;        // that panels take to follow input
    double lastFrame_ = 0.0; // seconds
    double played_ = 0.0;    // seconds of the animation
    std::string title_;
    std::array<int, 4> windowed_{}; // place and size before full screen
};

} // namespace lumel
