// lumel-assets FOLDER SCENE: writes an example scene, FOLDER/SCENE/SCENE.gltf. Everything is computed here,
// from fixed seeds: no pictures from elsewhere, the same files from every run, CC0.
#include "scenes.h"
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <string>

int main(int argc, char** argv)
{
    using namespace lumel::assets;
    const std::map<std::string, void (*)(const std::filesystem::path&)> writers = {
        {"record", writeRecord},   {"balls", writeBalls},   {"bricks", writeBricks},
        {"charts", writeCharts},   {"crowd", writeCrowd},   {"stress", writeStress},
        {"morph", writeMorph},     {"dahlia", writeDahlia}, {"tentacles", writeTentacles},
        {"grooves", writeGrooves},
    };
    const auto writer = argc == 3 ? writers.find(argv[2]) : writers.end();
    if (writer == writers.end()) {
        std::fprintf(stderr, "usage: lumel-assets FOLDER SCENE\nscenes:");
        for (const auto& [name, write] : writers)
            std::fprintf(stderr, " %s", name.c_str());
        std::fprintf(stderr, "\n");
        return 2;
    }
    try {
        writer->second(std::filesystem::path(argv[1]) / writer->first);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
    return 0;
}
