// Batch baking from a JSON list.
#pragma once
#include "bake.h"
#include <filesystem>

namespace lumel::baker {

struct ManifestResult {
    size_t baked = 0, upToDate = 0;    // how many
    std::vector<std::string> failures; // one line each: "output: why"
};

// Every `count`-th entry from `index` on, so that processes or machines share a list and a folder.
struct Shard {
    size_t index = 0, count = 1;
};

// Bakes every entry of a JSON list, with one progress bar:
//   [{"output": "a.exr", "height": "h.png", "height-scale": 0.02 | "normal": "n.png", "normal-green": "up",
//     "power": 200 | "p.png", "power-map": "p.png", "roughness": "r.png",
//     "specular": 0.04 | [r, g, b] | "s.png", "diffuse": ...,
//     "tangent-rotation": "t.png", "anisotropic-power": [pu, pv], "wrap": "repeat" | "clamp",
//     "method": "fit", "model": "ashikhmin-shirley", "reduce": 0, "reconstruction": "box",
//     "threads": 2, "float": true, "report": "a.html" | ["a.html", "a.json"]}, ...]
// The keys are bake's options; an underscore may stand for a dash. File names are relative to the manifest.
// Entries whose output was baked from the same inputs and options are skipped; a failing entry does not
// stop the others. `defaults` fills what an entry leaves out. `print`: one line about each on stdout.
// Of two entries that write the same file, the first counts, also where they are in different shards: shards
// never write the same file. Throws Error when the manifest itself is unusable.
ManifestResult bakeManifest(const std::filesystem::path& manifest, const Options& defaults,
                            bool print = false, Shard shard = {});

} // namespace lumel::baker
