// Accessors and animation samplers of a glTF file as plain numbers.
#pragma once
#include <glm/glm.hpp>
#include <tiny_gltf.h>
#include <vector>

namespace lumel::judge {

// An accessor's elements, normalised integers as fractions. components: in each.
struct Values {
    std::vector<double> numbers;
    size_t components = 1;

    size_t count() const { return numbers.size() / components; }
    const double* at(size_t i) const { return &numbers[i * components]; }
    glm::dvec2 vec2(size_t i) const { return {at(i)[0], at(i)[1]}; }
    glm::dvec3 vec3(size_t i) const { return {at(i)[0], at(i)[1], at(i)[2]}; }
    glm::dmat4 mat4(size_t i) const;
};

// Empty for accessor -1.
Values readAccessor(const tinygltf::Model& model, int accessor);

// glTF 2.0, appendix C: the value of an animation's sampler at a time. components: of its value, as many as a
// mesh has morph targets for weights; rotations are interpolated on the sphere.
std::vector<double> sampleAnimation(const tinygltf::Model& model, const tinygltf::AnimationSampler& sampler,
                                    size_t components, bool rotation, double seconds);

} // namespace lumel::judge
