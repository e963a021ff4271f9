#include "playback.h"
#include "core/error.h"
#include "scene/environment.h"
#include <fmt/format.h>

namespace lumel {

Playback::Playback(const scene::Scene& scene, const scene::Camera& start, const PathOptions& options)
    : animation_(scene.animation), start_(start), options_(options), lights_(scene::lightsOf(scene)),
      skins_(scene.skins), deformed_(scene.deformed),
      plays_(scene.animation.seconds > 0.0 && (options.seconds || options.path == scene::Path::animation))
{
    if (options.path == scene::Path::animation && start.node < 0)
        throw Error(fmt::format("{}: camera '{}' is not animated; choose another --path or --camera",
                                scene.file.string(), start.name));
    for (size_t i = 0; i < scene.objects.size(); ++i)
        if (scene.objects[i].node >= 0)
            movingObjects_.push_back({i, scene.objects[i].node, scene.objects[i].nodeFromObject});
}

double Playback::secondsOf(int frame) const
{
    return options_.seconds.value_or(0.0) + options_.timeStep * frame;
}

scene::Pose Playback::poseOf(int frame) const
{
    return poseAt(animation_, secondsOf(frame));
}

scene::Camera Playback::camera(int frame) const
{
    if (!plays_)
        return scene::cameraOnPath(start_, options_.path, options_.stepOrDefault(), frame);
    if (options_.path == scene::Path::animation)
        return moved(start_, poseOf(frame));
    return scene::cameraOnPath(moved(start_, poseOf(0)), options_.path, options_.stepOrDefault(), frame);
}

void Playback::apply(Renderer& renderer, int frame) const
{
    if (!plays_) {
        renderer.setLights(lights_);
        return;
    }
    pose(renderer, secondsOf(frame));
}

void Playback::pose(Renderer& renderer, double seconds) const
{
    const scene::Pose pose = poseAt(animation_, seconds);
    renderer.setLights(moved(lights_, pose));
    for (const MovingObject& moving : movingObjects_)
        renderer.moveObject(moving.object, pose[size_t(moving.node)] * moving.nodeFromObject);
    if (!deformed_.empty())
        renderer.deform(shapesAt(skins_, deformed_, animation_, seconds));
}

} // namespace lumel
