#include "core/error.h"
#include "dds.h"
#include "export_maps.h"
#include "gltf_square.h"
#include "ktx2.h"
#include <fmt/format.h>

namespace lumel::baker {
namespace {

using Json = nlohmann::json;

Image encodedForBytes(const ExportMap& map, size_t level)
{
    Image image = map.levels[level];
    if (map.colourSpace == ColourSpace::srgb)
        for (size_t i = 0; i < image.pixels.size(); ++i)
            if (i % size_t(image.channels) < 3)
                image.pixels[i] = linearToSrgb(image.pixels[i]);
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

// One file a level.
Json writePictures(const std::string& name, const ExportMap& map, bool asExr, StagedFiles& files)
{
    Json json = describe(map, asExr ? "half float" : "8 bit");
    for (size_t l = 0; l < map.levels.size(); ++l) {
        checkInterrupted();
        const std::string file = fmt::format("{}_{}_{:02}.{}", name, map.name, l, asExr ? "exr" : "png");
        writeImage(files.path(file), asExr ? map.levels[l] : encodedForBytes(map, l));
        json["files"].push_back(file);
    }
    return json;
}

// All levels in one.
Json writeTexture(const std::string& name, const ExportMap& map, const ExportOptions& options, bool asDds,
                  StagedFiles& files)
{
    checkInterrupted();
    Json json = describe(map, nameOf(formatOf(map, options.storage)));
    const std::string file = fmt::format("{}_{}.{}", name, map.name, asDds ? "dds" : "ktx2");
    files.write(file, asDds ? encodeDds(map, options.storage, options.ddsHeader)
                            : encodeKtx2(map, options.storage, options.zstandard));
    json["files"].push_back(file);
    return json;
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
    for (const ExportMap& map : maps)
        switch (options.format) {
        case ExportFormat::png:
        case ExportFormat::exr:
            description["maps"].push_back(
                writePictures(name, map, options.format == ExportFormat::exr, files));
            break;
        case ExportFormat::dds:
            description["maps"].push_back(writeTexture(name, map, options, true, files));
            break;
        case ExportFormat::gltf:
        case ExportFormat::glb:
        case ExportFormat::ktx2:
            description["maps"].push_back(writeTexture(name, map, options, false, files));
            break;
        }
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
