#include "options.h"
#include <set>

namespace lumel {

const std::map<std::string, baker::Method> kMethods = {
    {"fit", baker::Method::fit},       {"average", baker::Method::average}, {"flat", baker::Method::flat},
    {"height", baker::Method::height}, {"toksvig", baker::Method::toksvig}, {"lean", baker::Method::lean}};
const std::map<std::string, baker::Model> kModels = {{"ashikhmin-shirley", baker::Model::ashikhminShirley},
                                                     {"blinn-phong", baker::Model::blinnPhong}};

namespace {

const std::map<std::string, baker::Reconstruction> kReconstructions = {
    {"box", baker::Reconstruction::box}, {"bilinear", baker::Reconstruction::bilinear}};
const std::map<std::string, baker::Wrap> kWraps = {{"repeat", baker::Wrap::repeat},
                                                   {"clamp", baker::Wrap::clamp}};

} // namespace

void addBake(CLI::App& app, BakeArguments& a)
{
    CLI::App* command = app.add_subcommand("bake", "Fit reflectance MIPs to a height or normal map");
    auto* height = command->add_option("--height", a.height, "height map (channel 0)");
    command->add_option("--height-scale", a.heightScale, "height of value 1 in units of the map's width")
        ->needs(height);
    auto* normal = command->add_option("--normal", a.normal, "tangent-space normal map");
    normal->excludes(height);
    command->add_option("--normal-green", a.normalGreen, "which way the normal map's green points")
        ->check(CLI::IsMember({"up", "down"}))
        ->capture_default_str();
    command->add_option("--wrap", a.wrap, "what lies beyond the map's border: repeat or clamp")
        ->transform(CLI::CheckedTransformer(kWraps).description(""))
        ->default_str("repeat");
    command->add_option("--power", a.power, "Blinn-Phong power of every texel")->capture_default_str();
    command->add_option("--power-map", a.powerMap, "Blinn-Phong power, as stored (channel 0, float image)");
    command->add_option("--roughness", a.roughness,
                        "glTF perceptual roughness (channel 0) in place of a power");
    command
        ->add_option("--anisotropic-power", a.anisotropicPower,
                     "base power along T and B in place of one power: --anisotropic-power 400 20")
        ->expected(2)
        ->check(CLI::PositiveNumber);
    command->add_option("--tangent-rotation", a.tangentRotation,
                        "turns the anisotropy axes by 0 to pi (channel 0 from 0 to 1)");
    command->add_option("--specular", a.specular, "Ks: a number, r,g,b or an image")->capture_default_str();
    command->add_option("--diffuse", a.diffuse, "Kd: a number, r,g,b or an image")->capture_default_str();
    command->add_option("--model", a.options.model, "lobe to fit: ashikhmin-shirley or blinn-phong")
        ->transform(CLI::CheckedTransformer(kModels).description(""))
        ->default_str("ashikhmin-shirley");
    command->add_option("--method", a.options.method, kMethodHelp)
        ->transform(CLI::CheckedTransformer(kMethods).description(""))
        ->default_str("fit");
    command->add_option("--reduce", a.options.reduce, "drop the N finest levels: level 0 is then fitted")
        ->check(CLI::Range(0, 13));
    command
        ->add_option("--reconstruction", a.options.reconstruction, "what a texel stands for: box or bilinear")
        ->transform(CLI::CheckedTransformer(kReconstructions).description(""))
        ->default_str("box");
    command->add_option("--threads", a.options.threads, "0 = all cores")->check(CLI::Range(0, 1024));
    command->add_flag("--float", a.asFloat, "store single precision in place of half");
    command->add_option("-o,--output", a.output, "OpenEXR file to write");
    command->add_option("--report", a.reports, "write how exact the bake is: .json, .html; may be repeated")
        ->take_all()
        ->expected(1)
        ->check(CLI::Validator(
            [](const std::string& file) {
                const bool known = file.ends_with(".json") || file.ends_with(".html");
                return known ? std::string() : file + ": end the name in .json or .html";
            },
            ""));
    auto* manifest = command->add_option("--manifest", a.manifest, "bake the maps that this JSON file lists");
    command->callback([&a, command, manifest] {
        if (manifest->count() > 0) {
            const std::set<std::string> defaults{"--manifest", "--threads", "--method", "--model"};
            for (const CLI::Option* option : command->get_options())
                if (option->count() > 0 && !defaults.contains(option->get_name()))
                    throw CLI::ExcludesError("--manifest", option->get_name());
            return;
        }
        if (a.height.empty() && a.normal.empty())
            throw CLI::RequiredError("--height or --normal");
        if (a.output.empty())
            throw CLI::RequiredError("--output");
    });
}

void addCompare(CLI::App& app, CompareArguments& a)
{
    CLI::App* command = app.add_subcommand("compare", "Measure how two pictures differ");
    command->add_option("a", a.a, "picture (.exr is tone-mapped first)")->required();
    command->add_option("b", a.b, "picture of the same size")->required();
    command->add_option("-o,--output", a.output, "write four times the difference as a picture");
    command->add_option("--psnr-min", a.psnrMin, "exit 1 below this PSNR in dB");
}

} // namespace lumel
