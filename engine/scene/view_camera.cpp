#include "view_camera.h"
#include <algorithm>
#include <numbers>

namespace lumel::scene {
namespace {

constexpr float kPole = 0.9995f; // |y| of a direction, at most: beyond it "up" is undefined

// `direction` turned by parts of half a turn about the vertical and about the horizontal beside it.
glm::vec3 turned(glm::vec3 direction, glm::vec2 halfTurns)
{
    const float pi = float(std::numbers::pi);
    const float length = glm::length(direction);
    float azimuth = std::atan2(direction.x, direction.z) + halfTurns.x * pi;
    const float most = std::asin(kPole);
    float height = std::asin(std::clamp(direction.y / length, -1.0f, 1.0f)) + halfTurns.y * pi;
    height = std::clamp(height, -most, most);
    return length * glm::vec3(std::cos(height) * std::sin(azimuth), std::sin(height),
                              std::cos(height) * std::cos(azimuth));
}

} // namespace

void ViewCamera::reset(const Camera& camera, const Bounds& bounds, bool moved)
{
    camera_ = camera;
    bounds_ = bounds;
    fovDegrees_ = glm::degrees(camera.yFov);
    moved_ = false;
    if (moved)
        set(camera.eye, camera.target);
}

Camera ViewCamera::atPoints(glm::vec3 eye, glm::vec3 target, float fovDegrees, const Bounds& bounds)
{
    Camera camera;
    camera.name = "options";
    camera.eye = eye;
    camera.target = target;
    camera.yFov = glm::radians(fovDegrees);
    camera.nearMetres = std::max(1e-4f, 0.001f * bounds.radius());
    return camera;
}

void ViewCamera::set(glm::vec3 eye, glm::vec3 target)
{
    camera_ = atPoints(eye, target, fovDegrees_, bounds_);
    moved_ = true;
}

void ViewCamera::setFovDegrees(float degrees)
{
    fovDegrees_ = degrees;
    set(camera_.eye, camera_.target);
}

void ViewCamera::orbit(glm::vec2 halfTurns)
{
    set(camera_.target + turned(camera_.eye - camera_.target, halfTurns), camera_.target);
}

void ViewCamera::look(glm::vec2 halfTurns)
{
    set(camera_.eye, camera_.eye + turned(camera_.target - camera_.eye, halfTurns));
}

void ViewCamera::pan(glm::vec2 heights)
{
    const glm::vec3 forward = glm::normalize(camera_.target - camera_.eye);
    const glm::vec3 right = glm::normalize(glm::cross(forward, camera_.up));
    const float height = 2.0f * glm::distance(camera_.eye, camera_.target) * std::tan(0.5f * camera_.yFov);
    const glm::vec3 step = height * (heights.x * right + heights.y * glm::cross(right, forward));
    set(camera_.eye + step, camera_.target + step);
}

void ViewCamera::dolly(float steps)
{
    const float radius = std::max(bounds_.radius(), 1e-3f);
    const glm::vec3 back = camera_.eye - camera_.target;
    const float before = glm::length(back);
    // Not into the target, and not so far that the scene is a point.
    const float after = std::clamp(before * std::pow(0.9f, steps), 0.002f * radius, 200.0f * radius);
    set(camera_.target + back * (after / before), camera_.target);
}

void ViewCamera::fly(glm::vec3 direction, float seconds)
{
    const glm::vec3 forward = glm::normalize(camera_.target - camera_.eye);
    const glm::vec3 right = glm::normalize(glm::cross(forward, camera_.up));
    const float speed = std::max(glm::distance(camera_.eye, camera_.target), 0.2f * bounds_.radius());
    const glm::vec3 step =
        seconds * speed * (direction.x * right + direction.y * camera_.up + direction.z * forward);
    set(camera_.eye + step, camera_.target + step);
}

void ViewCamera::focus(const Bounds& bounds)
{
    if (bounds.empty())
        return;
    const float radius = std::max(bounds.radius(), 0.001f * std::max(bounds_.radius(), 1e-3f));
    const float distance = 1.1f * radius / std::sin(0.5f * camera_.yFov);
    const glm::vec3 back = glm::normalize(camera_.eye - camera_.target);
    set(bounds.centre() + distance * back, bounds.centre());
}

} // namespace lumel::scene
