// Rays against triangles by a tree of boxes.
#pragma once
#include "model.h"
#include <functional>

namespace lumel::judge {

struct Ray {
    glm::dvec3 from, along; // unit
};

struct Hit {
    double distance = 0.0;
    const Triangle* triangle = nullptr; // none: nothing is hit
    glm::dvec3 weights{0.0};            // of its corners
};

class BoxTree {
public:
    explicit BoxTree(const std::vector<Triangle>& triangles);

    // The nearest hit between the two distances that counts.
    Hit nearest(const Ray& ray, double from, double to, const std::function<bool(const Hit&)>& counts) const;

private:
    struct Node {
        glm::dvec3 lower{1e300}, upper{-1e300};
        size_t first = 0, count = 0; // of order_; count 0: the children are this node's next and `second`
        size_t second = 0;
    };
    void build(size_t first, size_t count);

    const std::vector<Triangle>& triangles_;
    std::vector<size_t> order_;
    std::vector<Node> nodes_;
};

} // namespace lumel::judge
