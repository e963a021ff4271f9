#include "test_scene.h"
#include "core/compare.h"
#include "renderer/demands.h"
#include <cstdlib>
#include <random>

namespace lumel::test {

namespace {

// Released before main() ends: at exit, validation layers and drivers are torn down in an unspecified order.
std::unique_ptr<gpu::Device> sharedDevice;

struct GivesDeviceUp : testing::Environment {
    void TearDown() override { sharedDevice.reset(); }
};
const auto* const givesDeviceUp = testing::AddGlobalTestEnvironment(new GivesDeviceUp);

} // namespace

const gpu::Device& device()
{
    if (!sharedDevice) {
        const char* wanted = std::getenv("LUMEL_DEVICE");
        sharedDevice =
            std::make_unique<gpu::Device>(forRendering({.device = wanted ? wanted : "", .validation = true}));
    }
    return *sharedDevice;
}

namespace {

scene::Mesh gridMesh(int rows, int columns, const std::function<shared::Vertex(glm::vec2)>& vertexAt)
{
    scene::Mesh mesh;
    mesh.name = "grid";
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= columns; ++x) {
            mesh.vertices.push_back(vertexAt({float(x) / float(columns), float(y) / float(rows)}));
            mesh.bounds.add(mesh.vertices.back().position);
        }
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const auto a = uint32_t(y * (columns + 1) + x), b = a + 1, c = a + uint32_t(columns) + 1,
                       d = c + 1;
            for (const uint32_t i : {a, c, d, a, d, b})
                mesh.indices.push_back(i);
        }
    return mesh;
}

} // namespace

scene::Mesh planeMesh(int cells)
{
    return gridMesh(cells, cells, [](glm::vec2 uv) {
        return shared::Vertex{.position = {2.0f * uv.x - 1.0f, 1.0f - 2.0f * uv.y, 0.0f},
                              .normal = {0, 0, 1},
                              .tangent = {1, 0, 0, 1},
                              .uv = uv,
                              .materialUv = uv,
                              .emissionUv = uv};
    });
}

scene::Mesh patchworkMesh(int cells, float gutter)
{
    scene::Mesh mesh;
    mesh.name = "patchwork";
    const int count = cells * cells;
    for (int i = 0; i < count; ++i) {
        const int place = (i * 37 + 11) % count; // all different while 37 divides no count
        const auto first = uint32_t(mesh.vertices.size());
        for (int corner = 0; corner < 4; ++corner) {
            const glm::vec2 c(corner & 1, corner >> 1);
            const glm::vec2 p = (glm::vec2(i % cells, i / cells) + c) / float(cells);
            const glm::vec2 inset = gutter * (1.0f - 2.0f * c);
            const glm::vec2 uv = (glm::vec2(place % cells, place / cells) + c) / float(cells) + inset;
            mesh.vertices.push_back({.position = {2.0f * p.x - 1.0f, 1.0f - 2.0f * p.y, 0.0f},
                                     .normal = {0, 0, 1},
                                     .tangent = {1, 0, 0, 1},
                                     .uv = uv,
                                     .materialUv = uv,
                                     .emissionUv = uv});
            mesh.bounds.add(mesh.vertices.back().position);
        }
        for (const uint32_t k : {0u, 2u, 3u, 0u, 3u, 1u})
            mesh.indices.push_back(first + k);
    }
    return mesh;
}

scene::Mesh sphereMesh(int rows, int columns)
{
    return gridMesh(rows, columns, [](glm::vec2 uv) {
        const float phi = 2.0f * shared::kPi * uv.x, theta = shared::kPi * uv.y;
        const glm::vec3 n(std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi));
        return shared::Vertex{.position = n,
                              .normal = n,
                              .tangent = {std::cos(phi), 0.0f, -std::sin(phi), 1.0f},
                              .uv = uv,
                              .materialUv = uv,
                              .emissionUv = uv};
    });
}

void TestScene::add(scene::Mesh mesh, const baker::Maps& maps, const glm::mat4& worldFromObject,
                    const baker::Options& options)
{
    for (const auto& vertex : mesh.vertices)
        scene.bounds.add(glm::vec3(worldFromObject * glm::vec4(vertex.position, 1.0f)));
    scene.objects.push_back({.name = "object",
                             .mesh = int(scene.meshes.size()),
                             .material = int(scene.materials.size()),
                             .worldFromObject = worldFromObject});
    scene.meshes.push_back(std::move(mesh));
    scene.materials.emplace_back();
    scene::BakedMaterial baked;
    baked.reflectance = baker::bake(maps, options);
    Image dark(1, 1, 4);
    dark.pixels.back() = 1.0f;
    baked.emissive = scene::HalfChain({dark});
    Image opaque(1, 1, 1);
    opaque.pixels = {1.0f};
    baked.opacity = scene::HalfChain({opaque});
    materials.push_back(std::move(baked));
}

namespace {
// A quarter of the power along the other axis, turned off the tangent frame's own axes: exchanged or mirrored
// axes change the picture.
void makeAnisotropic(baker::Maps& maps, float power)
{
    maps.anisotropicPower = {power, 0.25f * power};
    maps.tangentRotation = Image(1, 1, 1);
    maps.tangentRotation.pixels = {0.15f}; // half turns
}
} // namespace

baker::Maps plainMaps(glm::vec3 diffuse, float power)
{
    baker::Maps maps;
    maps.normal = Image(1, 1, 3);
    maps.normal.pixels = {0.5f, 0.5f, 1.0f};
    makeAnisotropic(maps, power);
    maps.diffuseConstant = diffuse;
    return maps;
}

baker::Maps bumpyMaps(int size, float scale, float power)
{
    std::mt19937 random(7);
    baker::Maps maps;
    maps.height = Image(size, size, 1);
    for (float& h : maps.height.pixels)
        h = float(random() % 65536) / 65536.0f;
    maps.heightScale = scale / float(size);
    makeAnisotropic(maps, power);
    maps.diffuseConstant = glm::vec3(0.3f);
    maps.specularConstant = glm::vec3(0.2f);
    return maps;
}

scene::Camera cameraAt(glm::vec3 eye, glm::vec3 target, float yFov)
{
    scene::Camera camera;
    camera.eye = eye;
    camera.target = target;
    camera.yFov = yFov;
    return camera;
}

scene::Light sun(glm::vec3 direction, float lux)
{
    scene::Light light;
    light.direction = glm::normalize(direction);
    light.intensity = lux;
    return light;
}

TestScene sphereScene(const baker::Maps& maps)
{
    TestScene s;
    s.add(sphereMesh(), maps);
    s.scene.lights = {sun({-1, -1, -1}), sun({1, -0.3f, -1}, 1.0f)};
    return s;
}

Settings settingsFor(Shading shading, glm::uvec2 size)
{
    Settings settings;
    settings.shading = shading;
    settings.size = size;
    settings.samples = 64;
    return settings;
}

Settings multisampled(Shading shading)
{
    Settings settings = settingsFor(shading);
    settings.msaa = 4;
    return settings;
}

Picture shoot(const TestScene& s, const scene::Camera& camera, const Settings& settings)
{
    Renderer renderer(device(), s.scene, s.materials, settings);
    Picture picture;
    picture.stats = renderer.render(camera);
    picture.display = renderer.readDisplay();
    picture.radiance = renderer.readRadiance();
    return picture;
}

double psnr(const Image& a, const Image& b)
{
    return compareImages(a, b).psnr;
}

} // namespace lumel::test
