// Where the camera of each frame stands: a pure function, so that every run of a path shows the same frames.
#pragma once
#include "scene.h"

namespace lumel::scene {

enum class Path { still, orbit, dolly };

// The camera of frame `index`; frame 0 is `start`. Target and field of view stay.
// orbit: `step` degrees a frame about the world's up axis through the target, to the right for positive
//        steps. (The camera's own up axis leans where it looks down: it would lead under the floor.)
// dolly: the distance to the target shrinks by `step` percent a frame; `step` < 100. It ends at
//        1/10000 and at a million times the start's distance.
Camera cameraOnPath(const Camera& start, Path path, double step, int index);

} // namespace lumel::scene
