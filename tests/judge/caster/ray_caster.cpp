#include "ray_caster.h"
#include "box_tree.h"
#include "shared/environment.h"
#include "shared/shading.h"
#include <tbb/parallel_for.h>

namespace lumel::judge {
namespace {

constexpr double kEverywhere = 1e300;

// What a ray has hit, with all that the surface has there.
struct Point {
    const Material* material;
    glm::dvec3 position, front; // front: unit, of the triangle's own plane, on the side that is seen
    glm::dvec2 uv[2];
    glm::dvec4 colour;
    glm::mat3 worldFromTangent; // columns: tangent, bitangent, normal
};

Point pointOf(const Model& model, const Hit& hit, const Ray& ray)
{
    Point point;
    const Triangle& triangle = *hit.triangle;
    const auto mean = [&](auto member) {
        return hit.weights.x * (triangle.corners[0].*member) + hit.weights.y * (triangle.corners[1].*member) +
               hit.weights.z * (triangle.corners[2].*member);
    };
    point.material = &model.materials[size_t(triangle.material)];
    point.position = mean(&Corner::position);
    point.colour = mean(&Corner::colour);
    for (int set = 0; set < 2; ++set)
        point.uv[set] = hit.weights.x * triangle.corners[0].uv[set] +
                        hit.weights.y * triangle.corners[1].uv[set] +
                        hit.weights.z * triangle.corners[2].uv[set];
    const glm::dvec3 n = glm::normalize(mean(&Corner::normal)), along = mean(&Corner::tangent);
    const glm::dvec3 t = glm::normalize(along - n * glm::dot(n, along)), across = glm::cross(n, t);
    const glm::dvec3 b = glm::dot(across, mean(&Corner::bitangent)) < 0.0 ? -across : across;
    // glTF 2.0, section 3.9.6: on the back of a double-sided surface the normal is reversed. It is that of
    // the normal map which is: a bump seen from behind is a dent. So the whole frame is.
    const bool behind = glm::dot(triangle.front, ray.along) > 0.0;
    point.front = glm::normalize(behind ? -triangle.front : triangle.front);
    point.worldFromTangent = glm::mat3(glm::dmat3(t, b, n) * (behind ? -1.0 : 1.0));
    return point;
}

shared::SurfaceReflectance surfaceOf(const Point& point, glm::vec3 toEye)
{
    const Reflectance reflectance = reflectanceOf(point.material->parametersAt(point.uv, point.colour));
    const shared::Lobe lobe = shared::makeLobe(point.material->normalAt(point.uv), reflectance.covariance);
    const glm::mat3& m = point.worldFromTangent;
    return shared::reflectanceTowards(
        {.lobe = {m * lobe.normal, m * lobe.tangentU, m * lobe.tangentV, lobe.inverseCovariance, lobe.scale},
         .macroNormal = m[2],
         .specular = shared::specularStrength(reflectance.f0, reflectance.covariance),
         .f0 = reflectance.f0,
         .baseVariance = shared::baseVariance(reflectance.covariance),
         .diffuse = reflectance.diffuse},
        toEye);
}

// Of radiance 1 from everywhere, by the averages of shared/energy.h.
glm::vec3 reflectEnvironment(const shared::SurfaceReflectance& surface, glm::vec3 toEye)
{
    const glm::vec3 p = surface.lobe.inverseCovariance;
    const float variance = 1.0f / std::sqrt(p.x * p.z - p.y * p.y);
    const float cosine = std::max(glm::dot(surface.lobe.normal, toEye), 0.0f);
    return surface.diffuse + shared::reflectedShare(surface, shared::grazingShare(cosine, variance));
}

class Caster {
public:
    explicit Caster(const Question& question)
        : question_(question), model_(readModel(question.gltf, question.seconds)), tree_(model_.triangles)
    {
    }

    // Radiance along a ray, through blended surfaces.
    glm::vec3 radianceAlong(const Ray& ray) const
    {
        glm::vec3 sum(0.0f);
        float through = 1.0f;
        double from = 0.0;
        while (through > 1e-4f) {
            const Hit hit =
                tree_.nearest(ray, from, kEverywhere, [&](const Hit& h) { return isSeen(h, ray); });
            if (!hit.triangle)
                return sum + through * background();
            const Point point = pointOf(model_, hit, ray);
            const float alpha = point.material->mode == Alpha::blend
                                    ? point.material->alphaAt(point.uv, float(point.colour.a))
                                    : 1.0f;
            sum += through * alpha * radianceOf(point, ray);
            through *= 1.0f - alpha;
            from = hit.distance * (1.0 + 1e-9);
        }
        return sum;
    }

    const Camera& camera() const { return model_.camera; }

private:
    // Neither a back face of a single-sided surface nor cut out.
    bool isSeen(const Hit& hit, const Ray& ray) const
    {
        const Material& material = model_.materials[size_t(hit.triangle->material)];
        if (!material.doubleSided && glm::dot(hit.triangle->front, ray.along) >= 0.0)
            return false;
        const Point point = pointOf(model_, hit, ray);
        return material.passes(material.alphaAt(point.uv, float(point.colour.a)));
    }

    bool isCaster(const Hit& hit, const Ray& ray) const
    {
        const Material& material = model_.materials[size_t(hit.triangle->material)];
        const bool emits =
            material.unlit || (material.emissive != glm::vec3(0.0f) && material.emission.empty());
        if (!material.doubleSided && glm::dot(hit.triangle->front, ray.along) <= 0.0)
            return false;
        const Point point = pointOf(model_, hit, ray);
        return material.mode != Alpha::blend && !emits &&
               material.passes(material.alphaAt(point.uv, float(point.colour.a)));
    }

    glm::vec3 background() const
    {
        if (question_.environment)
            return glm::vec3(*question_.environment);
        return 0.5f * (question_.sky + question_.ground); // at the horizon
    }

    glm::vec3 radianceOf(const Point& point, const Ray& ray) const
    {
        const Material& material = *point.material;
        if (material.unlit)
            return material.parametersAt(point.uv, point.colour).baseColour;
        const glm::vec3 toEye(-ray.along);
        const shared::SurfaceReflectance surface = surfaceOf(point, toEye);
        const glm::vec3 around = question_.environment
                                     ? *question_.environment * reflectEnvironment(surface, toEye)
                                     : shared::reflectAmbient(surface, question_.sky, question_.ground);
        glm::vec3 sum = material.emissionAt(point.uv) + around * material.occlusionAt(point.uv);
        for (const Light& light : model_.lights)
            sum += reflectedFrom(light, point, surface, toEye);
        return sum;
    }

    // KHR_lights_punctual: "Range Property" and "Inner and Outer Cone Angles".
    glm::vec3 reflectedFrom(const Light& light, const Point& point, const shared::SurfaceReflectance& surface,
                            glm::vec3 toEye) const
    {
        const bool sun = light.type == "directional";
        const glm::dvec3 apart = light.position - point.position;
        const double distance = sun ? kEverywhere : glm::length(apart);
        const glm::dvec3 toLight = sun ? -light.direction : apart / distance;
        double attenuation = sun ? 1.0 : 1.0 / (distance * distance);
        if (!sun && light.range > 0.0)
            attenuation *= glm::clamp(1.0 - std::pow(distance / light.range, 4.0), 0.0, 1.0);
        if (light.type == "spot") {
            const double outer = std::cos(light.outerCone), inner = std::cos(light.innerCone);
            const double cone =
                (glm::dot(-toLight, light.direction) - outer) / std::max(0.001, inner - outer);
            attenuation *= std::pow(glm::clamp(cone, 0.0, 1.0), 2.0);
        }
        if (attenuation == 0.0 ||
            (question_.shadows && light.type != "point" && isDark(point, toLight, distance)))
            return glm::vec3(0.0f);
        return shared::reflectLight(surface, glm::vec3(toLight), toEye,
                                    glm::vec3(light.intensity * attenuation));
    }

    bool isDark(const Point& point, glm::dvec3 toLight, double distance) const
    {
        const double apart = 1e-6 * (1.0 + glm::length(point.position)); // from the surface itself
        const Ray ray{point.position + apart * point.front, toLight};
        return tree_.nearest(ray, 0.0, distance, [&](const Hit& h) { return isCaster(h, ray); }).triangle;
    }

    Question question_;
    Model model_;
    BoxTree tree_;
};

// Where the i-th of `rays` rays crosses its pixel, in [0, 1): the Hammersley set (Niederreiter 1992), not
// the sequence that the renderer uses.
glm::dvec2 placeOfRay(int i, int rays)
{
    double mirrored = 0.0, digit = 0.5;
    for (int bits = i; bits > 0; bits >>= 1, digit *= 0.5)
        mirrored += digit * (bits & 1);
    return {(i + 0.5) / rays, mirrored + 0.5 / rays};
}

} // namespace

Answer castRays(const Question& question)
{
    const Caster caster(question);
    const glm::dmat4& world = caster.camera().worldFromCamera;
    const double up = std::tan(0.5 * caster.camera().yFov), right = up * question.size.x / question.size.y;
    Answer answer{question.size, std::vector<glm::vec3>(size_t(question.size.x) * question.size.y)};
    tbb::parallel_for(0u, question.size.y, [&](unsigned y) {
        for (unsigned x = 0; x < question.size.x; ++x) {
            glm::vec3 sum(0.0f);
            for (int i = 0; i < question.rays; ++i) {
                const glm::dvec2 place =
                    (glm::dvec2(x, y) + placeOfRay(i, question.rays)) / glm::dvec2(question.size);
                const glm::dvec3 along(right * (2.0 * place.x - 1.0), up * (1.0 - 2.0 * place.y), -1.0);
                sum +=
                    caster.radianceAlong({glm::dvec3(world[3]), glm::normalize(glm::dmat3(world) * along)});
            }
            answer.radiance[size_t(y) * question.size.x + x] = sum / float(question.rays);
        }
    });
    return answer;
}

} // namespace lumel::judge
