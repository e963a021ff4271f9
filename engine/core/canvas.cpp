#include "canvas.h"
#include "error.h"
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <array>
#include <cmath>

namespace lumel {
namespace {

using namespace OIIO;

constexpr int kScale = 2; // drawn pixels for one of the picture, each way

// OpenImageIO knows fonts by file; its own search differs from version to version.
std::string findFont()
{
    constexpr std::array kFiles = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", // Debian
                                   "/usr/share/fonts/TTF/DejaVuSans.ttf",             // Arch
                                   "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                                   "/usr/share/fonts/dejavu/DejaVuSans.ttf"};
    for (const char* file : kFiles)
        if (std::filesystem::exists(file))
            return file;
    if (ImageBufAlgo::text_size("0", 16, "DejaVuSans").defined())
        return "DejaVuSans";
    throw Error("plots need the font DejaVu Sans, which is missing; install fonts-dejavu-core");
}

} // namespace

struct Canvas::Buffer {
    ImageBuf image;
};

Canvas::Canvas(int width, int height, glm::vec3 background)
    : buffer_(new Buffer{
          ImageBuf(ImageSpec(width * kScale, height * kScale, 3, TypeDesc::FLOAT), InitializePixels::No)}),
      font_(findFont()), width_(width), height_(height)
{
    ImageBufAlgo::fill(buffer_->image, {background.r, background.g, background.b});
}

Canvas::~Canvas() = default;

void Canvas::line(glm::vec2 from, glm::vec2 to, glm::vec3 colour, float width)
{
    const int strokes = std::max(1, int(std::lround(width * kScale)));
    const bool steep = std::abs(to.y - from.y) > std::abs(to.x - from.x);
    const glm::ivec2 a = glm::round(float(kScale) * from), b = glm::round(float(kScale) * to);
    for (int i = 0; i < strokes; ++i) {
        const int aside = i - (strokes - 1) / 2;
        const glm::ivec2 shift = steep ? glm::ivec2(aside, 0) : glm::ivec2(0, aside);
        ImageBufAlgo::render_line(buffer_->image, a.x + shift.x, a.y + shift.y, b.x + shift.x, b.y + shift.y,
                                  {colour.r, colour.g, colour.b}, i > 0);
    }
}

void Canvas::box(glm::vec2 upperLeft, glm::vec2 lowerRight, glm::vec3 colour)
{
    const glm::ivec2 a = glm::round(float(kScale) * upperLeft), b = glm::round(float(kScale) * lowerRight);
    ImageBufAlgo::render_box(buffer_->image, a.x, a.y, b.x, b.y, {colour.r, colour.g, colour.b}, true);
}

void Canvas::text(glm::vec2 at, const std::string& text, glm::vec3 colour, int size, Align align)
{
    using enum ImageBufAlgo::TextAlignX;
    const auto alignX = align == Align::left ? Left : align == Align::centre ? Center : Right;
    const glm::ivec2 p = glm::round(float(kScale) * at);
    if (!ImageBufAlgo::render_text(buffer_->image, p.x, p.y, text, size * kScale, font_,
                                   {colour.r, colour.g, colour.b}, alignX))
        throw Error("text cannot be drawn (" + buffer_->image.geterror() + "); install fonts-dejavu-core");
}

Image Canvas::image() const
{
    Image large(width_ * kScale, height_ * kScale, 3), small(width_, height_, 3);
    buffer_->image.get_pixels(ROI::All(), TypeDesc::FLOAT, large.pixels.data());
    for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x)
            for (int c = 0; c < 3; ++c) {
                float sum = 0.0f;
                for (int i = 0; i < kScale * kScale; ++i)
                    sum += large.at(x * kScale + i % kScale, y * kScale + i / kScale)[c];
                small.at(x, y)[c] = sum / float(kScale * kScale);
            }
    return small;
}

} // namespace lumel
