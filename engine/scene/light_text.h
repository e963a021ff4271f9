// A light in one word, for command lines.
#pragma once
#include "scene.h"

namespace lumel::scene {

// sun,DX,DY,DZ,R,G,B,LUX - D the way the light travels
// point,X,Y,Z,R,G,B,CANDELA[,RANGE] - metres; range 0 = unlimited
// spot,X,Y,Z,R,G,B,CANDELA,RANGE,DX,DY,DZ,INNER,OUTER - half angles of the cone in degrees
// Throws Error saying what is wrong.
Light parseLight(const std::string& text);
// parseLight() gives the same light again, bit for bit, of any light that it made.
std::string lightText(const Light& light);

} // namespace lumel::scene
