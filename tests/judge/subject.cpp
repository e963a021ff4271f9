#include "subject.h"
#include "app/playback.h"
#include "caster/ray_caster.h"
#include "core/compare.h"
#include "scene/environment.h"
#include "shared/tonemap.h"
#include <cstdlib>

namespace lumel::test {
namespace {

// Node rotation that turns -Z towards a direction, +Y up.
json rotationTowards(glm::vec3 direction)
{
    const glm::vec3 back = -glm::normalize(direction);
    const glm::vec3 up = std::abs(back.y) > 0.99f ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
    const glm::vec3 right = glm::normalize(glm::cross(up, back));
    const glm::quat q = glm::quat_cast(glm::mat3(right, glm::cross(back, right), back));
    return {q.x, q.y, q.z, q.w};
}

template<class T>
std::vector<float> flat(const std::vector<T>& values)
{
    const auto* first = reinterpret_cast<const float*>(values.data());
    return {first, first + values.size() * sizeof(T) / sizeof(float)};
}

Image displayOf(const judge::Answer& answer)
{
    Image image(int(answer.size.x), int(answer.size.y), 3);
    for (size_t i = 0; i < answer.radiance.size(); ++i) {
        const glm::vec3 shown = shared::displayColour(answer.radiance[i], 1.0f);
        std::copy_n(&shown.x, 3, image.pixels.begin() + std::ptrdiff_t(3 * i));
    }
    return image;
}

Image rendered(const std::filesystem::path& file, const Look& look)
{
    scene::Scene scene = scene::loadGltf(file);
    if (look.environment) {
        Image grey(32, 16, 3);
        std::fill(grey.pixels.begin(), grey.pixels.end(), *look.environment);
        scene.environment = std::make_shared<const scene::Environment>(scene::makeEnvironment(grey));
    }
    // Level 0, all that the reference reads, is the same whichever method makes the others.
    const auto method = look.shading == Shading::reference ? baker::Method::average : baker::Method::fit;
    const auto materials = scene::bakeMaterials(scene, {.method = method, .useCache = false});
    Settings settings = settingsFor(look.shading, look.size);
    settings.samples = look.samples;
    settings.shadows = look.shadows;
    settings.shadowSize = 4096; // edges are two texels wide
    Renderer renderer(device(), scene, materials, settings);
    PathOptions options;
    options.seconds = look.seconds;
    const Playback playback(scene, scene.cameras.at(0), options);
    playback.apply(renderer, 0);
    renderer.render(playback.camera(0));
    return renderer.readDisplay();
}

// Without an environment the renderer fills shadows with a sky of 4 % of the brightest sun, a third of it
// from below.
glm::vec3 skyOf(const json& root)
{
    float brightest = 0.0f;
    if (root.contains("extensions"))
        for (const json& light : root["extensions"]["KHR_lights_punctual"]["lights"])
            if (light["type"] == "directional")
                brightest = std::max(brightest, light.value("intensity", 1.0f));
    return glm::vec3(0.04f * brightest);
}

} // namespace

Subject::Subject(bool lit)
{
    gltf.root["nodes"] = json::array();
    gltf.root["meshes"] = json::array();
    gltf.root["scenes"] = {{{"nodes", json::array()}}};
    camera({0.5f, 0.7f, 3.0f}, {0, 0, 0});
    if (!lit)
        return;
    light({{"type", "directional"}, {"intensity", 2.5}, {"color", {1.0, 0.9, 0.75}}}, {2, 2, 2.5f},
          {0, 0, 0});
    light({{"type", "point"}, {"intensity", 5.0}, {"color", {0.5, 0.7, 1.0}}}, {-2, 0.3f, 2}, {0, 0, 0});
}

int Subject::texture(const Image& image, int wrapS, int wrapT)
{
    const std::string file = fmt::format("image{}.png", images_++);
    writeImage(folder_ / file, image);
    gltf.root["images"].push_back({{"uri", file}});
    gltf.root["samplers"].push_back({{"wrapS", wrapS}, {"wrapT", wrapT}});
    gltf.root["textures"].push_back(
        {{"source", gltf.root["images"].size() - 1}, {"sampler", gltf.root["samplers"].size() - 1}});
    return int(gltf.root["textures"].size()) - 1;
}

json Subject::material(const Image& baseColour)
{
    return {{"pbrMetallicRoughness",
             {{"baseColorTexture", {{"index", texture(baseColour)}}},
              {"metallicFactor", 0.0},
              {"roughnessFactor", 0.5}}}};
}

int Subject::add(const json& material)
{
    gltf.root["materials"].push_back(material);
    return int(gltf.root["materials"].size()) - 1;
}

int Subject::mesh(const Shape& shape, int material)
{
    json attributes = {{"POSITION", gltf.floats(flat(shape.positions), "VEC3", 3)},
                       {"NORMAL", gltf.floats(flat(shape.normals), "VEC3", 3)}};
    if (!shape.tangents.empty())
        attributes["TANGENT"] = gltf.floats(flat(shape.tangents), "VEC4", 4);
    if (!shape.uvs.empty())
        attributes["TEXCOORD_0"] = gltf.floats(flat(shape.uvs), "VEC2", 2);
    if (!shape.secondUvs.empty())
        attributes["TEXCOORD_1"] = gltf.floats(flat(shape.secondUvs), "VEC2", 2);
    if (!shape.colours.empty())
        attributes["COLOR_0"] = gltf.floats(flat(shape.colours), "VEC4", 4);
    gltf.root["meshes"].push_back({{"primitives",
                                    {{{"attributes", attributes},
                                      {"indices", gltf.accessor(shape.indices, "SCALAR", 5125, 1)},
                                      {"material", material}}}}});
    return int(gltf.root["meshes"].size()) - 1;
}

int Subject::place(int mesh, json node)
{
    node["mesh"] = mesh;
    gltf.root["nodes"].push_back(node);
    const int index = int(gltf.root["nodes"].size()) - 1;
    gltf.root["scenes"][0]["nodes"].push_back(index);
    return index;
}

int Subject::place(const Shape& shape, const json& material, json node)
{
    return place(mesh(shape, add(material)), std::move(node));
}

void Subject::camera(glm::vec3 eye, glm::vec3 target, float yFov)
{
    gltf.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", yFov}, {"znear", 0.05}}}}};
    const json node = {
        {"camera", 0}, {"translation", {eye.x, eye.y, eye.z}}, {"rotation", rotationTowards(target - eye)}};
    if (gltf.root["nodes"].empty()) { // the constructor's; later calls change it
        gltf.root["nodes"].push_back(node);
        gltf.root["scenes"][0]["nodes"].push_back(0);
    } else {
        gltf.root["nodes"][0] = node;
    }
}

void Subject::light(json light, glm::vec3 from, glm::vec3 to)
{
    use("KHR_lights_punctual");
    json& lights = gltf.root["extensions"]["KHR_lights_punctual"]["lights"];
    lights.push_back(std::move(light));
    gltf.root["nodes"].push_back({{"translation", {from.x, from.y, from.z}},
                                  {"rotation", rotationTowards(to - from)},
                                  {"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}});
    gltf.root["scenes"][0]["nodes"].push_back(gltf.root["nodes"].size() - 1);
}

void Subject::use(const char* extension)
{
    json& used = gltf.root["extensionsUsed"];
    if (std::find(used.begin(), used.end(), json(extension)) == used.end())
        used.push_back(extension);
}

std::filesystem::path Subject::write()
{
    return gltf.writeGltf(folder_);
}

Verdict judged(Subject& subject, const Look& look)
{
    const std::filesystem::path file = subject.write();
    const glm::vec3 sky = look.environment ? glm::vec3(0.0f) : skyOf(subject.gltf.root);
    const judge::Answer answer = judge::castRays({.gltf = file,
                                                  .size = look.size,
                                                  .rays = look.samples,
                                                  .seconds = look.seconds,
                                                  .shadows = look.shadows,
                                                  .sky = sky,
                                                  .ground = sky / 3.0f,
                                                  .environment = look.environment});
    Verdict verdict{rendered(file, look), displayOf(answer), 0.0};
    verdict.psnr = compareQuickly(verdict.rendered, verdict.judged).psnr;
    return verdict;
}

void expectAgreement(const std::string& name, Subject& subject, const Look& look, double leastPsnr)
{
    const Verdict verdict = judged(subject, look);
    fmt::print("{:>28}: {:.1f} dB\n", name, verdict.psnr);
    const char* keep = std::getenv("LUMEL_JUDGE_KEEP"); // also what agrees, to look at
    if (verdict.psnr >= leastPsnr && !(keep && *keep))
        return;
    const std::filesystem::path folder = LUMEL_JUDGE_PICTURES;
    std::filesystem::create_directories(folder);
    const auto write = [&](const char* what, const Image& image) {
        writeImage(folder / fmt::format("{}-{}.png", name, what), image);
    };
    write("rendered", verdict.rendered);
    write("judge", verdict.judged);
    write("difference", differenceImage(verdict.rendered, verdict.judged));
    EXPECT_GE(verdict.psnr, leastPsnr) << name << ": see " << folder.string();
}

} // namespace lumel::test
