#include "reflectance.h"
#include "shared/energy.h"
#include <algorithm>
#include <cmath>

namespace lumel::judge {
namespace {

// KHR_materials_ior, and 0.04 at its default of 1.5; KHR_materials_specular, "Implementation":
// dielectric_f0 = min(F0 * specularColor, 1) * specular.
glm::vec3 dielectricReflectance(const Parameters& p)
{
    const float f0 = std::pow((p.ior - 1.0f) / (p.ior + 1.0f), 2.0f);
    return glm::min(f0 * p.specularColour, glm::vec3(1.0f)) * p.specular;
}

// KHR_materials_anisotropy: alpha_t = mix(alpha, 1, strength^2) along the direction, alpha across it.
glm::vec3 covarianceOf(const Parameters& p)
{
    const float alpha = p.roughness * p.roughness;
    // glTF 2.0, appendix B.2.3: alpha is the square of the roughness.
    const float alphaAlong = alpha + (1.0f - alpha) * p.anisotropy * p.anisotropy;
    const float along = 1.0f / shared::powerFromRoughness(std::sqrt(alphaAlong));
    const float across = 1.0f / shared::powerFromRoughness(p.roughness);
    const glm::vec2 d = p.anisotropyDirection;
    return {along * d.x * d.x + across * d.y * d.y, (along - across) * d.x * d.y,
            along * d.y * d.y + across * d.x * d.x};
}

} // namespace

Reflectance reflectanceOf(const Parameters& p)
{
    const glm::vec3 covariance = covarianceOf(p);
    if (p.specularGlossiness) { // KHR_materials_pbrSpecularGlossiness: c_diff = diffuse * (1 - max(specular))
        const float rest = 1.0f - std::max({p.specularColour.r, p.specularColour.g, p.specularColour.b});
        return {p.specularColour, p.baseColour * rest, covariance};
    }
    // glTF 2.0, section 3.9.2: metals reflect their base colour, and nothing diffusely. Appendix B.3.4: what
    // Fresnel takes is not left for diffuse reflection; here at normal incidence, shared/shading.h adds what
    // the view does.
    const glm::vec3 dielectric = dielectricReflectance(p);
    const float left = 1.0f - std::max({dielectric.r, dielectric.g, dielectric.b});
    return {glm::mix(dielectric, p.baseColour, p.metallic), p.baseColour * ((1.0f - p.metallic) * left),
            covariance};
}

} // namespace lumel::judge
