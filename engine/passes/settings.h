// What a frame is asked to be: every field is also an option of the commands.
#pragma once
#include <cstddef>
#include <glm/glm.hpp>

namespace lumel {

enum class Shading { tsl, forward, reference };
enum class DrawFilter { bilinear, bspline, catmullRom }; // same order as kFilter...

struct Settings {
    Shading shading = Shading::tsl;
    glm::uvec2 size{960, 540};
    DrawFilter filter = DrawFilter::catmullRom;
    float anisotropy = 8.0f; // most taps along a footprint's long axis when drawing lit textures
    int msaa = 4;            // coverage samples of tsl and forward: 1 or 4
    int samples = 64;        // reference: shifted frames per picture
    float exposure = 1.0f;
    size_t poolBytes = size_t(256) << 20;
};

} // namespace lumel
