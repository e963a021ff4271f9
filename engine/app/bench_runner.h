// Renders all runs of a measurement on one device, in turns of a few frames each, so that a machine that gets
// slower or busy slows all alike.
#pragma once
#include "commands.h"
#include "core/progress.h"
#include "setup.h"
#include <memory>

namespace lumel {

class BenchRunner {
public:
    // Loads, bakes and uploads everything. Throws Error.
    BenchRunner(const gpu::Device& device, const BenchArguments& arguments);
    ~BenchRunner();

    void measure();
    nlohmann::json document() const; // of `bench --json`

private:
    struct View; // what is seen: a scene, its lights and objects, a size
    struct Run;  // a view and a way of shading it
    struct Uploaded;

    void addScene(const std::filesystem::path& file);
    Uploaded upload(const scene::Scene& scene) const;
    void addView(const scene::Scene& scene, const Uploaded& uploaded, const BenchArguments& arguments);
    void measureTurn(View& view, int from, int to, bool backwards);
    void renderReferences(View& view, int from, int to);
    void render(View& view, Run& run, int frame);
    void place(View& view, Renderer& renderer, int frame); // lights and objects
    void measureQuality(View& view, Run& run, int frame, FrameStats& stats) const;
    static void measureFloors(View& view, Run& run, int frame);
    static void collect(Run& run);
    bool needsReference(int frame) const;

    const gpu::Device& device_;
    const BenchArguments& arguments_;
    std::vector<std::unique_ptr<View>> views_;
    std::unique_ptr<Progress> progress_;
};

} // namespace lumel
