#include "uri.h"
#include "core/error.h"
#include "document.h"
#include <fmt/format.h>

namespace lumel::scene {
namespace {

int hexDigit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    if (c >= 'A' && c <= 'F')
        return c - 'A' + 10;
    return -1;
}

// RFC 3986, section 2.1. '+' stays '+': only HTML forms read it as a blank.
std::string percentDecode(const std::string& text)
{
    std::string decoded;
    for (size_t i = 0; i < text.size(); ++i) {
        const int high = text[i] == '%' && i + 2 < text.size() ? hexDigit(text[i + 1]) : -1;
        const int low = high >= 0 ? hexDigit(text[i + 2]) : -1;
        if (low < 0) {
            decoded += text[i];
            continue;
        }
        decoded += char(high * 16 + low);
        i += 2;
    }
    return decoded;
}

int base64Digit(char c)
{
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    if (c == '+' || c == '-') // '-' and '_': the URL alphabet of RFC 4648, section 5
        return 62;
    if (c == '/' || c == '_')
        return 63;
    return -1;
}

// Long names would bury the message.
std::string shortened(const std::string& uri)
{
    return uri.size() <= 80 ? uri : fmt::format("{:.77}...", uri);
}

bool climbs(const std::filesystem::path& path)
{
    for (const auto& part : path)
        if (part == "..")
            return true;
    return false;
}

} // namespace

bool isDataUri(const std::string& uri)
{
    return uri.rfind("data:", 0) == 0;
}

std::vector<std::byte> decodeDataUri(const std::string& model, const std::string& uri)
{
    const size_t comma = uri.find(',');
    if (comma == std::string::npos)
        throw Error(fmt::format("{}: a data: URI has no data; export the model again", model));
    const bool base64 = uri.substr(0, comma).find(";base64") != std::string::npos;
    std::vector<std::byte> bytes;
    if (!base64) {
        for (char c : percentDecode(uri.substr(comma + 1)))
            bytes.push_back(std::byte(c));
        return bytes;
    }
    bytes.reserve((uri.size() - comma) / 4 * 3);
    uint32_t bits = 0;
    int count = 0;
    for (size_t i = comma + 1; i < uri.size() && uri[i] != '='; ++i) {
        const int digit = base64Digit(uri[i]);
        if (digit < 0)
            throw Error(fmt::format("{}: a data: URI is not base64; export the model again", model));
        bits = bits << 6 | uint32_t(digit);
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes.push_back(std::byte(bits >> count & 0xff));
        }
    }
    return bytes;
}

std::filesystem::path resolveUri(const std::string& model, const std::filesystem::path& folder,
                                 const std::string& uri)
{
    namespace fs = std::filesystem;
    std::string name = percentDecode(uri);
    const std::string shown = printable(shortened(name));
    const auto refuse = [&](const char* why) {
        throw Error(
            fmt::format("{}: refers to '{}', {}; copy the file into the model's folder", model, shown, why));
    };
    for (char& c : name) // Windows exporters write backslashes, which RFC 3986 does not know
        if (c == '\\')
            c = '/';
    if (name.empty() || name.find('\0') != std::string::npos)
        refuse("which names no file");
    if (name.front() == '/')
        refuse("an absolute path");
    const size_t colon = name.find(':');
    if (colon != std::string::npos && colon < name.find('/'))
        refuse("which is not a relative path");
    if (climbs(name))
        refuse("which leaves the model's folder");
    std::error_code code;
    const fs::path base = fs::canonical(folder.empty() ? "." : folder, code);
    const fs::path target = fs::weakly_canonical(base / name, code);
    if (code || climbs(target.lexically_relative(base)))
        refuse("a link out of the model's folder");
    return folder / name;
}

} // namespace lumel::scene
