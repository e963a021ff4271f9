// loadGltf(): document, JSON, materials, nodes. Each step is a file of its own, *.cpp.
#include "gltf.h"
#include "charts/lit_uvs.h"
#include "reader.h"
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

namespace lumel::scene {
namespace {

// tinygltf's messages span lines and repeat themselves.
std::string firstLine(const std::string& text)
{
    std::string line = text.substr(0, text.find('\n'));
    return line.empty() ? "damaged glTF" : line.substr(0, 160);
}

// tinygltf never sees a file name. Should it ask for a file all the same, there is none.
tinygltf::FsCallbacks noFiles()
{
    tinygltf::FsCallbacks callbacks{};
    callbacks.FileExists = [](const std::string&, void*) { return false; };
    callbacks.ExpandFilePath = [](const std::string& path, void*) { return path; };
    callbacks.ReadWholeFile = [](std::vector<unsigned char>*, std::string*, const std::string&, void*) {
        return false;
    };
    callbacks.WriteWholeFile = [](std::string*, const std::string&, const std::vector<unsigned char>&,
                                  void*) { return false; };
    return callbacks;
}

void parseModel(Reader& reader)
{
    tinygltf::TinyGLTF parser;
    parser.SetFsCallbacks(noFiles());
    std::string error, warning;
    const std::string& json = reader.document.json;
    try {
        const bool ok = parser.LoadASCIIFromString(&reader.model, &error, &warning, json.data(),
                                                   static_cast<unsigned>(json.size()), "");
        if (ok && error.empty())
            return;
    } catch (const std::exception& e) { // values of an unexpected type
        error = e.what();
    }
    reader.fail(firstLine(error));
}

// One line for an object; a file with very many gets a sum.
void logUnlit(const Scene& scene)
{
    constexpr size_t kMaxLines = 12;
    size_t count = 0;
    for (const Object& object : scene.objects) {
        const std::string& problem = scene.meshes[size_t(object.mesh)].uvProblem;
        const bool blended = scene.materials[size_t(object.material)].alphaMode != AlphaMode::opaque;
        if (!problem.empty() && !blended && ++count <= kMaxLines)
            spdlog::info("{}: '{}' is drawn forward: {}", scene.file.string(), object.name, problem);
    }
    if (count > kMaxLines)
        spdlog::info("{}: {} more objects are drawn forward", scene.file.string(), count - kMaxLines);
}

Scene readMaterialsOnly(Reader& reader, const std::filesystem::path& file)
{
    parseModel(reader);
    Scene scene;
    scene.file = file;
    readImages(reader, scene);
    readMaterials(reader, scene);
    return scene;
}

Scene readScene(Reader& reader, const std::filesystem::path& file)
{
    Scene scene = readMaterialsOnly(reader, file);
    readNodes(reader, scene);
    if (scene.objects.empty())
        reader.fail("no triangles in its default scene", "export a mesh");
    if (!reader.document.ignored.empty())
        spdlog::info("{}: ignored: {}", reader.document.file, fmt::join(reader.document.ignored, ", "));
    unwrapMeshes(scene);
    logUnlit(scene);
    return scene;
}

template<class Read>
Scene readDocumentAnd(const std::filesystem::path& file, const Read& read)
{
    Reader reader;
    reader.document.file = file.string();
    try {
        reader.document = readDocument(file);
        return read(reader, file);
    } catch (const std::bad_alloc&) { // the limits above allow more than some machines have
        reader.fail("needs more memory than there is", "split the model");
    }
}

} // namespace

Scene loadGltf(const std::filesystem::path& file)
{
    return readDocumentAnd(file, readScene);
}

Scene loadMaterials(const std::filesystem::path& file)
{
    return readDocumentAnd(file, readMaterialsOnly);
}

} // namespace lumel::scene
