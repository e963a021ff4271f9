// Every glTF in Debian's assimp-testmodels, right or wrong on purpose: it loads with its images, or it is
// refused with one line. LUMEL_TABLE=1 prints which, and why.
#include "gltf_builder.h"
#include "scene/material_maps.h"
#include <algorithm>

namespace lumel::scene {
namespace {

const std::filesystem::path kModels = "/usr/share/assimp/models";

std::vector<std::filesystem::path> modelFiles()
{
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(kModels))
        if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb")
            files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

// What loading says: the number of objects, or the message after the file's name.
std::string outcome(const std::filesystem::path& file, bool& loaded)
{
    size_t objects = 0;
    const std::string message = errorOf([&] {
        const Scene scene = loadGltf(file);
        for (const Material& material : scene.materials) {
            reflectanceMaps(scene, material);
            emissiveImage(scene, material);
            opacityImage(scene, material);
        }
        objects = scene.objects.size();
    });
    loaded = message.empty();
    return loaded ? std::to_string(objects) + " objects" : message;
}

TEST(AssimpModels, LoadOrAreRefusedInOneLine)
{
    if (!std::filesystem::is_directory(kModels))
        GTEST_SKIP() << "no " << kModels << "; install assimp-testmodels";
    const bool print = std::getenv("LUMEL_TABLE") != nullptr;
    size_t loadedCount = 0, count = 0;
    for (const std::filesystem::path& file : modelFiles()) {
        bool loaded = false;
        std::string text = outcome(file, loaded);
        const bool namesFile = text.rfind(file.parent_path().string(), 0) == 0;
        EXPECT_TRUE(loaded || (namesFile && contains(text, "; "))) << file << ": " << text;
        loadedCount += loaded;
        ++count;
        if (!print)
            continue;
        const std::string name = file.string(), short_ = name.substr(kModels.string().size() + 1);
        if (const size_t at = text.find(name); at == 0)
            text.erase(0, name.size() + 2);
        std::printf("%-72s %s: %s\n", short_.c_str(), loaded ? "loaded " : "refused", text.c_str());
    }
    if (print)
        std::printf("%zu of %zu loaded\n", loadedCount, count);
    EXPECT_GE(count, 45u);
}

TEST(AssimpModels, TheRightOnesLoad)
{
    if (!std::filesystem::is_directory(kModels))
        GTEST_SKIP() << "no " << kModels << "; install assimp-testmodels";
    for (const char* name :
         {"BoxTextured-glTF/BoxTextured.gltf", "BoxTextured-glTF-Embedded/BoxTextured.gltf",
          "BoxTextured-glTF-Binary/BoxTextured.glb",
          "BoxTextured-glTF-pbrSpecularGlossiness/BoxTextured.gltf", "draco/2CylinderEngine.gltf",
          "2CylinderEngine-glTF-Binary/2CylinderEngine.glb", "ClearCoat-glTF/ClearCoatTest.gltf",
          "simple_skin/simple_skin.gltf", "textureTransform/TextureTransformTest.gltf"}) {
        bool loaded = false;
        const std::string text = outcome(kModels / "glTF2" / name, loaded);
        EXPECT_TRUE(loaded) << name << ": " << text;
    }
}

} // namespace
} // namespace lumel::scene
