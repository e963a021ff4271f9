#include "lit_uvs.h"
#include "core/error.h"
#include "core/file.h"
#include "unwrap.h"
#include "uv_check.h"
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

namespace lumel::scene {
namespace {

constexpr uint32_t kUnwrapVersion = 1;         // raise when charts.cpp or unwrap.cpp change their results
constexpr size_t kLeastCachedTriangles = 2000; // fewer are unwrapped in less time than a file takes

// The file's first bytes; arrays of vertexCount sources, vertexCount UVs and indexCount indices follow, then
// the 32 digits of a hash of all that.
struct Header {
    char magic[8] = {'l', 'u', 'm', 'e', 'l', 'u', 'v', '1'};
    uint32_t charts;
    float gap;
    uint64_t vertexCount, indexCount;
};
constexpr size_t kHashDigits = 32;

std::string cacheKey(const Mesh& mesh)
{
    ContentHash hash;
    hash.addValue(kUnwrapVersion).addValue(mesh.vertices.size()).addValue(mesh.indices.size());
    for (const Vertex& v : mesh.vertices)
        hash.addValue(v.position);
    return hash.add(mesh.indices.data(), mesh.indices.size() * sizeof(uint32_t)).hex();
}

template<class T>
void append(std::string& text, const T* data, size_t count)
{
    text.append(reinterpret_cast<const char*>(data), count * sizeof(T));
}

std::string encoded(const Unwrapping& u)
{
    Header header;
    header.charts = u.charts;
    header.gap = u.gap;
    header.vertexCount = u.sources.size();
    header.indexCount = u.indices.size();
    std::string text;
    append(text, &header, 1);
    append(text, u.sources.data(), u.sources.size());
    append(text, u.uvs.data(), u.uvs.size());
    append(text, u.indices.data(), u.indices.size());
    return text + ContentHash().add(text.data(), text.size()).hex();
}

// Nothing for whatever is damaged, or of another mesh.
std::optional<Unwrapping> decoded(std::span<const std::byte> bytes, const Mesh& mesh)
{
    Header header, ours;
    if (bytes.size() < sizeof(header) + kHashDigits)
        return std::nullopt;
    const size_t content = bytes.size() - kHashDigits;
    std::memcpy(&header, bytes.data(), sizeof(header));
    constexpr size_t kVertexBytes = sizeof(uint32_t) + sizeof(glm::vec2);
    if (std::memcmp(header.magic, ours.magic, sizeof(ours.magic)) != 0 ||
        header.indexCount != mesh.indices.size() || header.vertexCount > header.indexCount ||
        content !=
            sizeof(header) + header.vertexCount * kVertexBytes + header.indexCount * sizeof(uint32_t) ||
        std::memcmp(ContentHash().add(bytes.data(), content).hex().data(), bytes.data() + content,
                    kHashDigits) != 0)
        return std::nullopt;
    Unwrapping u;
    u.charts = header.charts;
    u.gap = header.gap;
    const std::byte* from = bytes.data() + sizeof(header);
    const auto take = [&](auto& array, size_t count) {
        array.resize(count);
        std::memcpy(array.data(), from, count * sizeof(array[0]));
        from += count * sizeof(array[0]);
    };
    take(u.sources, header.vertexCount);
    take(u.uvs, header.vertexCount);
    take(u.indices, header.indexCount);
    const auto below = [](const std::vector<uint32_t>& array, size_t limit) {
        return std::all_of(array.begin(), array.end(), [&](uint32_t i) { return i < limit; });
    };
    if (!below(u.sources, mesh.vertices.size()) || !below(u.indices, u.sources.size()))
        return std::nullopt;
    return u;
}

// The cached result or a new one. Trouble with the cache costs time, nothing else.
Unwrapping unwrapCached(const Mesh& mesh)
{
    if (mesh.indices.size() / 3 < kLeastCachedTriangles)
        return unwrap(mesh);
    std::filesystem::path file;
    try {
        file = cacheFolder() / (cacheKey(mesh) + ".unwrap");
        if (std::filesystem::exists(file))
            if (auto found = decoded(readFile(file), mesh))
                return std::move(*found);
    } catch (const std::exception& e) {
        spdlog::debug("{}; unwrapped again", e.what());
    }
    Unwrapping result = unwrap(mesh);
    try {
        if (!file.empty())
            writeFileAtomically(file, encoded(result));
    } catch (const Error& e) {
        spdlog::debug("{}; unwrapped again on each run", e.what());
    }
    return result;
}

void unwrapMesh(Mesh& mesh)
{
    try {
        Mesh unwrapped = mesh;
        apply(unwrapCached(mesh), unwrapped);
        unwrapped.uvProblem = findUvProblem(unwrapped);
        if (unwrapped.uvProblem.empty())
            mesh = std::move(unwrapped);
        else
            mesh.uvProblem += "; unwrapped they still do not fit";
    } catch (const Error& e) {
        mesh.uvProblem += fmt::format("; {}", e.what());
    }
}

void logUnwrapped(const Scene& scene, const std::vector<size_t>& meshes)
{
    constexpr size_t kMostLines = 12;
    size_t count = 0;
    for (size_t i : meshes) {
        const Mesh& mesh = scene.meshes[i];
        if (!mesh.unwrapped || ++count > kMostLines)
            continue;
        const UnwrapReport& r = *mesh.unwrapped;
        spdlog::info("{}: mesh '{}' unwrapped: {} charts, stretch {:.2f} (at most {:.2f}), density {:.2f} to "
                     "{:.2f}, {:.0f} % of the texture",
                     scene.file.string(), mesh.name, r.charts, r.meanStretch, r.worstStretch, r.leastDensity,
                     r.greatestDensity, 100.0f * r.coveredShare);
    }
    if (count > kMostLines)
        spdlog::info("{}: {} more meshes unwrapped", scene.file.string(), count - kMostLines);
}

} // namespace

void chooseLitUvs(std::span<const std::vector<glm::vec2>> sets, Mesh& mesh)
{
    mesh.uvProblem = "no UVs";
    std::string firstProblem;
    const std::vector<glm::vec2>* first = nullptr;
    const auto use = [&](const std::vector<glm::vec2>& set) {
        for (size_t i = 0; i < set.size(); ++i)
            mesh.vertices[i].uv = set[i];
    };
    for (const std::vector<glm::vec2>& set : sets) {
        if (set.empty())
            continue;
        use(set);
        mesh.uvProblem = findUvProblem(mesh);
        if (mesh.uvProblem.empty())
            return;
        if (!first) {
            first = &set;
            firstProblem = mesh.uvProblem;
        }
    }
    if (first) {
        use(*first);
        mesh.uvProblem = firstProblem;
    }
}

void unwrapMeshes(Scene& scene)
{
    std::vector<bool> lit(scene.meshes.size(), false);
    for (const Object& object : scene.objects)
        if (scene.materials[size_t(object.material)].alphaMode == AlphaMode::opaque)
            lit[size_t(object.mesh)] = true;
    std::vector<size_t> meshes;
    for (size_t i = 0; i < lit.size(); ++i)
        if (lit[i] && !scene.meshes[i].uvProblem.empty())
            meshes.push_back(i);
    tbb::parallel_for(size_t(0), meshes.size(), [&](size_t i) { unwrapMesh(scene.meshes[meshes[i]]); });
    logUnwrapped(scene, meshes);
}

} // namespace lumel::scene
