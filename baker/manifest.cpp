#include "manifest.h"
#include "core/error.h"
#include "core/file.h"
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace lumel::baker {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::json;

template<class T>
T choice(const Json& value, const std::string& key, const std::vector<std::pair<const char*, T>>& names)
{
    const std::string text = value.get<std::string>();
    for (const auto& [name, result] : names)
        if (text == name)
            return result;
    throw Error(fmt::format("{} '{}' is unknown; see lumel bake --help", key, text));
}

class Entry {
public:
    Entry(const Json& json, fs::path folder, const Options& defaults)
        : folder_(std::move(folder)), options(defaults)
    {
        if (!json.is_object() || !json.contains("output"))
            throw Error("an entry without output; name the .exr to write");
        for (const auto& [key, value] : json.items())
            read(key, value);
    }

private:
    Image image(const Json& value) const { return readImage(folder_ / value.get<std::string>()); }

    void colour(const Json& value, Image& map, glm::vec3& constant) const
    {
        if (value.is_string())
            map = image(value);
        else if (value.is_array() && value.size() == 3)
            constant = {value[0].get<float>(), value[1].get<float>(), value[2].get<float>()};
        else
            constant = glm::vec3(value.get<float>());
    }

    void readMap(const std::string& key, const Json& value)
    {
        if (key == "height")
            maps.height = image(value);
        else if (key == "height_scale")
            maps.heightScale = value.get<float>();
        else if (key == "normal")
            maps.normal = image(value);
        else if (key == "normal_green")
            maps.normalGreenUp = choice<bool>(value, key, {{"up", true}, {"down", false}});
        else if (key == "power" && value.is_string())
            maps.power = image(value);
        else if (key == "power")
            maps.powerConstant = value.get<float>();
        else if (key == "roughness")
            maps.roughness = image(value);
        else if (key == "specular")
            colour(value, maps.specular, maps.specularConstant);
        else if (key == "diffuse")
            colour(value, maps.diffuse, maps.diffuseConstant);
        else if (key == "tangent_rotation")
            maps.tangentRotation = image(value);
        else if (key == "anisotropic_power" && value.is_array() && value.size() == 2)
            maps.anisotropicPower = {value[0].get<float>(), value[1].get<float>()};
        else if (key == "wrap")
            maps.wrap = choice<Wrap>(value, key, {{"repeat", Wrap::repeat}, {"clamp", Wrap::clamp}});
        else
            throw Error(fmt::format("option '{}' is unknown or malformed; see lumel bake --help", key));
    }

    void read(const std::string& key, const Json& value)
    {
        if (key == "output")
            output = folder_ / value.get<std::string>();
        else if (key == "method")
            options.method = choice<Method>(value, key,
                                            {{"fit", Method::fit},
                                             {"average", Method::average},
                                             {"flat", Method::flat},
                                             {"height", Method::height},
                                             {"toksvig", Method::toksvig},
                                             {"lean", Method::lean}});
        else if (key == "model")
            options.model = choice<Model>(
                value, key,
                {{"blinn-phong", Model::blinnPhong}, {"ashikhmin-shirley", Model::ashikhminShirley}});
        else if (key == "reduce")
            options.reduce = value.get<int>();
        else if (key == "reconstruction")
            options.reconstruction = choice<Reconstruction>(
                value, key, {{"box", Reconstruction::box}, {"bilinear", Reconstruction::bilinear}});
        else
            readMap(key, value);
    }

    fs::path folder_;

public:
    fs::path output;
    Maps maps;
    Options options;
};

Json parse(const fs::path& manifest)
{
    const std::vector<std::byte> bytes = readFile(manifest);
    const auto* text = reinterpret_cast<const char*>(bytes.data());
    Json json = Json::parse(text, text + bytes.size(), nullptr, false);
    if (!json.is_array())
        throw Error(
            fmt::format("{}: not a JSON list of bakes; write [{{\"output\": ...}}]", manifest.string()));
    return json;
}

} // namespace

std::string bakedSource(const fs::path& file)
{
    auto input = fs::is_regular_file(file) ? OIIO::ImageInput::open(file.string()) : nullptr;
    if (!input) {
        (void)OIIO::geterror();
        return "";
    }
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.get_string_attribute("lumel:version") != kVersion || spec.nchannels != kChannels)
        return "";
    return spec.get_string_attribute("lumel:source");
}

ManifestResult bakeManifest(const fs::path& manifest, const Options& defaults)
{
    const Json json = parse(manifest);
    ManifestResult result;
    constexpr size_t kUnits = 1000; // of the bar an entry: sizes are known only once maps are read
    Progress progress("bake " + manifest.filename().string(), json.size() * kUnits);
    for (size_t i = 0; i < json.size(); ++i) {
        std::string name = fmt::format("entry {}", i + 1);
        try {
            const Entry entry(json[i], manifest.parent_path(), defaults);
            name = entry.output.string();
            if (bakedSource(entry.output) == sourceHash(entry.maps, entry.options)) {
                ++result.upToDate;
            } else {
                writeExr(entry.output, bake(entry.maps, entry.options));
                ++result.baked;
            }
        } catch (const Interrupted&) {
            throw;
        } catch (const std::exception& e) {
            const std::string why = e.what();
            result.failures.push_back(fmt::format("{}: {}", name, why.substr(0, why.find('\n'))));
        }
        progress.advance(kUnits);
    }
    return result;
}

} // namespace lumel::baker
