// Does a camera see anything of the scene?
#pragma once
#include "scene.h"

namespace lumel::scene {

// Whether front faces (or double-sided ones) of what is not wholly transparent take up a pixel of a picture
// of half a million. What hides others is seen itself, so nothing is traced. An animated scene is looked at
// all along its way, its meshes as they are at rest.
bool seesAnything(const Scene& scene, const Camera& camera, float aspect);

} // namespace lumel::scene
