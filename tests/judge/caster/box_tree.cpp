#include "box_tree.h"
#include <algorithm>
#include <numeric>

namespace lumel::judge {
namespace {

constexpr size_t kLeafTriangles = 4;

glm::dvec3 centreOf(const Triangle& t)
{
    return (t.corners[0].position + t.corners[1].position + t.corners[2].position) / 3.0;
}

// Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection".
Hit intersect(const Ray& ray, const Triangle& triangle)
{
    const glm::dvec3 a = triangle.corners[0].position;
    const glm::dvec3 ab = triangle.corners[1].position - a, ac = triangle.corners[2].position - a;
    const glm::dvec3 p = glm::cross(ray.along, ac);
    const double determinant = glm::dot(ab, p);
    if (determinant == 0.0)
        return {};
    const glm::dvec3 s = ray.from - a, q = glm::cross(s, ab);
    const double v = glm::dot(s, p) / determinant, w = glm::dot(ray.along, q) / determinant;
    if (v < 0.0 || w < 0.0 || v + w > 1.0)
        return {};
    return {glm::dot(ac, q) / determinant, &triangle, {1.0 - v - w, v, w}};
}

bool meets(const Ray& ray, glm::dvec3 lower, glm::dvec3 upper, double from, double to)
{
    const glm::dvec3 a = (lower - ray.from) / ray.along, b = (upper - ray.from) / ray.along;
    for (int i = 0; i < 3; ++i) {
        if (ray.along[i] == 0.0) {
            if (ray.from[i] < lower[i] || ray.from[i] > upper[i])
                return false;
            continue;
        }
        from = std::max(from, std::min(a[i], b[i]));
        to = std::min(to, std::max(a[i], b[i]));
    }
    return from <= to;
}

} // namespace

BoxTree::BoxTree(const std::vector<Triangle>& triangles) : triangles_(triangles), order_(triangles.size())
{
    std::iota(order_.begin(), order_.end(), size_t(0));
    if (!order_.empty())
        build(0, order_.size());
}

void BoxTree::build(size_t first, size_t count)
{
    const size_t at = nodes_.size();
    Node node;
    glm::dvec3 least(1e300), greatest(-1e300); // of the centres
    for (size_t i = first; i < first + count; ++i) {
        const Triangle& triangle = triangles_[order_[i]];
        for (const Corner& corner : triangle.corners) {
            node.lower = glm::min(node.lower, corner.position);
            node.upper = glm::max(node.upper, corner.position);
        }
        least = glm::min(least, centreOf(triangle));
        greatest = glm::max(greatest, centreOf(triangle));
    }
    const double margin = 1e-9 * (1.0 + glm::length(node.upper - node.lower)); // flat boxes, rounding
    node.lower -= margin;
    node.upper += margin;
    if (count <= kLeafTriangles) {
        node.first = first;
        node.count = count;
        nodes_.push_back(node);
        return;
    }
    nodes_.push_back(node);
    const glm::dvec3 extent = greatest - least;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const auto begin = order_.begin() + std::ptrdiff_t(first);
    std::nth_element(
        begin, begin + std::ptrdiff_t(count / 2), begin + std::ptrdiff_t(count),
        [&](size_t a, size_t b) { return centreOf(triangles_[a])[axis] < centreOf(triangles_[b])[axis]; });
    build(first, count / 2);
    nodes_[at].second = nodes_.size();
    build(first + count / 2, count - count / 2);
}

Hit BoxTree::nearest(const Ray& ray, double from, double to,
                     const std::function<bool(const Hit&)>& counts) const
{
    Hit best;
    std::vector<size_t> open;
    if (!nodes_.empty())
        open.push_back(0);
    while (!open.empty()) {
        const size_t at = open.back();
        open.pop_back();
        const Node& node = nodes_[at];
        if (!meets(ray, node.lower, node.upper, from, to))
            continue;
        if (node.count == 0) {
            open.push_back(node.second);
            open.push_back(at + 1);
        }
        for (size_t i = node.first; i < node.first + node.count; ++i) {
            const Hit hit = intersect(ray, triangles_[order_[i]]);
            if (hit.triangle && hit.distance > from && hit.distance < to && counts(hit)) {
                best = hit;
                to = hit.distance;
            }
        }
    }
    return best;
}

} // namespace lumel::judge
