// lumel-assets <folder>: writes the example scenes, <folder>/<scene>/<scene>.gltf. Everything is computed
// here, from fixed seeds: no pictures from elsewhere, the same files from every run, CC0.
#include "scenes.h"
#include <exception>
#include <filesystem>
#include <tbb/parallel_invoke.h>

#include <cstdio>

int main(int argc, char** argv)
{
    if (argc != 2) {
        std::fprintf(stderr, "usage: lumel-assets <output folder>\n");
        return 2;
    }
    try {
        const std::filesystem::path folder = argv[1];
        using namespace lumel::assets;
        tbb::parallel_invoke([&] { writeRecord(folder / "record"); }, [&] { writeBalls(folder / "balls"); },
                             [&] { writeBricks(folder / "bricks"); }, [&] { writeCharts(folder / "charts"); },
                             [&] { writeCrowd(folder / "crowd"); }, [&] { writeStress(folder / "stress"); },
                             [&] { writeTentacles(folder / "tentacles"); },
                             [&] { writeMorph(folder / "morph"); }, [&] { writeDahlia(folder / "dahlia"); });
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
    return 0;
}
