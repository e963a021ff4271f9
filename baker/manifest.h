// Many bakes from one list.
#pragma once
#include "bake.h"
#include <filesystem>

namespace lumel::baker {

struct ManifestResult {
    size_t baked = 0, upToDate = 0;
    std::vector<std::string> failures; // one line each: "output: why"
};

// Bakes every entry of a JSON list, with one progress bar:
//   [{"output": "a.exr", "height": "h.png", "height_scale": 0.02 | "normal": "n.png", "normal_green": "up",
//     "power": 200 | "p.png", "roughness": "r.png", "specular": 0.04 | [r, g, b] | "s.png", "diffuse": ...,
//     "tangent_rotation": "t.png", "anisotropic_power": [pu, pv], "wrap": "repeat" | "clamp",
//     "method": "fit", "model": "ashikhmin-shirley", "reduce": 0, "reconstruction": "box"}, ...]
// File names are relative to the manifest. Entries whose output was baked from the same inputs and options
// are skipped; a failing entry does not stop the others. `defaults` fills what an entry leaves out.
// Throws Error when the manifest itself is unusable.
ManifestResult bakeManifest(const std::filesystem::path& manifest, const Options& defaults);

// lumel:source of a baked file that readExr() would accept by its header, else empty.
std::string bakedSource(const std::filesystem::path& file);

} // namespace lumel::baker
