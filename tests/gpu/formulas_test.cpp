// The formulas that GLSL and C++ share, over many random lobes, frames, lights and views: the GPU's results
// against those of the same header compiled as C++.
#include "formulas.h"
#include "gpu/upload.h"
#include "test_scene.h"
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <optional>
#include <random>

#include "formulas.comp.h" // SPIR-V

namespace lumel::test {
namespace {

constexpr uint32_t kCount = 20000;

struct Random {
    std::mt19937 engine{5};
    float uniform(float a, float b) { return std::uniform_real_distribution<float>(a, b)(engine); }
    glm::vec3 direction()
    {
        const float z = uniform(-1.0f, 1.0f), phi = uniform(0.0f, 6.2831853f), r = std::sqrt(1.0f - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }
    glm::vec3 colour() { return {uniform(0.0f, 1.0f), uniform(0.0f, 1.0f), uniform(0.0f, 1.0f)}; }
};

shared::Light randomLight(Random& random, glm::vec3 position, glm::vec3 towards)
{
    shared::Light light{};
    light.type = random.engine() % 3;
    light.position = position + random.uniform(0.5f, 3.0f) * towards;
    light.direction = light.type == shared::kLightDirectional
                          ? -towards
                          : glm::normalize(-towards + 0.3f * random.direction());
    light.inverseRange = random.engine() % 2 ? random.uniform(0.05f, 0.4f) : 0.0f;
    light.intensity = 5.0f * random.colour();
    light.coneScale = random.uniform(2.0f, 8.0f);
    light.coneOffset = random.uniform(-4.0f, 0.0f);
    return light;
}

// Anisotropic lobes of powers 1 to 10000, tilted, in frames of either handedness.
shared::FormulaInput randomInput(Random& random)
{
    shared::FormulaInput in{};
    in.macroNormal = random.direction();
    in.tangent = glm::normalize(glm::cross(in.macroNormal, random.direction()));
    in.bitangent = glm::cross(in.macroNormal, in.tangent) * (random.engine() % 2 ? 1.0f : -1.0f);
    const float tilt = random.uniform(0.0f, 0.95f), turn = random.uniform(0.0f, 6.2831853f);
    in.normal = tilt * glm::vec2(std::cos(turn), std::sin(turn));
    const float su = std::exp(random.uniform(-9.21f, 0.0f)), sv = std::exp(random.uniform(-9.21f, 0.0f));
    const float angle = random.uniform(0.0f, 3.1415927f), c = std::cos(angle), s = std::sin(angle);
    in.covariance = {c * c * su + s * s * sv, c * s * (su - sv), s * s * su + c * c * sv};
    in.f0 = random.colour();
    in.diffuse = random.colour();
    in.position = 2.0f * random.direction();
    // A half vector within reach of the lobe, so that most shapes are not 0, and a view on the macro side.
    const glm::vec3 n = shared::lobeNormal(in.normal);
    const float reach = std::sqrt(std::max(su, sv));
    glm::vec3 h = glm::normalize(n + random.uniform(0.0f, 2.0f) * reach * random.direction());
    h = glm::normalize(in.tangent * h.x + in.bitangent * h.y + in.macroNormal * std::abs(h.z));
    in.toEye = glm::normalize(h + random.uniform(0.0f, 1.5f) * random.direction());
    in.light = randomLight(random, in.position, 2.0f * glm::dot(in.toEye, h) * h - in.toEye);
    return in;
}

std::vector<shared::FormulaOutput> onTheGpu(const std::vector<shared::FormulaInput>& inputs)
{
    const gpu::Buffer in = gpu::uploadBuffer(device(), inputs, "inputs");
    const gpu::Buffer out(device(), inputs.size() * sizeof(shared::FormulaOutput),
                          gpu::Buffer::MemoryUsage::device, "outputs");
    struct {
        vk::DeviceAddress inputs, outputs;
        uint32_t count;
    } const push{in.address(), out.address(), uint32_t(inputs.size())};
    const vk::PushConstantRange range{.stageFlags = vk::ShaderStageFlagBits::eCompute, .size = 20};
    const vk::raii::PipelineLayout layout(device().handle(),
                                          {.pushConstantRangeCount = 1, .pPushConstantRanges = &range});
    const vk::raii::ShaderModule module(device().handle(),
                                        {.codeSize = sizeof(formulas_comp), .pCode = formulas_comp});
    const vk::raii::Pipeline pipeline(
        device().handle(), nullptr,
        vk::ComputePipelineCreateInfo{
            .stage = {.stage = vk::ShaderStageFlagBits::eCompute, .module = *module, .pName = "main"},
            .layout = *layout});
    device().runOnce([&](vk::CommandBuffer commands) {
        commands.bindPipeline(vk::PipelineBindPoint::eCompute, *pipeline);
        commands.pushConstants(*layout, vk::ShaderStageFlagBits::eCompute, 0, 20, &push);
        commands.dispatch((uint32_t(inputs.size()) + 63) / 64, 1, 1);
    });
    const auto bytes = gpu::readBack(device(), out, out.size());
    std::vector<shared::FormulaOutput> outputs(inputs.size());
    std::memcpy(outputs.data(), bytes.data(), bytes.size());
    return outputs;
}

// The largest difference of all numbers of one result, relative to `scale` of it.
template<class Value>
float difference(const Value& a, const Value& b, float scale)
{
    const auto* x = reinterpret_cast<const float*>(&a);
    const auto* y = reinterpret_cast<const float*>(&b);
    float most = 0.0f;
    for (size_t i = 0; i < sizeof(Value) / sizeof(float); ++i)
        most =
            std::isfinite(x[i]) && std::isfinite(y[i]) ? std::max(most, std::abs(x[i] - y[i]) / scale) : 1e9f;
    return most;
}

struct Worst {
    float error = 0.0f;
    size_t at = 0;
};
} // namespace

class Formulas : public GpuTest {};

TEST_F(Formulas, AreTheSameOnTheGpuAsInCpp)
{
    Random random;
    std::vector<shared::FormulaInput> inputs;
    for (uint32_t i = 0; i < kCount; ++i)
        inputs.push_back(randomInput(random));
    const auto outputs = onTheGpu(inputs);
    std::map<std::string, Worst> worst;
    size_t lit = 0, anisotropic = 0;
    for (size_t i = 0; i < inputs.size(); ++i) {
        const shared::FormulaOutput &gpu = outputs[i], cpu = shared::formulas(inputs[i]);
        const float peak = 1.0f / std::sqrt(inputs[i].covariance.x * inputs[i].covariance.z -
                                            inputs[i].covariance.y * inputs[i].covariance.y);
        lit += cpu.shape > 1e-3f * peak;
        anisotropic +=
            std::abs(inputs[i].covariance.x - inputs[i].covariance.z) > 0.1f * inputs[i].covariance.x;
        const auto compare = [&](const char* name, const auto& a, const auto& b, float scale) {
            const float error = difference(a, b, scale);
            if (Worst& w = worst[name]; error > w.error)
                w = {error, i};
        };
        const auto largest = [](glm::vec3 v) { return std::max({v.x, v.y, v.z, 1e-3f}); };
        compare("normal", gpu.lobeNormal, cpu.lobeNormal, 1.0f);
        compare("tangent", gpu.lobeTangentU, cpu.lobeTangentU, 1.0f);
        compare("falloff", gpu.falloff, cpu.falloff, cpu.falloff);
        compare("shape", gpu.shape, cpu.shape, peak);
        compare("shape in the world", gpu.preparedShape, cpu.preparedShape, peak);
        compare("two shapes", cpu.shape, cpu.preparedShape, peak);
        compare("to light", gpu.toLight, cpu.toLight, 1.0f);
        compare("irradiance", gpu.irradiance, cpu.irradiance, largest(cpu.irradiance));
        compare("Fresnel", gpu.fresnel, cpu.fresnel, 1.0f);
        // What differs in the shape differs here, times all that multiplies it: at most the peak's share.
        const float brightest = largest(cpu.irradiance) * std::max(1.0f, 4.0f * peak);
        compare("strength", gpu.strength, cpu.strength, largest(cpu.strength));
        compare("reflectance", gpu.reflectance, cpu.reflectance, 1.0f);
        compare("reflectance from its strength", cpu.reflectance, inputs[i].f0, 1.0f);
        compare("energy residual", gpu.residual, cpu.residual, 1.0f);
        compare("grazing share", gpu.grazing, cpu.grazing, 1.0f);
        compare("power", gpu.power, cpu.power, cpu.power);
        compare("reflected", gpu.reflected, cpu.reflected, brightest);
        compare("ambient", gpu.ambient, cpu.ambient, 1.0f);
        compare("environment level", gpu.environmentLevel, cpu.environmentLevel, 1.0f);
        compare("environment variance", gpu.environmentVariance, cpu.environmentVariance,
                cpu.environmentVariance);
        compare("environment lobe", gpu.environmentLobe, cpu.environmentLobe, 1.0f);
        compare("environment place", gpu.environmentPlace, cpu.environmentPlace, 1.0f);
        compare("environment direction", gpu.environmentDirection, cpu.environmentDirection, 1.0f);
    }
    for (const auto& [name, w] : worst)
        EXPECT_LT(w.error, 1e-3f) << name << ", input " << w.at;
    EXPECT_GT(lit, kCount / 4) << "lobes that reflect anything";
    EXPECT_GT(anisotropic, kCount / 2);
}

Image oneTexel(std::vector<float> values)
{
    Image image(1, 1, int(values.size()));
    image.pixels = std::move(values);
    return image;
}

// A plane under one sun, whose every pixel C++ knows: a tilted, turned, anisotropic lobe in a turned frame.
struct ShinyPlane {
    TestScene scene;
    glm::mat4 worldFromObject;
    glm::vec3 tangent, bitangent, normal; // in the world
    scene::Light light;
    scene::Camera camera = cameraAt({-0.6f, 0.9f, 2.2f});

    explicit ShinyPlane(float handedness)
    {
        const glm::vec3 axis = glm::normalize(glm::vec3(1.0f, 2.0f, 0.5f));
        worldFromObject = glm::rotate(glm::mat4(1.0f), 0.4f, axis);
        scene::Mesh mesh = planeMesh();
        const glm::vec3 inObject(std::cos(0.7f), std::sin(0.7f), 0.0f);
        for (shared::Vertex& v : mesh.vertices)
            v.tangent = {inObject, handedness};
        normal = glm::mat3(worldFromObject) * glm::vec3(0, 0, 1);
        tangent = glm::mat3(worldFromObject) * inObject;
        bitangent = handedness * glm::cross(normal, tangent);
        baker::Maps maps;
        maps.normal = oneTexel({0.6f, 0.45f, 0.95f});
        maps.anisotropicPower = {150.0f, 8.0f};
        maps.tangentRotation = oneTexel({0.2f});
        maps.specularConstant = {0.9f, 0.5f, 0.3f};
        maps.diffuseConstant = {0.05f, 0.1f, 0.2f};
        scene.add(std::move(mesh), maps, worldFromObject);
        // The highlight is in the middle: what the lobe's own normal mirrors.
        const auto t = scene.materials[0].reflectance.at(0, 0, 0);
        const glm::vec3 n =
            glm::mat3(tangent, bitangent, normal) * shared::lobeNormal({t[baker::kNx], t[baker::kNy]});
        light = sun(glm::reflect(glm::normalize(camera.eye), n));
    }

    // Radiance of the sun's reflection at a pixel; nothing where the plane is not, or near its border.
    std::optional<glm::vec3> reflected(glm::ivec2 pixel, glm::ivec2 size) const
    {
        const glm::vec3 forward = glm::normalize(camera.target - camera.eye);
        const glm::vec3 right = glm::normalize(glm::cross(forward, camera.up)),
                        up = glm::cross(right, forward);
        const glm::vec2 at = (glm::vec2(pixel) + 0.5f) / glm::vec2(size) * 2.0f - 1.0f;
        const float half = std::tan(0.5f * camera.yFov), aspect = float(size.x) / float(size.y);
        const glm::vec3 ray = forward + half * (aspect * at.x * right - at.y * up);
        const glm::vec3 position = camera.eye - ray * glm::dot(camera.eye, normal) / glm::dot(ray, normal);
        const glm::vec3 local = glm::inverse(worldFromObject) * glm::vec4(position, 1.0f);
        if (std::max(std::abs(local.x), std::abs(local.y)) > 0.9f)
            return std::nullopt;
        const auto t = scene.materials[0].reflectance.at(0, 0, 0);
        const shared::Lobe lobe = shared::makeLobe(shared::lobeNormal({t[baker::kNx], t[baker::kNy]}),
                                                   {t[baker::kSxx], t[baker::kSxy], t[baker::kSyy]});
        const glm::mat3 frame(tangent, bitangent, normal);
        const glm::vec3 covariance(t[baker::kSxx], t[baker::kSxy], t[baker::kSyy]);
        const glm::vec3 ks(t[baker::kKsR], t[baker::kKsG], t[baker::kKsB]);
        const glm::vec3 toEye = glm::normalize(camera.eye - position);
        const auto surface =
            shared::reflectanceTowards({.lobe = {frame * lobe.normal, frame * lobe.tangentU,
                                                 frame * lobe.tangentV, lobe.inverseCovariance, lobe.scale},
                                        .macroNormal = normal,
                                        .specular = ks,
                                        .f0 = shared::reflectanceOf(ks, covariance),
                                        .baseVariance = shared::baseVariance(covariance),
                                        .diffuse = {t[baker::kKdR], t[baker::kKdG], t[baker::kKdB]}},
                                       toEye);
        return shared::reflectLight(surface, -light.direction, toEye, light.intensity * light.colour);
    }
};

// The whole shader path, axes included: the picture under the sun less that with the sun behind the
// plane.
TEST_F(Formulas, LightEveryPixelOfATurnedAnisotropicSurface)
{
    for (const float handedness : {1.0f, -1.0f})
        for (const auto& [shading, tolerance] :
             {std::pair(Shading::forward, 0.003f), {Shading::tsl, 0.005f}}) {
            ShinyPlane plane(handedness);
            Settings settings = settingsFor(shading, {160, 120});
            settings.msaa = 1;
            settings.shadows = false;
            settings.levelOffset = 0.0f;
            settings.lumelsPerPixel = 8.0f;
            plane.scene.scene.lights = {plane.light};
            const Image lit = shoot(plane.scene, plane.camera, settings).radiance;
            plane.scene.scene.lights[0].direction = plane.normal; // from behind
            const Image dark = shoot(plane.scene, plane.camera, settings).radiance;
            float peak = 0.0f, least = 1e9f, worst = 0.0f;
            glm::ivec2 where(0);
            int count = 0;
            for (int y = 0; y < lit.height; ++y)
                for (int x = 0; x < lit.width; ++x) {
                    const auto expected = plane.reflected({x, y}, {lit.width, lit.height});
                    if (!expected)
                        continue;
                    ++count;
                    peak = std::max(peak, expected->x);
                    least = std::min(least, expected->x);
                    for (int c = 0; c < 3; ++c) {
                        const float error = std::abs(lit.at(x, y)[c] - dark.at(x, y)[c] - (*expected)[c]);
                        if (error > worst) {
                            worst = error;
                            where = {x, y};
                        }
                    }
                }
            EXPECT_GT(count, 3000);
            RecordProperty("worst_" + std::to_string(int(handedness)) + "_" + std::to_string(int(shading)),
                           std::to_string(worst / peak));
            EXPECT_GT(peak, 5.0f * least) << "there is a highlight";
            EXPECT_LT(worst, tolerance * peak) << "handedness " << handedness << ", shading " << int(shading)
                                               << ", pixel " << where.x << ", " << where.y;
        }
}

} // namespace lumel::test
