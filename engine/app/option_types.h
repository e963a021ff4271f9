// Options of common types: numbers with a range, names of enumerations, files, texts.
#pragma once
#include "option_parser.h"
#include "renderer/setting_text.h"
#include <array>

namespace lumel {

// "a|b|c"
template<size_t count>
std::string alternatives(const std::array<const char*, count>& names)
{
    std::string text;
    for (const char* name : names)
        text += (text.empty() ? "" : "|") + std::string(name);
    return text;
}

template<class Enum, size_t count>
std::optional<Enum> valueNamed(const std::array<const char*, count>& names, const std::string& text)
{
    for (size_t i = 0; i < count; ++i)
        if (text == names[i])
            return Enum(i);
    return std::nullopt;
}

inline std::string notIn(const std::string& values)
{
    return "not in " + values;
}

// An enumeration's value by its name; `names` are in the enumeration's order. Its default is the value now.
template<class Enum, size_t count>
Option addChoice(Command& command, const std::string& name, const std::array<const char*, count>& names,
                 const std::string& help, Enum& value)
{
    const std::string values = alternatives(names);
    return command
        .add(name, values, help,
             [&value, names, values](const std::string& text) {
                 const auto named = valueNamed<Enum>(names, text);
                 value = named.value_or(value);
                 return named ? "" : notIn(values);
             })
        .byDefault(names.at(size_t(value)));
}

// A number from least to most; `store` takes it.
template<class T, class Store>
Command::Read numberReader(double least, double most, const Store& store)
{
    return [=](const std::string& text) -> std::string {
        const auto number = numberFrom<T>(text);
        if (!number || !(*number >= T(least) && *number <= T(most)))
            return notIn(rangeText(least, most));
        store(*number);
        return "";
    };
}

// `unit`: what help shows behind the range.
template<class T>
Option addNumber(Command& command, const std::string& name, double least, double most,
                 const std::string& unit, const std::string& help, T& value)
{
    const std::string range = rangeText(least, most) + (unit.empty() ? "" : " ") + unit;
    return command
        .add(name, range, help, numberReader<T>(least, most, [&value](T number) { value = number; }))
        .byDefault(numberText(value));
}

// One without a default.
template<class T>
Option addNumber(Command& command, const std::string& name, double least, double most,
                 const std::string& unit, const std::string& help, std::optional<T>& value)
{
    const std::string range = rangeText(least, most) + (unit.empty() ? "" : " ") + unit;
    return command.add(name, range, help,
                       numberReader<T>(least, most, [&value](T number) { value = number; }));
}

// A text or a file.
template<class T>
Option addText(Command& command, const std::string& name, const std::string& takes, const std::string& help,
               T& value)
{
    return command.add(name, takes, help, [&value](const std::string& text) {
        value = text;
        return "";
    });
}

} // namespace lumel
