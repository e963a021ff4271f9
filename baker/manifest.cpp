#include "manifest.h"
#include "core/error.h"
#include "core/file.h"
#include "report.h"
#include <chrono>
#include <fmt/format.h>
#include <map>
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
        for (const auto& [name, value] : json.items()) {
            std::string key = name;
            std::replace(key.begin(), key.end(), '-', '_');
            try {
                read(key, value);
            } catch (const Json::exception&) { // not the type that the option takes
                throw Error(fmt::format("option '{}' is malformed; see lumel bake --help", name));
            }
        }
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
        else if (key == "power_map")
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
                                             {"lean", Method::lean},
                                             {"fit-power", Method::fitPower}});
        else if (key == "model")
            options.model = choice<Model>(
                value, key,
                {{"blinn-phong", Model::blinnPhong}, {"ashikhmin-shirley", Model::ashikhminShirley}});
        else if (key == "threads")
            options.threads = value.get<int>();
        else if (key == "float")
            asFloat = value.get<bool>();
        else if (key == "report")
            for (const Json& name : value.is_array() ? value : Json::array({value}))
                reports.push_back(folder_ / name.get<std::string>());
        else if (key == "precision")
            options.precision = value.get<float>();
        else if (key == "lobes")
            options.lobes = choice<LobeCount>(
                value.is_number() ? Json(value.dump()) : value, key,
                {{"1", LobeCount::one}, {"2", LobeCount::two}, {"auto", LobeCount::automatic}});
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
    std::vector<fs::path> reports;
    Maps maps;
    Options options;
    bool asFloat = false;

    bool isUpToDate() const
    {
        bool isFloat = false;
        for (const fs::path& report : reports)
            if (!fs::exists(report))
                return false;
        return bakedSource(output, &isFloat) == sourceHash(maps, options) && isFloat == asFloat;
    }

    // `share` units of `whole` are this entry's.
    void bakeAll(Progress& whole, size_t share) const
    {
        for (const fs::path& file : reports)
            checkWritable(file);
        checkWritable(output);
        const size_t units = progressUnits(maps) + (reports.empty() ? 0 : measureUnits(maps, options));
        Progress progress(whole, share, units);
        const auto start = std::chrono::steady_clock::now();
        if (reports.empty()) {
            bakeExr(output, maps, options, asFloat, &progress);
            return;
        }
        const ReflectanceMips mips = bake(maps, options, &progress);
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
        writeExr(output, mips, asFloat);
        Report report = makeReport(maps, options, mips, seconds.count(), &progress);
        report.name = output.filename().string();
        for (const fs::path& file : reports)
            writeReport(file, report);
    }
};

// What an entry names as its files, the chain first; empty where it names none.
std::vector<fs::path> outputsOf(const Json& entry, const fs::path& folder)
{
    std::vector<fs::path> files;
    const auto add = [&](const Json& name) {
        if (name.is_string())
            files.push_back(folder / name.get<std::string>());
    };
    if (!entry.is_object() || !entry.contains("output"))
        return files;
    add(entry["output"]);
    if (const Json reports = entry.value("report", Json::array()); reports.is_array())
        std::ranges::for_each(reports, add);
    else
        add(reports);
    return files;
}

// Which entry writes a file.
class Owners {
public:
    // What is wrong where an earlier entry writes one of them, or nothing.
    std::string claim(const std::vector<fs::path>& files, size_t entry)
    {
        std::string wrong;
        for (const fs::path& file : files)
            if (const auto [twin, isNew] = owners_.try_emplace(file.lexically_normal(), entry); !isNew)
                wrong = fmt::format("entry {} writes {} too, like entry {}; give it another name", entry,
                                    file.string(), twin->second);
        return wrong;
    }

private:
    std::map<fs::path, size_t> owners_;
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

ManifestResult bakeManifest(const fs::path& manifest, const Options& defaults, bool print, Shard shard)
{
    const Json json = parse(manifest);
    const fs::path folder = manifest.parent_path();
    ManifestResult result;
    constexpr size_t kUnits = 1000; // of the progress bar per entry: sizes are known only once maps are read
    Progress progress("bake " + manifest.filename().string(), json.size() * kUnits);
    const auto tell = [&](const std::string& line) {
        if (print)
            progress.print(line);
    };
    Owners owners;
    for (size_t i = 0; i < json.size(); ++i) {
        const std::vector<fs::path> files = outputsOf(json[i], folder);
        const std::string twin = owners.claim(files, i + 1); // also for other shards
        if (i % shard.count != shard.index)
            continue;
        const std::string name = files.empty() ? fmt::format("entry {}", i + 1) : files.front().string();
        try {
            if (!twin.empty())
                throw Error(twin);
            const Entry entry(json[i], folder, defaults);
            if (entry.isUpToDate()) {
                ++result.upToDate;
                tell(name + ": up to date");
            } else {
                std::ranges::for_each(files, removeLeftovers);
                entry.bakeAll(progress, kUnits);
                ++result.baked;
                tell(name + ": baked");
            }
        } catch (const Interrupted&) {
            throw;
        } catch (const std::exception& e) {
            const std::string why = e.what();
            result.failures.push_back(fmt::format("{}: {}", name, why.substr(0, why.find('\n'))));
            tell(fmt::format("{}: failed: {}", name, why.substr(0, why.find('\n'))));
        }
        progress.advanceTo((i + 1) * kUnits);
    }
    return result;
}

} // namespace lumel::baker
