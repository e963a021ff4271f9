// What both languages compute in formulas_test.cpp, in both languages.
#ifndef LUMEL_TEST_FORMULAS_H
#define LUMEL_TEST_FORMULAS_H
#include "shared/environment.h"
#include "shared/shading.h"
LUMEL_SHARED_BEGIN

// A lobe somewhere in the world, a light and a view.
struct FormulaInput {
    vec3 tangent, bitangent, macroNormal; // orthonormal, of either handedness
    vec2 normal;      // the lobe's, on the disc of the tangent frame
    vec3 covariance;  // in the lobe's own frame
    vec3 specular, diffuse;
    vec3 position;
    vec3 toEye;
    Light light;
};

// Everything that the formulas say of it.
struct FormulaOutput {
    vec3 lobeNormal, lobeTangentU;
    float shape;        // at the half vector, made from normal and covariance
    float preparedShape; // of the lobe in world space
    float falloff;
    vec3 toLight, irradiance;
    vec3 fresnel;
    vec3 reflected;
    vec3 ambient;
    float environmentLevel, environmentVariance;
    vec4 environmentLobe; // A, B, towards the normal, narrowing
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
    SurfaceReflectance surface;
    surface.lobe = local;
    surface.lobe.normal = worldFromTangent * local.normal;
    surface.lobe.tangentU = worldFromTangent * local.tangentU;
    surface.lobe.tangentV = worldFromTangent * local.tangentV;
    surface.macroNormal = given.macroNormal;
    surface.specular = given.specular;
    surface.diffuse = given.diffuse;

    Incident incident = incidentLight(given.light, given.position);
    result.toLight = incident.direction;
    result.irradiance = incident.irradiance;
    vec3 h = normalize(incident.direction + given.toEye);
    // The same half vector in the tangent frame.
    vec3 hLocal = vec3(dot(given.tangent, h), dot(given.bitangent, h), dot(given.macroNormal, h));
    result.shape = lobeShape(result.lobeNormal, given.covariance, hLocal);
    result.preparedShape = lobeShape(surface.lobe, h);
    result.falloff = lobeFalloff(min(given.covariance.x, 0.99f)); // any number of [0, 1)
    result.fresnel = fresnelSchlick(given.specular, dot(given.toEye, h));
    result.reflected = reflectLight(surface, incident.direction, given.toEye, incident.irradiance);
    result.ambient = reflectAmbient(surface, vec3(0.4f, 0.5f, 0.6f), vec3(0.3f, 0.2f, 0.1f));

    result.environmentLevel = environmentLevel(given.covariance.x);
    result.environmentVariance = environmentVariance(result.environmentLevel);
    EnvironmentLobe lobe = environmentLobe(dot(given.macroNormal, given.toEye), given.covariance.z);
    result.environmentLobe = vec4(lobe.reflected, lobe.grazing, lobe.towardsNormal, lobe.narrowing);
    result.environmentPlace = environmentPlace(given.toEye);
    result.environmentDirection = environmentDirection(result.environmentPlace);
    return result;
}

LUMEL_SHARED_END
#endif
