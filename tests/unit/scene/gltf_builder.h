// Builds small glTF files in memory, right or wrong on purpose, for the loader's tests.
#pragma once
#include "core/error.h"
#include "core/image.h"
#include "gltf/gltf.h"
#include "scene/scene.h"
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>
#include <unistd.h>

namespace lumel::scene {

// What the loader tells its user would bury failures.
inline const bool kQuiet = (spdlog::set_level(spdlog::level::off), true);

// A folder of its own for each test, gone afterwards.
class TemporaryFolder {
public:
    TemporaryFolder()
    {
        std::string pattern = (std::filesystem::temp_directory_path() / "lumel-test-XXXXXX").string();
        path_ = mkdtemp(pattern.data());
    }
    ~TemporaryFolder()
    {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

private:
    std::filesystem::path path_;
};

inline void writeText(const std::filesystem::path& file, const std::string& text)
{
    std::ofstream(file, std::ios::binary) << text;
}

inline std::string readText(const std::filesystem::path& file)
{
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline std::string base64(const std::string& bytes)
{
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        uint32_t bits = 0;
        for (size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
        for (size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return text;
}

struct GltfBuilder {
    nlohmann::json root = {{"asset", {{"version", "2.0"}}},
                           {"scene", 0},
                           {"scenes", {{{"nodes", {0}}}}},
                           {"nodes", {{{"mesh", 0}}}},
                           {"meshes", {{{"primitives", {nlohmann::json::object()}}}}}};
    std::string binary;

    nlohmann::json& primitive(size_t i = 0) { return root["meshes"][0]["primitives"][i]; }
    nlohmann::json& node(size_t i = 0) { return root["nodes"][i]; }
    nlohmann::json& material(size_t i = 0) { return root["materials"][i]; }

    size_t view(const void* data, size_t size, size_t stride = 0)
    {
        nlohmann::json entry = {{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", size}};
        if (stride)
            entry["byteStride"] = stride;
        binary.append(static_cast<const char*>(data), size);
        binary.resize((binary.size() + 3) / 4 * 4);
        root["bufferViews"].push_back(entry);
        return root["bufferViews"].size() - 1;
    }

    template<class T>
    size_t accessor(const std::vector<T>& values, const char* type, int componentType, size_t components)
    {
        const size_t index = view(values.data(), values.size() * sizeof(T));
        root["accessors"].push_back({{"bufferView", index},
                                     {"componentType", componentType},
                                     {"type", type},
                                     {"count", values.size() / components}});
        return root["accessors"].size() - 1;
    }
    size_t floats(const std::vector<float>& values, const char* type, size_t components)
    {
        return accessor(values, type, 5126, components);
    }

    // A unit square in the xy plane facing +z, upright image: uv (0, 0) at the upper left.
    GltfBuilder& quad(bool withNormals = true, bool withUvs = true)
    {
        auto& p = primitive();
        p["attributes"]["POSITION"] = floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3", 3);
        if (withNormals)
            p["attributes"]["NORMAL"] = floats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
        if (withUvs)
            p["attributes"]["TEXCOORD_0"] = floats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2", 2);
        p["indices"] = accessor<uint16_t>({0, 1, 2, 0, 2, 3}, "SCALAR", 5123, 1);
        return *this;
    }

    // With the binary data in a file beside it.
    std::filesystem::path writeGltf(const TemporaryFolder& folder, const std::string& name = "model.gltf")
    {
        nlohmann::json model = withBuffer();
        if (!model["buffers"][0].contains("uri"))
            model["buffers"][0]["uri"] = "data.bin";
        writeText(folder / "data.bin", binary);
        writeText(folder / name, model.dump());
        return folder / name;
    }

    std::string glb() const
    {
        std::string json = withBuffer().dump();
        json.resize((json.size() + 3) / 4 * 4, ' ');
        std::string out = "glTF";
        word(out, 2);
        word(out, uint32_t(12 + 8 + json.size() + 8 + binary.size()));
        word(out, uint32_t(json.size()));
        out += "JSON" + json;
        word(out, uint32_t(binary.size()));
        out += std::string("BIN\0", 4) + binary;
        return out;
    }
    std::filesystem::path writeGlb(const TemporaryFolder& folder, const std::string& name = "model.glb")
    {
        writeText(folder / name, glb());
        return folder / name;
    }

    static void word(std::string& out, uint32_t value)
    {
        out.append(reinterpret_cast<const char*>(&value), 4);
    }

private:
    // Unless the test says what the buffers are.
    nlohmann::json withBuffer() const
    {
        nlohmann::json model = root;
        if (!model.contains("buffers"))
            model["buffers"] = {{{"byteLength", binary.size()}}};
        return model;
    }
};

// The message of the Error that `action` throws, checked to be one line; empty when it throws none.
template<class Action>
std::string errorOf(const Action& action)
{
    try {
        action();
    } catch (const Error& e) {
        EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
        return e.what();
    }
    return "";
}

inline bool contains(const std::string& text, const std::string& part)
{
    return text.find(part) != std::string::npos;
}

// Names the file first, has `part` in it, and ends with a remedy after "; ".
inline void expectRefused(const std::filesystem::path& file, const std::string& part)
{
    const std::string message = errorOf([&] { loadGltf(file); });
    EXPECT_EQ(message.rfind(file.string(), 0), 0u) << "message: '" << message << "'";
    EXPECT_TRUE(contains(message, part)) << "message: '" << message << "'";
    EXPECT_TRUE(contains(message, "; ")) << "message: '" << message << "'";
}

} // namespace lumel::scene
