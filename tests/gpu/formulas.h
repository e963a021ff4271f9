// What both languages compute in formulas_test.cpp, in both languages.
#ifndef LUMEL_TEST_FORMULAS_H
#define LUMEL_TEST_FORMULAS_H
#include "shared/environment.h"
#include "shared/shading.h"
LUMEL_SHARED_BEGIN

// A lobe somewhere in the world, a light and a view.
struct FormulaInput {
    vec3 tangent, bitangent, macroNormal; // orthonormal, of either handedness
    vec2 normal;                          // the lobe's, on the disc of the tangent frame
    vec3 covariance;                      // in the lobe's own frame
    vec3 f0, diffuse;
    vec3 position;
    vec3 toEye;
    Light light;
};

// Everything that the formulas say of it.
struct FormulaOutput {
    vec3 lobeNormal, lobeTangentU;
    float shape;         // at the half vector, made from normal and covariance
    float preparedShape; // of the lobe in world space
    float falloff;
    vec3 toLight, irradiance;
    vec3 fresnel;
    vec3 reflected;
    vec3 ambient;
    float environmentLevel, environmentVariance;
    vec2 environmentLobe; // towards the normal, narrowing
    vec3 strength;        // Ks
    vec3 reflectance;     // F0 of that Ks
    float residual, grazing, power;
    vec2 environmentPlace;
    vec3 environmentDirection; // of that place
};

LUMEL_FN FormulaOutput formulas(FormulaInput given)
{
    FormulaOutput result;
    mat3 worldFromTangent = mat3(given.tangent, given.bitangent, given.macroNormal);
    result.lobeNormal = lobeNormal(given.normal);
    result.lobeTangentU = lobeTangentU(result.lobeNormal);
    Lobe local = makeLobe(result.lobeNormal, given.covariance);
    Lobe lobe = Lobe(worldFromTangent * local.normal, worldFromTangent * local.tangentU,
                     worldFromTangent * local.tangentV, local.inverseCovariance, local.scale);
    result.strength = specularStrength(given.f0, given.covariance);
    result.reflectance = reflectanceOf(result.strength, given.covariance);
    float variance = 0.5f * (given.covariance.x + given.covariance.z);
    result.residual = energyResidual(dot(given.macroNormal, given.toEye), variance);
    result.grazing = grazingShare(dot(given.macroNormal, given.toEye), variance);
    result.power = powerFromRoughness(given.f0.x);
    SurfaceReflectance surface = reflectanceTowards(
        SurfaceTexel(lobe, given.macroNormal, result.strength, given.f0, variance, given.diffuse),
        given.toEye);

    Incident incident = incidentLight(given.light, given.position);
    result.toLight = incident.direction;
    result.irradiance = incident.irradiance;
    vec3 h = normalize(incident.direction + given.toEye);
    // The same half vector in the tangent frame.
    vec3 hLocal = vec3(dot(given.tangent, h), dot(given.bitangent, h), dot(given.macroNormal, h));
    result.shape = lobeShape(result.lobeNormal, given.covariance, hLocal);
    result.preparedShape = lobeShape(surface.lobe, h);
    result.falloff = lobeFalloff(min(given.covariance.x, 0.99f)); // any number of [0, 1)
    result.fresnel = fresnelSchlick(given.f0, dot(given.toEye, h));
    result.reflected = reflectLight(surface, incident.direction, given.toEye, incident.irradiance);
    result.ambient = reflectAmbient(surface, vec3(0.4f, 0.5f, 0.6f), vec3(0.3f, 0.2f, 0.1f));

    result.environmentLevel = environmentLevel(given.covariance.x);
    result.environmentVariance = environmentVariance(result.environmentLevel);
    EnvironmentLobe around = environmentLobe(dot(given.macroNormal, given.toEye), given.covariance.z);
    result.environmentLobe = vec2(around.towardsNormal, around.narrowing);
    result.environmentPlace = environmentPlace(given.toEye);
    result.environmentDirection = environmentDirection(result.environmentPlace);
    return result;
}

LUMEL_SHARED_END
#endif
