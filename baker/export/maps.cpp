#include "maps.h"
#include "ggx_average.h"
#include "shared/lobe.h"
#include <tbb/parallel_for.h>

namespace lumel::baker {
namespace {

constexpr float kDielectric = 0.04f; // F0 of glTF's dielectrics
constexpr float kDiffuseShare = 1.0f - kDielectric;

// One map of `names` channels; write(texel, values) fills one texel's.
template<class Write>
ExportMap makeMap(std::string name, std::vector<MapChannel> channels, const std::vector<GgxLevel>& levels,
                  const Write& write)
{
    ExportMap map{std::move(name), ColourSpace::linear, false, std::move(channels), {}};
    const int count = int(map.channels.size());
    for (const GgxLevel& level : levels) {
        Image image(level.width, level.height, count);
        tbb::parallel_for(0, level.height, [&](int y) {
            for (int x = 0; x < level.width; ++x) {
                float* to = image.at(x, y);
                write(level.at(x, y), to);
                for (int c = 0; c < count; ++c)
                    to[c] = std::clamp(to[c], 0.0f, 1.0f);
            }
        });
        map.levels.push_back(std::move(image));
    }
    return map;
}

MapChannel channel(const char* name, const char* meaning)
{
    return {name, meaning, "value"};
}

std::vector<MapChannel> colourChannels(const std::string& meaning)
{
    return {{"R", meaning + ", red", "value"},
            {"G", meaning + ", green", "value"},
            {"B", meaning + ", blue", "value"}};
}

ExportMap normalMap(const std::vector<GgxLevel>& levels, bool greenUp)
{
    const float sign = greenUp ? 1.0f : -1.0f;
    const char* along = greenUp ? "normal along the bitangent (green up)" : "normal against the bitangent";
    ExportMap map = makeMap("normal",
                            {{"R", "normal along the tangent", "2 value - 1"},
                             {"G", along, "2 value - 1"},
                             {"B", "normal away from the surface", "2 value - 1"}},
                            levels, [=](const GgxTexel& t, float* to) {
                                const glm::vec3 n = t.shape.normal;
                                to[0] = 0.5f + 0.5f * n.x;
                                to[1] = 0.5f + 0.5f * sign * n.y;
                                to[2] = 0.5f + 0.5f * n.z;
                            });
    map.isNormal = true;
    return map;
}

void addRoughness(std::vector<ExportMap>& maps, const std::vector<GgxLevel>& levels,
                  const MapOptions& options)
{
    const auto rough = [a = options.anisotropic](const GgxTexel& t) { return roughnessOf(t, a); };
    const auto metal = [](const GgxTexel& t) { return metallicColour(t.diffuse, t.f0).metallic; };
    const auto packed = [&](const GgxTexel& t, float* to) {
        to[0] = 1.0f;
        to[1] = rough(t);
        to[2] = metal(t);
    };
    const MapChannel roughness = channel("G", "perceptual roughness"), metallic = channel("B", "metalness");
    switch (options.packing) {
    case Packing::gltf:
        maps.push_back(
            makeMap("metallic_roughness", {channel("R", "unused, 1"), roughness, metallic}, levels, packed));
        break;
    case Packing::orm:
        maps.push_back(makeMap("occlusion_roughness_metallic",
                               {channel("R", "occlusion, 1: not baked"), roughness, metallic}, levels,
                               packed));
        break;
    case Packing::unity:
        maps.push_back(makeMap("metallic_smoothness",
                               {channel("R", "metalness"), channel("G", "metalness"),
                                channel("B", "metalness"), channel("A", "smoothness, 1 - roughness")},
                               levels, [&](const GgxTexel& t, float* to) {
                                   std::fill_n(to, 3, metal(t));
                                   to[3] = 1.0f - rough(t);
                               }));
        break;
    case Packing::unreal:
        maps.push_back(makeMap("roughness", {channel("R", "perceptual roughness")}, levels,
                               [&](const GgxTexel& t, float* to) { to[0] = rough(t); }));
        maps.push_back(makeMap("metallic", {channel("R", "metalness")}, levels,
                               [&](const GgxTexel& t, float* to) { to[0] = metal(t); }));
        break;
    }
}

} // namespace

float roughnessOf(const GgxTexel& texel, bool anisotropic)
{
    const float alpha = anisotropic ? texel.shape.alphaB : std::sqrt(texel.shape.alphaT * texel.shape.alphaB);
    return std::sqrt(alpha);
}

glm::vec3 anisotropyOf(const GgxTexel& texel)
{
    const GgxShape& s = texel.shape;
    const glm::vec3 u = shared::lobeTangentU(s.normal), v = glm::cross(s.normal, u);
    const float strength = std::sqrt(std::max(s.alphaT - s.alphaB, 0.0f) / std::max(1.0f - s.alphaB, 1e-6f));
    // Either way along the axis is the same: the one with u >= 0, so that bilinear lookups blend like with
    // like.
    glm::vec2 direction(glm::dot(s.tangent, u), glm::dot(s.tangent, v));
    if (direction.x < 0.0f)
        direction = -direction;
    return {direction.x, direction.y, std::min(strength, 1.0f)};
}

// diffuse = colour (1 - m) (1 - d) and F0 = d (1 - m) + colour m, with d = 0.04. Their sum over the channels
// leaves d m^2 + (k + f - 2 d) m - (f - d) = 0, with k = diffuse / (1 - d); the colour then follows from
// both.
MetallicColour metallicColour(glm::vec3 diffuse, glm::vec3 f0)
{
    const glm::vec3 base = diffuse / kDiffuseShare;
    const float k = luminanceOf(base), f = luminanceOf(f0), d = kDielectric;
    MetallicColour result{0.0f, base};
    if (f > d) {
        const float b = k + f - 2.0f * d, c = f - d;
        const float root = std::sqrt(b * b + 4.0f * d * c);
        // The form without cancellation.
        const float m = b > 0.0f ? 2.0f * c / (b + root) : (root - b) / (2.0f * d);
        result.metallic = std::clamp(m, 0.0f, 1.0f);
        result.baseColour = base + f0 - glm::vec3(d * (1.0f - result.metallic));
    }
    result.baseColour = glm::clamp(result.baseColour, 0.0f, 1.0f);
    return result;
}

std::vector<ExportMap> makeMaps(const std::vector<GgxLevel>& levels, const MapOptions& options)
{
    std::vector<ExportMap> maps;
    maps.push_back(normalMap(levels, options.normalGreenUp));
    addRoughness(maps, levels, options);
    if (options.anisotropic)
        maps.push_back(makeMap("anisotropy",
                               {{"R", "direction along the tangent", "2 value - 1"},
                                {"G", "direction along the bitangent", "2 value - 1"},
                                {"B", "anisotropy strength", "value"}},
                               levels, [](const GgxTexel& t, float* to) {
                                   const glm::vec3 a = anisotropyOf(t);
                                   to[0] = 0.5f + 0.5f * a.x;
                                   to[1] = 0.5f + 0.5f * a.y;
                                   to[2] = a.z;
                               }));
    const auto colour = [](const glm::vec3& c, float* to) { std::copy_n(&c.x, 3, to); };
    maps.push_back(
        makeMap("base_color", colourChannels("base colour"), levels, [&](const GgxTexel& t, float* to) {
            colour(metallicColour(t.diffuse, t.f0).baseColour, to);
        }));
    maps.push_back(makeMap("specular", colourChannels("reflectance at normal incidence, F0"), levels,
                           [&](const GgxTexel& t, float* to) { colour(t.f0, to); }));
    maps[maps.size() - 2].colourSpace = ColourSpace::srgb;
    maps.back().colourSpace = ColourSpace::srgb;
    return maps;
}

} // namespace lumel::baker
