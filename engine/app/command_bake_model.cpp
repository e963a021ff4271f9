// lumel bake MODEL: every material baked, the model written again with maps of GGX lobes. The JSON and the
// buffers are copied as they are; only materials' normal and roughness textures are exchanged, and what they
// refer to is added, so that nothing is lost that Lumel does not know.
#include "commands.h"
#include "core/error.h"
#include "core/file.h"
#include "export/export_maps.h"
#include "export/gltf_unused.h"
#include "export/ktx2.h"
#include "gltf/gltf.h"
#include "gltf/uri.h"
#include "scene/material_images.h"
#include "scene/material_maps.h"
#include "scene/own_chains.h"
#include <chrono>
#include <cstring>
#include <fmt/format.h>

namespace lumel {
namespace {

namespace fs = std::filesystem;
using baker::ExportMap;
using baker::GltfFile;
using baker::GltfJson;

// The texture that sets where all maps of a material are read, as the reader chooses it: null without one.
const GltfJson* placingTexture(const GltfJson& material)
{
    static const GltfJson::json_pointer places[] = {
        GltfJson::json_pointer("/normalTexture"),
        GltfJson::json_pointer("/pbrMetallicRoughness/baseColorTexture"),
        GltfJson::json_pointer("/pbrMetallicRoughness/metallicRoughnessTexture"),
        GltfJson::json_pointer("/extensions/KHR_materials_specular/specularTexture"),
        GltfJson::json_pointer("/extensions/KHR_materials_specular/specularColorTexture"),
        GltfJson::json_pointer("/extensions/KHR_materials_anisotropy/anisotropyTexture")};
    for (const auto& place : places)
        if (material.contains(place))
            return &material.at(place);
    return nullptr;
}

// Of the formats that glTF allows in buffer views; null for others.
const char* mimeTypeOf(std::span<const std::byte> bytes)
{
    const auto begins = [&](const char* with, size_t count) {
        return bytes.size() > 12 && std::memcmp(bytes.data(), with, count) == 0;
    };
    if (begins("\x89PNG", 4))
        return "image/png";
    if (begins("\xff\xd8\xff", 3))
        return "image/jpeg";
    return begins("RIFF", 4) ? "image/webp" : nullptr;
}

class ModelBake {
public:
    explicit ModelBake(const BakeArguments& arguments)
        : arguments_(arguments), scene_(scene::loadMaterials(arguments.model)),
          file_(baker::readGltfFile(arguments.model)), files_(folderOf(arguments.output)),
          stem_(arguments.output.stem().string()), isBinary_(arguments.output.extension() == ".glb")
    {
        if (isBinary_)
            takeFirstBuffer();
        for (const scene::SceneImage& image : scene_.images)
            imageHashes_.push_back(scene::imageHash(image.bytes));
    }

    // Returns how many materials were baked.
    size_t run()
    {
        size_t baked = 0;
        for (size_t i = 0; i < scene_.materials.size(); ++i)
            baked += bake(i) ? 1 : 0;
        baker::dropUnused(file_, counts_, replaced_);
        if (isBinary_)
            embedImages();
        write();
        checkNames();
        copyReferences();
        files_.publish();
        return baked;
    }
    size_t materials() const { return scene_.materials.size(); }

private:
    static fs::path folderOf(const fs::path& file)
    {
        return file.has_parent_path() ? file.parent_path() : fs::path(".");
    }

    fs::path fileOf(const std::string& uri) const
    {
        return scene::resolveUri(arguments_.model.string(), arguments_.model.parent_path(), uri);
    }

    // In a .glb, what is added goes into buffer 0, which must be the binary chunk then.
    void takeFirstBuffer()
    {
        if (!file_.json.contains("buffers") || file_.json["buffers"].empty())
            return;
        GltfJson& buffer = file_.json["buffers"][0];
        if (const auto uri = buffer.find("uri"); uri != buffer.end()) {
            const std::string text = *uri;
            file_.binary = scene::isDataUri(text) ? scene::decodeDataUri(arguments_.model.string(), text)
                                                  : readFile(fileOf(text));
            buffer.erase(uri);
        }
        const size_t length = buffer.at("byteLength");
        if (file_.binary.size() < length)
            throw Error(fmt::format("{}: its first buffer has no data to add to; write a .gltf instead",
                                    arguments_.model.string()));
        file_.binary.resize(length); // without padding
    }

    bool bake(size_t index)
    {
        const scene::Material& material = scene_.materials[index];
        forgetBake(index);
        if (material.unlit)
            return false;
        baker::Maps maps = scene::reflectanceMaps(scene_, material);
        const glm::ivec2 size = baker::mapSize(maps);
        if (size == glm::ivec2(1))
            return false; // uniform: every level is the same
        Progress progress(fmt::format("baking {}/{} {}", index + 1, scene_.materials.size(), material.name),
                          2 * baker::progressUnits(maps));
        baker::ReflectanceMips mips;
        try {
            mips = baker::bake(maps, arguments_.options, &progress);
        } catch (const Error& e) { // the baker knows maps, not files
            throw Error(
                fmt::format("{}: material '{}': {}", arguments_.model.string(), material.name, e.what()));
        }
        const std::string name = fmt::format("{}_{}", stem_, index);
        baker::writeExr(files_.path(name + ".exr"), mips, arguments_.asFloat);
        scene::Material written = exchange(index, name, mapsOf(material, maps, std::move(mips)));
        GltfJson& ours = oursOf(index);
        ours["baked"] = name + ".exr";
        ours["maps"] = scene::mapsHash(written, imageHashes_);
        return true;
    }

    // extras.lumel of a material. Extras may be anything: what is no object moves into one.
    GltfJson& oursOf(size_t index)
    {
        GltfJson& extras = file_.json["materials"][index]["extras"];
        if (!extras.is_object() && !extras.is_null())
            extras = GltfJson{{"extras", extras}};
        return extras["lumel"];
    }

    // What an earlier bake wrote.
    void forgetBake(size_t index)
    {
        const GltfJson::json_pointer place("/extras/lumel");
        GltfJson& material = file_.json["materials"][index];
        if (!material.contains(place))
            return;
        for (const char* key : {"baked", "maps", "textures"})
            material[place].erase(key);
    }

    // Normal and metallic-roughness maps: all levels if files hold them, else the first.
    std::vector<ExportMap> mapsOf(const scene::Material& material, const baker::Maps& maps,
                                  baker::ReflectanceMips mips)
    {
        if (!arguments_.ktx2Textures)
            mips.levels.resize(1);
        Image roughness = maps.roughness;
        if (roughness.empty() && material.metallicRoughnessImage < 0 && !material.specularGlossiness &&
            material.power <= 0.0f) {
            roughness = Image(1, 1, 1);
            roughness.pixels = {material.roughness};
        }
        const auto levels = baker::fitGgx(mips, {.threads = arguments_.options.threads,
                                                 .roughness = roughness.empty() ? nullptr : &roughness});
        std::vector<ExportMap> result = baker::makeMaps(levels, {});
        result.resize(2);
        setMetalness(material, result[1]);
        return result;
    }

    // Metalness as the file has it: what the colours of a chain say of it is less.
    void setMetalness(const scene::Material& material, ExportMap& map) const
    {
        scene::MaterialImages images(scene_);
        const Image* image =
            images.get(material.metallicRoughnessImage, material.metallicRoughnessUv, material.uv);
        Image metalness(map.levels[0].width, map.levels[0].height, 1);
        const Image sized = image ? scene::resized(*image, metalness.width, metalness.height) : Image();
        for (int y = 0; y < metalness.height; ++y)
            for (int x = 0; x < metalness.width; ++x)
                *metalness.at(x, y) = image ? scene::texel(sized, x, y, 2) : 1.0f;
        const std::vector<Image> levels = scene::mipChain(std::move(metalness));
        for (size_t l = 0; l < map.levels.size(); ++l)
            for (size_t i = 0; i < levels[l].pixels.size(); ++i)
                map.levels[l].pixels[3 * i + 2] = levels[l].pixels[i];
    }

    // Sets a texture of the material, read where its others are. Returns the image's place in imageHashes_.
    int replace(GltfJson& info, const std::string& name, const ExportMap& map, const GltfJson* placing)
    {
        if (info.contains("index"))
            replaced_.insert(info["index"].get<size_t>());
        const std::vector<unsigned char> png = baker::pngOf(map);
        info = textureOf(fmt::format("{}_{}", name, map.name), png, placing);
        imageHashes_.push_back(scene::imageHash(std::as_bytes(std::span(png))));
        return int(imageHashes_.size()) - 1;
    }

    GltfJson textureOf(const std::string& name, const std::vector<unsigned char>& png,
                       const GltfJson* placing)
    {
        GltfJson texture = GltfJson::object(), info = GltfJson::object();
        if (placing) {
            info = *placing;
            const GltfJson& old = file_.json["textures"][info.at("index").get<size_t>()];
            if (old.contains("sampler"))
                texture["sampler"] = old["sampler"];
            info.erase("scale");
            info.erase("strength");
        }
        if (isBinary_) {
            texture["source"] = file_.addPng(name, png);
        } else {
            files_.write(name + ".png", std::as_bytes(std::span(png)));
            texture["source"] = file_.add("images", {{"name", name}, {"uri", name + ".png"}});
        }
        info["index"] = file_.add("textures", std::move(texture));
        return info;
    }

    // Returns the material as it is read from what is written.
    scene::Material exchange(size_t index, const std::string& name, const std::vector<ExportMap>& maps)
    {
        scene::Material material = scene_.materials[index];
        GltfJson json = file_.json["materials"][index]; // a copy: what is added to the root moves all of it
        const GltfJson placing = placingTexture(json) ? *placingTexture(json) : GltfJson();
        const GltfJson* place = placing.is_object() ? &placing : nullptr;
        if (material.normalImage >= 0 || material.heightImage >= 0) {
            material.normalImage = replace(json["normalTexture"], name, maps[0], place);
            material.normalScale = 1.0f;
        }
        if (material.metallicRoughnessImage >= 0 && !material.specularGlossiness) {
            GltfJson& pbr = json["pbrMetallicRoughness"];
            material.metallicRoughnessImage = replace(pbr["metallicRoughnessTexture"], name, maps[1], place);
            material.metallicRoughnessUv = material.uv;
            pbr.erase("roughnessFactor"); // it is in the map; the default is 1
            material.roughness = 1.0f;
        }
        file_.json["materials"][index] = std::move(json);
        if (!arguments_.ktx2Textures)
            return material;
        for (const ExportMap& map : maps) {
            const std::string file = fmt::format("{}_{}.ktx2", name, map.name);
            files_.write(file, baker::encodeKtx2(map, baker::TexelStorage::bytes, false));
            oursOf(index)["textures"][map.name] = file;
        }
        return material;
    }

    // A .glb holds its images: a file that can be moved alone.
    void embedImages()
    {
        if (!file_.json.contains("images"))
            return;
        GltfJson images = std::move(file_.json["images"]); // views that are added move the root's members
        for (GltfJson& image : images) {
            const std::string uri = image.value("uri", std::string());
            if (uri.empty() || scene::isDataUri(uri))
                continue;
            const std::vector<std::byte> bytes = readFile(fileOf(uri));
            const char* type = mimeTypeOf(bytes);
            if (!type)
                continue;
            image.erase("uri");
            image["mimeType"] = type;
            image["bufferView"] = file_.addView(bytes);
        }
        file_.json["images"] = std::move(images);
    }

    // Files of the model, as it names them in its folder.
    std::vector<std::string> references() const
    {
        std::vector<std::string> names;
        for (const char* key : {"buffers", "images"})
            for (const GltfJson& element : file_.json.value(key, GltfJson::array())) {
                const std::string uri = element.value("uri", std::string());
                if (!uri.empty() && !scene::isDataUri(uri))
                    names.push_back(
                        fileOf(uri).lexically_relative(folderOf(arguments_.model)).generic_string());
            }
        return names;
    }

    // What is written must not take the place of what the model reads.
    void checkNames() const
    {
        for (const std::string& name : files_.names())
            if (std::ranges::find(references_, name) != references_.end())
                throw Error(fmt::format("{}: the model reads a file of this name; choose another --output",
                                        (files_.folder() / name).string()));
    }

    // Files that the model refers to, beside it as before.
    void copyReferences()
    {
        if (fs::equivalent(folderOf(arguments_.model), files_.folder()))
            return;
        for (const std::string& name : references())
            if (std::ranges::find(files_.names(), name) == files_.names().end())
                files_.write(name, readFile(folderOf(arguments_.model) / name));
    }

    void write()
    {
        const std::string name = arguments_.output.filename().string();
        if (isBinary_) {
            files_.write(name, file_.glb());
            return;
        }
        if (!file_.binary.empty()) {
            file_.json["buffers"][0]["uri"] = stem_ + ".bin";
            files_.write(stem_ + ".bin", file_.binary);
        }
        files_.write(name, file_.json.dump(1, '\t') + "\n");
    }

    const BakeArguments& arguments_;
    const scene::Scene scene_;
    GltfFile file_;
    const baker::GltfCounts counts_{file_.json};
    const std::vector<std::string> references_{references()};
    std::set<size_t> replaced_;            // textures
    std::vector<std::string> imageHashes_; // of the model's images, then of those that were added
    baker::StagedFiles files_;
    const std::string stem_;
    const bool isBinary_;
};

} // namespace

void runBakeModel(const BakeArguments& arguments)
{
    const auto start = std::chrono::steady_clock::now();
    checkWritable(arguments.output);
    std::error_code code;
    if (fs::equivalent(arguments.model, arguments.output, code))
        throw Error(fmt::format("{}: is the model itself; give the baked one another name",
                                arguments.output.string()));
    ModelBake work(arguments);
    const size_t baked = work.run();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    fmt::print("{}: {} of {} materials baked, {:.2f} s\n", arguments.output.string(), baked, work.materials(),
               seconds.count());
}

} // namespace lumel
