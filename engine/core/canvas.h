// Lines, boxes and text on a picture: for plots.
#pragma once
#include "image.h"
#include <glm/glm.hpp>
#include <memory>
#include <string>

namespace lumel {

enum class Align { left, centre, right };

// Coordinates in pixels from the upper left corner; colours are display values. Smooth edges: it is drawn at
// twice its size.
class Canvas {
public:
    // Throws Error when no font is found.
    Canvas(int width, int height, glm::vec3 background);
    ~Canvas();

    void line(glm::vec2 from, glm::vec2 to, glm::vec3 colour, float width = 1.0f);
    void box(glm::vec2 upperLeft, glm::vec2 lowerRight, glm::vec3 colour);
    // The baseline begins, is centred or ends at `at`; `size` is the font's in pixels.
    void text(glm::vec2 at, const std::string& text, glm::vec3 colour, int size = 13,
              Align align = Align::left);
    Image image() const; // RGB

private:
    struct Buffer; // OpenImageIO's
    std::unique_ptr<Buffer> buffer_;
    std::string font_;
    int width_, height_;
};

} // namespace lumel
