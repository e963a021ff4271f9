#include "report_pictures.h"
#include "core/image.h"
#include "shared/lobe.h"
#include <array>
#include <span>

namespace lumel::baker {
namespace {

constexpr int kSide = 176; // pixels of a disc's picture
constexpr double kSteepness = 60.0;
constexpr glm::dvec3 kPage{0.055, 0.063, 0.086}; // the page's background

// Dark violet through orange to pale yellow at the peak; beyond it towards ice blue.
constexpr std::array<glm::dvec3, 9> kHeat{{{0.02, 0.024, 0.047},
                                           {0.15, 0.067, 0.33},
                                           {0.416, 0.11, 0.43},
                                           {0.675, 0.18, 0.345},
                                           {0.886, 0.345, 0.204},
                                           {0.98, 0.616, 0.141},
                                           {0.988, 0.878, 0.43},
                                           {1.0, 1.0, 0.882},
                                           {0.56, 0.86, 1.0}}};
constexpr double kPeakStop = 7.0 / 8.0; // where among the stops the peak is

// Least error first.
constexpr std::array<glm::dvec3, 7> kDepth{{{1.0, 0.93, 0.52},
                                            {0.52, 0.83, 0.35},
                                            {0.14, 0.66, 0.52},
                                            {0.15, 0.45, 0.56},
                                            {0.24, 0.27, 0.53},
                                            {0.20, 0.10, 0.32},
                                            {0.075, 0.045, 0.125}}};

glm::dvec3 ramp(std::span<const glm::dvec3> stops, double t)
{
    const double at = std::clamp(t, 0.0, 1.0) * double(stops.size() - 1);
    const size_t i = std::min(size_t(at), stops.size() - 2);
    return glm::mix(stops[i], stops[i + 1], at - double(i));
}

glm::dvec3 heat(double valueOverPeak)
{
    const double t = scalePosition(valueOverPeak), end = scalePosition(kScaleEnd);
    return ramp(kHeat, t <= 1.0 ? t * kPeakStop : kPeakStop + (t - 1.0) / (end - 1.0) * (1.0 - kPeakStop));
}

void setPixel(Image& image, int x, int y, glm::dvec3 colour)
{
    for (int c = 0; c < 3; ++c)
        image.at(x, y)[c] = float(colour[c]);
}

std::string dataUri(const Image& image)
{
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::vector<unsigned char> bytes = encodePng(image);
    std::string text = "data:image/png;base64,";
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const size_t left = bytes.size() - i;
        const uint32_t word = uint32_t(bytes[i]) << 16 | (left > 1 ? uint32_t(bytes[i + 1]) << 8 : 0u) |
                              (left > 2 ? uint32_t(bytes[i + 2]) : 0u);
        text += digits[word >> 18];
        text += digits[word >> 12 & 63];
        text += left > 1 ? digits[word >> 6 & 63] : '=';
        text += left > 2 ? digits[word & 63] : '=';
    }
    return text;
}

// A square of the disc, +x right and +y up, with rings at sin(theta) = 1/4, 1/2, 3/4 and 1 and the axes.
template<class Value>
std::string discPicture(const View& view, const Value& value)
{
    Image image(kSide, kSide, 3);
    const double pixel = 2.0 * view.half / kSide;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const double x = view.x - view.half + (i + 0.5) * pixel,
                         y = view.y + view.half - (j + 0.5) * pixel;
            const double r = std::sqrt(x * x + y * y);
            glm::dvec3 colour = r < 1.0 ? heat(value(x, y) / view.peak) : kPage;
            const auto line = [&](double distance, double opacity) {
                const double cover = std::clamp(1.0 - std::abs(distance) / pixel, 0.0, 1.0);
                colour = glm::mix(colour, glm::dvec3(0.75, 0.8, 0.9), opacity * cover);
            };
            for (const double ring : {0.25, 0.5, 0.75})
                line(r - ring, 0.22);
            if (r < 1.0) {
                line(x, 0.16);
                line(y, 0.16);
            }
            line(r - 1.0, 0.8);
            setPixel(image, i, j, colour);
        }
    return dataUri(image);
}

// Catmull-Rom weights of the four neighbours at -1, 0, 1, 2.
std::array<double, 4> catmullRom(double t)
{
    return {t * (-0.5 + t * (1.0 - 0.5 * t)), 1.0 + t * t * (-2.5 + 1.5 * t), t * (0.5 + t * (2.0 - 1.5 * t)),
            t * t * (-0.5 + 0.5 * t)};
}

double interpolate(const std::vector<float>& values, int width, int height, double x, double y)
{
    const int i = int(std::floor(x)), j = int(std::floor(y));
    const auto wx = catmullRom(x - i), wy = catmullRom(y - j);
    double sum = 0.0;
    for (int b = 0; b < 4; ++b)
        for (int a = 0; a < 4; ++a) {
            const int u = std::clamp(i - 1 + a, 0, width - 1), v = std::clamp(j - 1 + b, 0, height - 1);
            sum += wx[size_t(a)] * wy[size_t(b)] * values[size_t(v) * size_t(width) + size_t(u)];
        }
    return sum;
}

} // namespace

View viewOf(const DiscGrid& grid, const Exhibit& exhibit)
{
    const std::vector<float>& g = exhibit.average;
    float peak = 0.0f;
    for (size_t k = 0; k < g.size(); ++k)
        if (grid.area()[k] > 0.0f)
            peak = std::max(peak, g[k]);
    glm::dvec2 low(1.0), high(-1.0);
    const auto include = [&](double x, double y) {
        low = glm::min(low, glm::dvec2(x, y));
        high = glm::max(high, glm::dvec2(x, y));
    };
    for (size_t k = 0; k < g.size(); ++k)
        if (grid.area()[k] > 0.0f && g[k] > 0.01f * peak)
            include(grid.x()[k], grid.y()[k]);
    for (const StoredLobe& lobe : exhibit.texel.lobes) {
        for (const Shape* s : {&lobe.shape, &lobe.second}) {
            if (s == &lobe.second && lobe.secondKs <= 0.0)
                continue;
            const double reach = 2.0 / std::sqrt(double(scalarPower(*s)));
            include(s->nx - reach, s->ny - reach);
            include(s->nx + reach, s->ny + reach);
        }
    }
    View view;
    view.peak = peak > 0.0f ? peak : 1.0;
    view.half = 0.54 * std::max(high.x - low.x, high.y - low.y);
    view.x = 0.5 * (low.x + high.x);
    view.y = 0.5 * (low.y + high.y);
    if (view.half > 0.7)
        view = {0.0, 0.0, 1.04, view.peak};
    return view;
}

std::string averagePicture(const DiscGrid& grid, const std::vector<float>& average, const View& view)
{
    const int side = grid.side();
    return discPicture(view, [&](double x, double y) {
        return std::max(0.0, interpolate(average, side, side, 0.5 * (x + 1.0) * side - 0.5,
                                         0.5 * (y + 1.0) * side - 0.5));
    });
}

std::string lobePicture(const StoredLobe& lobe, const View& view)
{
    const auto ready = [](const Shape& s) {
        return shared::makeLobe(shared::lobeNormal(glm::vec2(s.nx, s.ny)), glm::vec3(s.sxx, s.sxy, s.syy));
    };
    const shared::Lobe first = ready(lobe.shape), second = ready(lobe.second);
    return discPicture(view, [&](double x, double y) {
        const glm::vec3 h(float(x), float(y), float(std::sqrt(std::max(0.0, 1.0 - x * x - y * y))));
        return lobe.ks * double(shared::lobeShape(first, h)) +
               lobe.secondKs * double(shared::lobeShape(second, h));
    });
}

std::string landscapePicture(const Landscape& land)
{
    // Twenty bands from the least error to E = 3, denser near the least: the valley floor is what matters.
    constexpr int kWidth = 480, kHeight = 320, kBands = 20;
    const auto [least, most] = std::minmax_element(land.logError.begin(), land.logError.end());
    const double low = *least, high = std::max(std::min(double(*most), std::log(4.0)), low + 0.05);
    const auto level = [&](double px, double py) {
        const double v = interpolate(land.logError, land.columns, land.rows, px * land.columns / kWidth - 0.5,
                                     py * land.rows / kHeight - 0.5);
        return kBands * std::sqrt(std::clamp((v - low) / (high - low), 0.0, 1.0));
    };
    Image image(kWidth, kHeight, 3);
    for (int j = 0; j < kHeight; ++j)
        for (int i = 0; i < kWidth; ++i) {
            const double here = level(i + 0.5, j + 0.5), right = level(i + 1.5, j + 0.5),
                         below = level(i + 0.5, j + 1.5);
            // Distance to the nearest contour in pixels, by the slope.
            const double slope = std::max(std::hypot(right - here, below - here), 1e-9);
            const double distance = std::abs(here - std::round(here)) / slope;
            const double line = std::clamp(1.2 - distance, 0.0, 1.0) * (std::round(here) > 0.0 ? 0.45 : 0.0);
            const glm::dvec3 colour = ramp(kDepth, (std::floor(here) + 0.5) / kBands);
            setPixel(image, i, j, glm::mix(colour, glm::dvec3(0.02, 0.02, 0.04), line));
        }
    return dataUri(image);
}

double scalePosition(double valueOverPeak)
{
    return std::log1p(kSteepness * std::max(valueOverPeak, 0.0)) / std::log1p(kSteepness);
}

std::string scalePicture()
{
    Image image(360, 1, 3);
    for (int i = 0; i < image.width; ++i) {
        const double t = (i + 0.5) / image.width * scalePosition(kScaleEnd);
        setPixel(image, i, 0, heat(std::expm1(t * std::log1p(kSteepness)) / kSteepness));
    }
    return dataUri(image);
}

} // namespace lumel::baker
