#include "light_text.h"
#include "core/error.h"
#include <charconv>
#include <fmt/format.h>

namespace lumel::scene {
namespace {

constexpr const char* kForms = "write sun,DX,DY,DZ,R,G,B,LUX or point,X,Y,Z,R,G,B,CANDELA[,RANGE] or "
                               "spot,X,Y,Z,R,G,B,CANDELA,RANGE,DX,DY,DZ,INNER,OUTER";

std::vector<float> parseNumbers(std::string_view text)
{
    std::vector<float> numbers;
    while (!text.empty()) {
        const size_t comma = std::min(text.find(','), text.size());
        float number = 0.0f;
        const auto parsed = std::from_chars(text.data(), text.data() + comma, number);
        const bool endsInComma = comma + 1 == text.size();
        if (endsInComma || parsed.ec != std::errc() || parsed.ptr != text.data() + comma ||
            !std::isfinite(number))
            return {};
        numbers.push_back(number);
        text.remove_prefix(std::min(comma + 1, text.size()));
    }
    return numbers;
}

// Degrees that are this angle again when read: a float's nearest neighbours are tried too.
float degreesOf(float radians)
{
    const float nearest = glm::degrees(radians);
    for (const float degrees : {nearest, std::nextafter(nearest, 0.0f), std::nextafter(nearest, 1e9f)})
        if (glm::radians(degrees) == radians)
            return degrees;
    return nearest;
}

} // namespace

Light parseLight(const std::string& text)
{
    const size_t comma = std::min(text.find(','), text.size());
    const std::string type = text.substr(0, comma);
    const std::vector<float> n =
        parseNumbers(std::string_view(text).substr(std::min(comma + 1, text.size())));
    Light light;
    light.name = type;
    const bool sun = type == "sun" && n.size() == 7, spot = type == "spot" && n.size() == 13;
    const bool point = type == "point" && (n.size() == 7 || n.size() == 8);
    if (!sun && !point && !spot)
        throw Error(fmt::format("{}: not a light; {}", text, kForms));
    const glm::vec3 first(n[0], n[1], n[2]);
    light.colour = {n[3], n[4], n[5]};
    light.intensity = n[6];
    light.type = sun ? LightType::directional : point ? LightType::point : LightType::spot;
    if (glm::any(glm::lessThan(light.colour, glm::vec3(0.0f))) || light.intensity < 0.0f)
        throw Error(text + ": colour and intensity of a light are 0 or more");
    if (!sun)
        light.position = first;
    if (n.size() > 7)
        light.range = std::max(n[7], 0.0f);
    if (point)
        return light;
    light.direction = sun ? first : glm::vec3(n[8], n[9], n[10]);
    const float length = glm::length(light.direction);
    if (!(length > 1e-6f))
        throw Error(text + ": the light's direction is 0,0,0");
    // What is of unit length stays as it is, so that texts of a light give it again.
    if (std::abs(length - 1.0f) > 1e-6f)
        light.direction /= length;
    if (spot) {
        if (n[11] < 0.0f || n[12] <= n[11] || n[12] > 90.0f)
            throw Error(text + ": the cone's half angles are 0 <= INNER < OUTER <= 90 degrees");
        light.innerCone = glm::radians(n[11]);
        light.outerCone = glm::radians(n[12]);
    }
    return light;
}

std::string lightText(const Light& light)
{
    const auto point = [](glm::vec3 p) { return fmt::format("{},{},{}", p.x, p.y, p.z); };
    const std::string rest = fmt::format("{},{}", point(light.colour), light.intensity);
    switch (light.type) {
    case LightType::directional:
        return fmt::format("sun,{},{}", point(light.direction), rest);
    case LightType::point:
        return fmt::format("point,{},{},{}", point(light.position), rest, light.range);
    case LightType::spot:
        break;
    }
    return fmt::format("spot,{},{},{},{},{},{}", point(light.position), rest, light.range,
                       point(light.direction), degreesOf(light.innerCone), degreesOf(light.outerCone));
}

} // namespace lumel::scene
