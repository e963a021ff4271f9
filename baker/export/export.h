// A baked chain as files for other engines: maps of GGX lobes with all levels as they were fitted, and a JSON
// file that says what they hold.
#pragma once
#include "staged_files.h"
#include "texels.h"
#include <filesystem>

namespace lumel::baker {

enum class ExportFormat { gltf, glb, dds, ktx2, png, exr };

struct ExportOptions {
    ExportFormat format = ExportFormat::ktx2;
    MapOptions maps;
    TexelStorage storage = TexelStorage::bytes; // of DDS and KTX2
    DdsHeader ddsHeader = DdsHeader::dx10;
    bool zstandard = false;  // of KTX2
    bool ktx2Beside = false; // of glTF: KTX2 files of the same maps
    int threads = 0;
};

// Of baked levels in memory. `name` begins the names of all files.
struct ExportSource {
    std::string name;
    std::string bakedFile; // for the JSON
    const ReflectanceMips& mips;
};

// Writes into `files`, without publishing them. Returns one line of remarks for the user, or none.
std::string exportMips(const ExportSource& source, const ExportOptions& options, StagedFiles& files,
                       Progress* progress = nullptr);

} // namespace lumel::baker
