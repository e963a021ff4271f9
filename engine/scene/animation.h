// Node animations: where what moves stands at a given time. A pure function of the time, so that every run
// shows the same frames.
#pragma once
#include "core/math.h"
#include <vector>

namespace lumel::scene {

struct Camera;
struct Light;
struct Scene;

enum class Interpolation { linear, step, cubicSpline };

// One property of a node over time, as glTF 2.0 (appendix C) stores it.
struct Track {
    Interpolation interpolation = Interpolation::linear;
    std::vector<float> seconds;    // rising
    std::vector<glm::vec4> values; // one a key; cubicSpline: in-tangent, value and out-tangent of each key
    bool empty() const { return seconds.empty(); }
};

// The value at a time; before the first and after the last key theirs.
glm::vec3 sampleVector(const Track& track, double seconds);
glm::quat sampleRotation(const Track& track, double seconds); // values: x, y, z, w; unit length comes out

// Properties that move; empty ones keep what the node says.
struct NodeTracks {
    Track translation, rotation, scale;
};

// Weights of morph targets over time, `count` at once.
struct WeightTrack {
    Interpolation interpolation = Interpolation::linear;
    std::vector<float> seconds; // rising
    std::vector<float> values;  // as of Track, `count` in place of one
    size_t count = 0;
};
std::vector<float> sampleWeights(const WeightTrack& track, double seconds);

// A node that moves, or one below it. `matrix` is of a node that only its ancestors move.
struct MovingNode {
    int parent = -1;                 // in Animation::nodes, always before this one; -1: stands still
    glm::mat4 worldFromParent{1.0f}; // of a parent that stands still
    glm::mat4 matrix{1.0f};
    glm::vec3 translation{0.0f}, scale{1.0f};
    glm::quat rotation{1.0f, 0.0f, 0.0f, 0.0f};
    bool moves = false; // by tracks of its own: matrix counts not
    NodeTracks tracks;
};

struct Animation {
    std::vector<MovingNode> nodes;
    std::vector<WeightTrack> weights;
    double seconds = 0.0; // then it starts again; 0: nothing moves
};

// World transforms of animation.nodes.
using Pose = std::vector<glm::mat4>;
Pose poseAt(const Animation& animation, double seconds);
// The time in [0, animation.seconds) that is shown then: all plays again and again.
double timeInRound(const Animation& animation, double seconds);

// What the pose makes of a camera or light; those that no node moves stay as they are.
Camera moved(const Camera& camera, const Pose& pose);
Light moved(const Light& light, const Pose& pose);
std::vector<Light> moved(const std::vector<Light>& lights, const Pose& pose);

} // namespace lumel::scene
