// Small glTF files of one subject each, rendered by the renderer and by the judge.
#pragma once
#include "gltf_builder.h"
#include "test_scene.h"
#include <fmt/format.h>
#include <optional>

namespace lumel::test {

using nlohmann::json;

// A mesh's attributes; empty ones are left out of the file.
struct Shape {
    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec4> tangents, colours;
    std::vector<glm::vec2> uvs, secondUvs;
    std::vector<uint32_t> indices;
};

// [-1, 1]^2 at z = 0, facing +z; uv (0, 0) at the upper left.
Shape sheet(int cells = 1);
// A sphere of radius 1, of rings and segments; the second UVs are the first turned by a right angle, which
// are unique too.
Shape ball(int rows = 32, int columns = 64);

// Random colours in a grid of cells; alpha 0 or 1. The same for the same seed.
Image patches(int size, int cells, uint32_t seed, bool withAlpha = false);
// One colour with random holes.
Image holes(int size, int cells, uint32_t seed);
// Normals of random smooth bumps, up to 45 degrees steep.
Image bumps(int size, uint32_t seed);

// Builds a glTF file. It starts with a camera that sees the unit ball, and one sun and one lamp.
class Subject {
public:
    explicit Subject(bool lit = true);

    // Returns the texture's index. wraps: glTF's numbers.
    int texture(const Image& image, int wrapS = 10497, int wrapT = 10497);
    json material(const Image& baseColour); // with that map, not metallic, roughness 0.5
    int add(const json& material);
    int mesh(const Shape& shape, int material);
    // json: of the node, whose mesh is set.
    int place(int mesh, json node = json::object());
    int place(const Shape& shape, const json& material, json node = json::object());
    void camera(glm::vec3 eye, glm::vec3 target, float yFov = 0.75f);
    // At a position, shining towards a point. Directional lights have no use for the former.
    void light(json light, glm::vec3 from, glm::vec3 to);
    void use(const char* extension);

    std::filesystem::path write();
    scene::GltfBuilder gltf;

private:
    scene::TemporaryFolder folder_;
    int images_ = 0;
};

struct Look {
    glm::uvec2 size{128, 96};
    Shading shading = Shading::reference;
    double seconds = 0.0;
    int samples = 64;
    bool shadows = false;               // exact ones are hard even on the facets of a ball
    std::optional<float> environment{}; // constant radiance from everywhere
};

struct Verdict {
    Image rendered, judged; // display values
    double psnr = 0.0;
};
Verdict judged(Subject& subject, const Look& look = {});

// Expects the renderer's picture to match the judge's to 40 dB; else both are kept in out/judge.
void expectAgreement(const std::string& name, Subject& subject, const Look& look = {},
                     double leastPsnr = 40.0);

class Judge : public GpuTest {};

} // namespace lumel::test
