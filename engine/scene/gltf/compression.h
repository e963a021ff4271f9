// Compressed geometry becomes plain buffer views and accessors before anything else reads the file, so that
// nothing else has to know of it.
#pragma once
#include "document.h"
#include <functional>
#include <nlohmann/json.hpp>
#include <span>

namespace lumel::scene {

class CompressedDocument {
public:
    // `count` is told of all bytes before they are allocated and throws beyond the limit.
    CompressedDocument(nlohmann::json& root, Document& document, std::function<void(size_t)> count)
        : root_(root), document_(document), count_(std::move(count))
    {
    }

    // EXT_meshopt_compression: replaces the buffer views that carry it. Throws Error.
    void expandMeshopt();
    // KHR_draco_mesh_compression: replaces the accessors of the primitives that carry it. Throws Error.
    void expandDraco();

private:
    [[noreturn]] void fail(const std::string& why) const;
    // Member `key` of an extension, below 2^32. Throws Error when absent.
    size_t number(const nlohmann::json& extension, const char* key, const std::string& where) const;
    std::span<const std::byte> range(size_t buffer, size_t offset, size_t length,
                                     const std::string& where) const;
    std::vector<std::byte> allocate(size_t bytes) const;
    size_t addBuffer(std::vector<std::byte> bytes);
    size_t addAccessor(nlohmann::json accessor, std::vector<std::byte> bytes);
    void expandView(nlohmann::json& view, const nlohmann::json& extension, const std::string& where);
    void expandPrimitive(nlohmann::json& primitive, const nlohmann::json& extension,
                         const std::string& where);
    std::span<const std::byte> viewBytes(size_t view, const std::string& where) const;

    nlohmann::json& root_;
    Document& document_;
    std::function<void(size_t)> count_;
};

} // namespace lumel::scene
