#include "core/error.h"
#include "dds.h"
#include "export_maps.h"
#include "gltf_square.h"
#include "ktx2.h"
#include <fmt/format.h>
#include <functional>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace lumel::baker {
namespace {

using Json = nlohmann::json;

Image encodedForBytes(const ExportMap& map, size_t level)
{
    Image image = map.levels[level];
    if (map.colourSpace == ColourSpace::srgb)
        tbb::parallel_for(0, image.height, [&](int y) {
            for (int x = 0; x < image.width; ++x)
                for (int c = 0; c < std::min(image.channels, 3); ++c)
                    image.at(x, y)[c] = linearToSrgb(image.at(x, y)[c]);
        });
    return image;
}

const char* nameOf(TexelFormat format)
{
    switch (format) {
    case TexelFormat::r8:
        return "R8";
    case TexelFormat::rgba8:
        return "R8G8B8A8";
    case TexelFormat::rgba8Srgb:
        return "R8G8B8A8 sRGB";
    case TexelFormat::rgba16f:
        return "R16G16B16A16 float";
    case TexelFormat::bc4:
        return "BC4";
    case TexelFormat::bc5:
        return "BC5";
    }
    return "";
}

Json describe(const ExportMap& map, const std::string& texels)
{
    Json channels = Json::array();
    for (const MapChannel& c : map.channels)
        channels.push_back(
            {{"channel", c.name}, {"meaning", c.meaning}, {"decoded", c.decoded}, {"range", {0, 1}}});
    return {{"map", map.name},
            {"colour_space",
             map.colourSpace == ColourSpace::srgb && texels != "R16G16B16A16 float" && texels != "half float"
                 ? "sRGB"
                 : "linear"},
            {"texels", texels},
            {"channels", channels},
            {"files", Json::array()}};
}

// One file a level, all at once.
void writePictures(const std::string& name, const std::vector<ExportMap>& maps, bool asExr,
                   StagedFiles& files, Json& description)
{
    std::vector<std::function<void()>> work;
    for (const ExportMap& map : maps) {
        Json json = describe(map, asExr ? "half float" : "8 bit");
        for (size_t l = 0; l < map.levels.size(); ++l) {
            const std::string file = fmt::format("{}_{}_{:02}.{}", name, map.name, l, asExr ? "exr" : "png");
            work.push_back([&map, l, asExr, path = files.path(file)] {
                checkInterrupted();
                writeImage(path, asExr ? map.levels[l] : encodedForBytes(map, l));
            });
            json["files"].push_back(file);
        }
        description.push_back(std::move(json));
    }
    tbb::parallel_for(size_t(0), work.size(), [&](size_t i) { work[i](); });
}

// All levels in one.
void writeTextures(const std::string& name, const std::vector<ExportMap>& maps, const ExportOptions& options,
                   bool asDds, StagedFiles& files, Json& description)
{
    std::vector<std::vector<std::byte>> contents(maps.size());
    const auto encode = [&](size_t i) {
        checkInterrupted();
        contents[i] = asDds ? encodeDds(maps[i], options.storage, options.ddsHeader)
                            : encodeKtx2(maps[i], options.storage, options.zstandard);
    };
    if (options.zstandard) // small, and one map takes one core
        tbb::parallel_for(size_t(0), maps.size(), encode);
    for (size_t i = 0; i < maps.size(); ++i) {
        if (!options.zstandard)
            encode(i);
        Json json = describe(maps[i], nameOf(formatOf(maps[i], options.storage)));
        const std::string file = fmt::format("{}_{}.{}", name, maps[i].name, asDds ? "dds" : "ktx2");
        files.write(file, std::exchange(contents[i], {}));
        json["files"].push_back(file);
        description.push_back(std::move(json));
    }
}

constexpr const char* kMethod =
    "GGX refitted to the exact average of the lobes of level 0, by least squares over half vectors";

} // namespace

std::vector<unsigned char> pngOf(const ExportMap& map)
{
    return encodePng(encodedForBytes(map, 0));
}

Json describeLevels(const std::vector<GgxLevel>& levels)
{
    Json list = Json::array();
    for (size_t l = 0; l < levels.size(); ++l) {
        const GgxLevel& level = levels[l];
        list.push_back({{"level", l},
                        {"width", level.width},
                        {"height", level.height},
                        {"method", l == 0 && level.errors.worst == 0.0 ? "as baked" : kMethod},
                        {"error",
                         {{"mean", level.errors.mean},
                          {"worst", level.errors.worst},
                          {"mean_of_converted_lobe", level.errors.converted},
                          {"mean_of_averaged_maps", level.errors.averaged}}}});
    }
    return list;
}

void writeMaps(const std::string& name, const std::vector<ExportMap>& maps, const ExportOptions& options,
               StagedFiles& files, Json& description)
{
    const auto write = [&] {
        switch (options.format) {
        case ExportFormat::png:
        case ExportFormat::exr:
            writePictures(name, maps, options.format == ExportFormat::exr, files, description["maps"]);
            break;
        case ExportFormat::dds:
        case ExportFormat::gltf:
        case ExportFormat::glb:
        case ExportFormat::ktx2:
            writeTextures(name, maps, options, options.format == ExportFormat::dds, files,
                          description["maps"]);
            break;
        }
    };
    tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
    arena.execute(write);
}

std::string exportMips(const ExportSource& source, const ExportOptions& options, StagedFiles& files,
                       Progress* progress)
{
    const std::vector<GgxLevel> levels =
        fitGgx(source.mips, {.anisotropic = options.maps.anisotropic, .threads = options.threads}, progress);
    const std::vector<ExportMap> maps = makeMaps(levels, options.maps);
    Json description = {{"schema", 1},
                        {"source", source.bakedFile},
                        {"baked", {{"model", source.mips.model}, {"method", source.mips.method}}},
                        {"distribution", "GGX"},
                        {"levels", describeLevels(levels)},
                        {"maps", Json::array()}};
    std::string remark;
    const bool isGltf = options.format == ExportFormat::gltf || options.format == ExportFormat::glb;
    if (isGltf) {
        description["files"] = writeGltfSquare(source.name, maps, options.format == ExportFormat::glb, files);
        if (!options.ktx2Beside)
            remark =
                "glTF holds level 0 only and viewers average it; --textures ktx2 writes all levels beside";
    }
    if (!isGltf || options.ktx2Beside)
        writeMaps(source.name, maps, options, files, description);
    files.write(source.name + ".json", description.dump(1) + "\n");
    return remark;
}

} // namespace lumel::baker
