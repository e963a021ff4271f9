#include "animation.h"
#include "scene.h"
#include <algorithm>
#include <cmath>

namespace lumel::scene {
namespace {

// Two keys and how far between them, in [0, 1].
struct Span {
    size_t before = 0, after = 0;
    float share = 0.0f, seconds = 0.0f;
};

Span spanAt(const std::vector<float>& keys, double seconds)
{
    const auto next = std::upper_bound(keys.begin(), keys.end(), float(seconds));
    if (next == keys.begin())
        return {};
    if (next == keys.end())
        return {keys.size() - 1, keys.size() - 1, 0.0f, 0.0f};
    const auto after = size_t(next - keys.begin());
    const float length = keys[after] - keys[after - 1];
    return {after - 1, after, float((seconds - keys[after - 1]) / length), length};
}

// glTF 2.0, appendix C.5 "Cubic Spline Interpolation": Hermite, tangents a second. valueAt(i): the i-th of
// the track's values, three a key.
template<class ValueAt>
auto cubic(const ValueAt& valueAt, const Span& at)
{
    const float t = at.share, t2 = t * t, t3 = t2 * t;
    const auto from = valueAt(3 * at.before + 1), leaving = valueAt(3 * at.before + 2),
               arriving = valueAt(3 * at.after), to = valueAt(3 * at.after + 1);
    return (2.0f * t3 - 3.0f * t2 + 1.0f) * from + at.seconds * (t3 - 2.0f * t2 + t) * leaving +
           (-2.0f * t3 + 3.0f * t2) * to + at.seconds * (t3 - t2) * arriving;
}

glm::vec4 cubic(const Track& track, const Span& at)
{
    return cubic([&](size_t i) { return track.values[i]; }, at);
}

glm::quat quatOf(glm::vec4 v)
{
    // A spline can pass through zero; any rotation is better than none.
    const float length = glm::length(v);
    return length > 1e-12f ? glm::quat(v.w, v.x, v.y, v.z) / length : glm::quat(1.0f, 0.0f, 0.0f, 0.0f);
}

// Animations hide things by scaling them to nothing, but transforms are to be inverted.
glm::vec3 invertible(glm::vec3 scale)
{
    constexpr float kLeast = 1e-5f;
    for (int i = 0; i < 3; ++i)
        if (std::abs(scale[i]) < kLeast)
            scale[i] = std::copysign(kLeast, scale[i]);
    return scale;
}

glm::mat4 parentFromNode(const MovingNode& node, double seconds)
{
    if (!node.moves)
        return node.matrix;
    const NodeTracks& tracks = node.tracks;
    glm::vec3 translation = node.translation, scale = node.scale;
    glm::quat rotation = node.rotation;
    if (!tracks.translation.empty())
        translation = sampleVector(tracks.translation, seconds);
    if (!tracks.rotation.empty())
        rotation = sampleRotation(tracks.rotation, seconds);
    if (!tracks.scale.empty())
        scale = sampleVector(tracks.scale, seconds);
    return glm::scale(glm::translate(glm::mat4(1.0f), translation) * glm::mat4_cast(rotation),
                      invertible(scale));
}

} // namespace

glm::vec3 sampleVector(const Track& track, double seconds)
{
    const Span at = spanAt(track.seconds, seconds);
    if (track.interpolation == Interpolation::cubicSpline)
        return cubic(track, at);
    if (track.interpolation == Interpolation::step)
        return track.values[at.before];
    return glm::mix(track.values[at.before], track.values[at.after], at.share);
}

glm::quat sampleRotation(const Track& track, double seconds)
{
    const Span at = spanAt(track.seconds, seconds);
    if (track.interpolation == Interpolation::cubicSpline)
        return quatOf(cubic(track, at));
    if (track.interpolation == Interpolation::step)
        return quatOf(track.values[at.before]);
    return glm::slerp(quatOf(track.values[at.before]), quatOf(track.values[at.after]), at.share);
}

std::vector<float> sampleWeights(const WeightTrack& track, double seconds)
{
    const Span at = spanAt(track.seconds, seconds);
    std::vector<float> weights(track.count);
    for (size_t w = 0; w < track.count; ++w) {
        const auto valueAt = [&](size_t i) { return track.values[i * track.count + w]; };
        if (track.interpolation == Interpolation::cubicSpline)
            weights[w] = cubic(valueAt, at);
        else if (track.interpolation == Interpolation::step)
            weights[w] = valueAt(at.before);
        else
            weights[w] = glm::mix(valueAt(at.before), valueAt(at.after), at.share);
    }
    return weights;
}

double timeInRound(const Animation& animation, double seconds)
{
    return animation.seconds > 0.0 ? seconds - std::floor(seconds / animation.seconds) * animation.seconds
                                   : seconds;
}

Pose poseAt(const Animation& animation, double seconds)
{
    seconds = timeInRound(animation, seconds);
    Pose pose;
    pose.reserve(animation.nodes.size());
    for (const MovingNode& node : animation.nodes)
        pose.push_back((node.parent >= 0 ? pose[size_t(node.parent)] : node.worldFromParent) *
                       parentFromNode(node, seconds));
    return pose;
}

// glTF 2.0, section 3.10: looks along the node's -Z, +Y up. The target keeps its distance.
Camera moved(const Camera& camera, const Pose& pose)
{
    Camera result = camera;
    if (camera.node < 0)
        return result;
    const glm::mat4& world = pose[size_t(camera.node)];
    result.eye = glm::vec3(world[3]);
    result.target =
        result.eye - glm::distance(camera.eye, camera.target) * glm::normalize(glm::vec3(world[2]));
    result.up = glm::normalize(glm::vec3(world[1]));
    return result;
}

Light moved(const Light& light, const Pose& pose)
{
    Light result = light;
    if (light.node < 0)
        return result;
    const glm::mat4& world = pose[size_t(light.node)];
    result.position = glm::vec3(world[3]);
    result.direction = -glm::normalize(glm::vec3(world[2]));
    return result;
}

std::vector<Light> moved(const std::vector<Light>& lights, const Pose& pose)
{
    std::vector<Light> result;
    result.reserve(lights.size());
    for (const Light& light : lights)
        result.push_back(moved(light, pose));
    return result;
}

} // namespace lumel::scene
