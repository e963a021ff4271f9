// Settings as text: what their options take, and what commands and statistics write.
#pragma once
#include "setting_table.h"
#include <charconv>
#include <fmt/format.h>
#include <string>

namespace lumel {

template<class T>
std::optional<T> numberFrom(const std::string& text)
{
    T number{};
    const char* const end = text.data() + text.size();
    const auto [rest, error] = std::from_chars(text.data(), end, number);
    return error == std::errc() && rest == end ? std::optional(number) : std::nullopt;
}

// Shortest decimal that is read as the same number.
template<class T>
std::string numberText(T number)
{
    return fmt::format("{}", number);
}

// "960x540"; nothing when it is not of that form or out of range.
inline std::optional<glm::uvec2> sizeFrom(const std::string& text, double least, double most)
{
    const size_t x = text.find('x');
    if (x == std::string::npos)
        return std::nullopt;
    const auto width = numberFrom<uint32_t>(text.substr(0, x));
    const auto height = numberFrom<uint32_t>(text.substr(x + 1));
    const auto fits = [&](const auto& side) { return side && *side >= least && *side <= most; };
    return fits(width) && fits(height) ? std::optional(glm::uvec2(*width, *height)) : std::nullopt;
}

// "0..1"; beyond 1e30 either way there is no limit.
inline std::string rangeText(double least, double most)
{
    if (most < 1e30)
        return fmt::format("{:.10g}..{:.10g}", least, most);
    return least > 0.0 ? "NUMBER>0" : "NUMBER";
}

namespace detail {
template<class T>
struct NumberOf {
    using type = T;
};
template<class T>
struct NumberOf<std::optional<T>> {
    using type = T;
};
template<class T>
inline constexpr bool kNamed = std::is_enum_v<T> || std::is_same_v<T, bool>;
} // namespace detail

// "tsl|forward|reference", "0..1|auto", "1..65536 MiB": what the option takes.
template<class T>
std::string takes(const Setting<T>& setting)
{
    std::string text;
    if constexpr (std::is_same_v<T, glm::uvec2>)
        return "WIDTHxHEIGHT";
    for (const char* value : setting.values)
        text += (text.empty() ? "" : "|") + std::string(value);
    if (!text.empty())
        return text;
    text = rangeText(setting.least, setting.most);
    if (*setting.unit)
        text += std::string(" ") + setting.unit;
    return setting.word ? text + "|" + setting.word : text;
}

template<class T>
std::string textOf(const Setting<T>& setting, const Settings& settings)
{
    const T& value = settings.*setting.member;
    if (setting.word && value == setting.wordValue)
        return setting.word;
    if constexpr (std::is_same_v<T, glm::uvec2>)
        return fmt::format("{}x{}", value.x, value.y);
    else if constexpr (detail::kNamed<T>)
        return setting.values[size_t(value)];
    else if constexpr (std::is_same_v<T, std::optional<float>>)
        return value ? numberText(*value) : "";
    else
        return numberText(value / T(setting.memberPerUnit));
}

// Nothing when the text is not what the option takes.
template<class T>
std::optional<T> valueFrom(const Setting<T>& setting, const std::string& text)
{
    if (setting.word && text == setting.word)
        return setting.wordValue;
    size_t index = 0;
    while (index < setting.values.size() && text != setting.values[index])
        ++index;
    if (!setting.values.empty() && index == setting.values.size())
        return std::nullopt;
    if constexpr (std::is_same_v<T, glm::uvec2>) {
        return sizeFrom(text, setting.least, setting.most);
    } else if constexpr (detail::kNamed<T>) {
        return T(index);
    } else {
        using Number = typename detail::NumberOf<T>::type;
        const auto number = numberFrom<Number>(text);
        if (!number)
            return std::nullopt;
        const bool inRange = *number >= Number(setting.least) && *number <= Number(setting.most);
        if (setting.values.empty() && !inRange)
            return std::nullopt;
        return T(*number * Number(setting.memberPerUnit));
    }
}

} // namespace lumel
