// Where the camera of each frame stands: a pure function, so that every run of a path shows the same frames.
#pragma once
#include "scene.h"

namespace lumel::scene {

enum class Path { still, orbit, dolly, pan, animation };

// The camera of frame `index`; frame 0 is `start`. Target and field of view stay.
// orbit: `step` degrees a frame about the world's up axis through the target, to the right for positive
//        steps. (The camera's own up axis leans where it looks down: the orbit would pass below the floor.)
// dolly: the distance to the target shrinks by `step` percent a frame; `step` < 100. It ends at
//        1/10000 and at a million times the start's distance.
// pan:   camera and target move to the right by `step` percent of their distance a frame.
// animation: as its node moves the camera (moved() of animation.h): here it stands still.
// Frames before the start have negative indices.
Camera cameraOnPath(const Camera& start, Path path, double step, int index);

// The `step` of a path when the user names none.
double defaultStep(Path path);

} // namespace lumel::scene
