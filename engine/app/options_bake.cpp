#include "option_types.h"
#include "options.h"
#include <set>

namespace lumel {
namespace {

constexpr std::array kReconstructionNames{"box", "bilinear"}; // baker::Reconstruction
constexpr std::array kWrapNames{"repeat", "clamp"};           // baker::Wrap
constexpr std::array kGreenNames{"down", "up"};
constexpr std::array kModelTextureNames{"png", "ktx2"};

void addSurface(Command& command, BakeArguments& a)
{
    const Option height = addText(command, "--height", "FILE", "height map (channel 0)", a.height);
    addNumber(command, "--height-scale", -1e30, 1e30, "", "height of value 1 in units of the map's width",
              a.heightScale)
        .needs(height);
    addText(command, "--normal", "FILE", "tangent-space normal map", a.normal).excludes(height);
    addChoice(command, "--normal-green", kGreenNames, "direction of the normal map's green channel",
              a.normalGreenUp);
    addChoice(command, "--wrap", kWrapNames, "address mode beyond the map's border", a.wrap);
}

void addReflectance(Command& command, BakeArguments& a)
{
    addNumber(command, "--power", 1e-30, 1e30, "", "Blinn-Phong power of every texel", a.power);
    addText(command, "--power-map", "FILE", "Blinn-Phong power, as stored (channel 0, float image)",
            a.powerMap);
    addText(command, "--roughness", "FILE", "glTF perceptual roughness (channel 0) in place of a power",
            a.roughness);
    command.addSeveral(
        "--anisotropic-power", 2, "POWER POWER",
        "base power along tangent and bitangent in place of one power: --anisotropic-power 400 20",
        numberReader<float>(1e-30, 1e30, [&a](float power) { a.anisotropicPower.push_back(power); }));
    addText(command, "--tangent-rotation", "FILE",
            "rotation of the anisotropy axes, 0 to pi (channel 0, 0 to 1)", a.tangentRotation);
    addText(command, "--specular", "NUMBER|R,G,B|FILE", "specular reflectance Ks", a.specular)
        .byDefault(a.specular);
    addText(command, "--diffuse", "NUMBER|R,G,B|FILE", "diffuse reflectance Kd", a.diffuse)
        .byDefault(a.diffuse);
}

void addFit(Command& command, BakeArguments& a)
{
    addChoice(command, "--model", kModelNames, "specular lobe that is fitted", a.options.model);
    addChoice(command, "--method", kFilterNames, kFilterHelp, a.options.method);
    addNumber(command, "--precision", 0.0, 1.0, "",
              "closed forms with less error stay, and the fit may be that much worse; 0 is slow and exact",
              a.options.precision);
    addChoice(command, "--lobes", kLobeNames, kLobesHelp, a.options.lobes);
    addNumber(command, "--reduce", 0, 13, "", "drop the N finest levels: level 0 is then fitted",
              a.options.reduce);
    addChoice(command, "--reconstruction", kReconstructionNames,
              "footprint of a texel: its box, or all that bilinear lookups blend it into",
              a.options.reconstruction);
    addNumber(command, "--threads", 0, 1024, "", "0: one per core", a.options.threads);
}

// "2/8": the second of eight.
std::string readShard(const std::string& text, baker::Shard& shard)
{
    const size_t slash = text.find('/');
    const auto index = numberFrom<int>(text.substr(0, slash));
    const auto count = slash == std::string::npos ? std::nullopt : numberFrom<int>(text.substr(slash + 1));
    if (!index || !count || *count < 1 || *index < 1 || *index > *count)
        return "not I/N with I from 1 to N";
    shard = {size_t(*index - 1), size_t(*count)};
    return "";
}

void addOutput(Command& command, BakeArguments& a)
{
    command.addFlag("--float", "store single precision in place of half", a.asFloat);
    addText(command, "-o,--output", "FILE", "OpenEXR file to write; of a model, the .glb or .gltf", a.output);
    addChoice(command, "--textures", kModelTextureNames,
              "of a model: ktx2 writes the maps with all levels beside it", a.ktx2Textures);
    const Option folder = addText(command, "--export", "FOLDER",
                                  "write maps for other engines, too (lumel export)", a.exportFolder);
    addExportFormat(command, a.exported).needs(folder);
    command.addRepeated("--report", "FILE", "write how exact the bake is, .json or .html; may be repeated",
                        [&a](const std::string& file) {
                            a.reports.push_back(file);
                            const bool known = file.ends_with(".json") || file.ends_with(".html");
                            return known ? "" : "end the name in .json or .html";
                        });
    const Option manifest =
        addText(command, "--manifest", "FILE", "bake the maps that this JSON file lists", a.manifest);
    command
        .add("--shard", "I/N", "bake every N-th entry of the manifest, from the I-th (1..N) on",
             [&a](const std::string& text) { return readShard(text, a.shard); })
        .needs(manifest);
}

// A model brings its own maps.
void checkModel(const BakeArguments& a, const Command& command)
{
    const std::set<std::string> known{"model",     "--model", "--method", "--precision", "--lobes",
                                      "--threads", "--float", "--output", "--textures",  "--reconstruction"};
    for (const Option& option : command.given())
        if (!known.contains(option.name()))
            throw UsageError("a model excludes " + option.name());
    if (a.output.extension() != ".glb" && a.output.extension() != ".gltf")
        throw UsageError("--output of a model must end in .glb or .gltf");
}

void check(const BakeArguments& a, const Command& command)
{
    if (!a.manifest.empty()) {
        const std::set<std::string> defaults{"--manifest", "--shard", "--threads", "--method", "--model"};
        for (const Option& option : command.given())
            if (!defaults.contains(option.name()))
                throw UsageError("--manifest excludes " + option.name());
        return;
    }
    if (!a.model.empty()) {
        checkModel(a, command);
        return;
    }
    if (command.get("--textures").given())
        throw UsageError("--textures goes with a model");
    if (a.height.empty() && a.normal.empty())
        throw UsageError("a model, --height or --normal is required");
    if (a.output.empty())
        throw UsageError("--output is required");
}

} // namespace

void addBake(CommandLine& line, BakeArguments& a)
{
    Command command = line.add("bake", "Fit reflectance MIP levels to a height or normal map, or a model's");
    addText(command, "model", "FILE", "glTF file whose materials are all baked, in place of maps", a.model);
    addSurface(command, a);
    addReflectance(command, a);
    addFit(command, a);
    addOutput(command, a);
    command.afterParsing([&a, command] { check(a, command); });
}

} // namespace lumel
