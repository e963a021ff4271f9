// Shaders compiled again from their sources while the program runs: those in the folder LUMEL_SHADERS of the
// environment, or those that the program was built from.
#pragma once

namespace lumel::gpu {

// Replaces the code that shaderCode() gives; pipelines made from now on use it. Throws Error with the
// compiler's first message, and changes nothing, when a shader does not compile or no compiler is there.
void reloadShaders();

} // namespace lumel::gpu
