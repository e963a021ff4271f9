#include "option_types.h"
#include "options.h"

namespace lumel {
namespace {

constexpr std::array kFormatNames{"gltf", "glb", "dds", "ktx2", "png", "exr"}; // baker::ExportFormat
constexpr std::array kPackingNames{"auto", "gltf", "orm", "unity", "unreal"};  // PackingChoice
constexpr std::array kTexelNames{"auto", "8bit", "blocks", "half"};            // TexelChoice
constexpr std::array kGreenDirections{"down", "up"};
constexpr std::array kDdsHeaderNames{"dx10", "dx9"}; // baker::DdsHeader
constexpr std::array kTextureNames{"png", "ktx2"};

bool isGltf(baker::ExportFormat format)
{
    return format == baker::ExportFormat::gltf || format == baker::ExportFormat::glb;
}

} // namespace

Option addExportFormat(Command& command, ExportChoices& c)
{
    return addChoice(
        command, "--to", kFormatNames,
        "files to write: gltf and glb show the material on a square; dds and ktx2 hold all levels, png "
        "and exr are one file a level",
        c.format);
}

namespace {

void addExportOptions(Command& command, ExportChoices& c)
{
    addExportFormat(command, c);
    addChoice(command, "--packing", kPackingNames,
              "channels of roughness and metalness: gltf and orm G and B, unity metalness with smoothness in "
              "alpha, unreal a map each; auto: unreal for dds, else gltf",
              c.packing);
    addChoice(command, "--texels", kTexelNames,
              "texels of dds and ktx2; blocks: BC5 for normals, BC4 for single channels, else 8 bits; auto: "
              "blocks for dds, 8bit for ktx2",
              c.texels);
    addChoice(command, "--normal-green", kGreenDirections,
              "direction of green in the normal maps that are written", c.normalGreenUp);
    command.addFlag("--anisotropy", "write anisotropy direction and strength (KHR_materials_anisotropy)",
                    c.anisotropic);
    addChoice(command, "--dds-header", kDdsHeaderNames,
              "header of dds files; dx9 is for older programs and does not tell sRGB from linear",
              c.ddsHeader);
    command.addFlag("--zstd", "compress ktx2 files with Zstandard", c.zstandard);
    addChoice(command, "--textures", kTextureNames,
              "textures of gltf and glb: ktx2 writes all levels beside the PNG images", c.ktx2Beside);
}

void checkExportOptions(const ExportChoices& c)
{
    using baker::ExportFormat;
    const bool writesKtx2 = c.format == ExportFormat::ktx2 || (isGltf(c.format) && c.ktx2Beside);
    if (c.zstandard && !writesKtx2)
        throw UsageError("--zstd compresses ktx2 files only");
    if (c.ddsHeader != baker::DdsHeader::dx10 && c.format != ExportFormat::dds)
        throw UsageError("--dds-header goes with --to dds");
    if (c.ktx2Beside && !isGltf(c.format))
        throw UsageError("--textures ktx2 goes with --to gltf or glb");
    if (c.texels != TexelChoice::automatic && !writesKtx2 && c.format != ExportFormat::dds)
        throw UsageError("--texels goes with dds and ktx2 files");
    const bool separate = c.packing == PackingChoice::unity || c.packing == PackingChoice::unreal;
    if (isGltf(c.format) && separate)
        throw UsageError("glTF wants --packing gltf or orm");
}

} // namespace

void addExport(CommandLine& line, ExportArguments& a)
{
    Command command = line.add("export", "Write a baked material as GGX maps that other engines load");
    addText(command, "baked", "FILE", "OpenEXR file of lumel bake", a.baked).required();
    addText(command, "-o,--output", "FOLDER", "folder to write to; it is made if only that is missing",
            a.folder)
        .required();
    addText(command, "--name", "NAME", "beginning of the names of files", a.name)
        .byDefault("that of the baked file");
    addExportOptions(command, a.choices);
    addNumber(command, "--threads", 0, 1024, "", "0: one per core", a.threads);
    command.afterParsing([&a] {
        checkExportOptions(a.choices);
        if (a.name.find('/') != std::string::npos || a.name.starts_with("."))
            throw UsageError("--name " + a.name + ": not the beginning of a file's name");
    });
}

} // namespace lumel
