// One copy for GLSL and C++: this header gives C++ the GLSL names that the shared files use.
// Rules for shared files: float literals with 'f', no swizzles, no 'out' parameters, no default
// initialisers, 'uint' and never 'bool' in structs, and only glm's unaligned types (scalar layout).
#ifndef LUMEL_SHARED_COMPAT_H
#define LUMEL_SHARED_COMPAT_H
#ifdef __cplusplus
#include <glm/glm.hpp>
#include <cstdint>
#define LUMEL_SHARED_BEGIN namespace lumel::shared {
#define LUMEL_SHARED_END }
#define LUMEL_FN inline
#define LUMEL_CONST inline constexpr
namespace lumel::shared {
using glm::ivec2;
using glm::mat3;
using glm::mat4;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using uint = std::uint32_t;
using glm::abs;
using glm::clamp;
using glm::cross;
using glm::dot;
using glm::exp;
using glm::findMSB;
using glm::floatBitsToUint;
using glm::length;
using glm::log;
using glm::log2;
using glm::max;
using glm::min;
using glm::mix;
using glm::normalize;
using glm::pow;
using glm::sqrt;
} // namespace lumel::shared
#else
#define LUMEL_SHARED_BEGIN
#define LUMEL_SHARED_END
#define LUMEL_FN
#define LUMEL_CONST const
#endif
#endif
