// Files that appear whole or not at all, the cache folder, and content hashes.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace lumel {

// Reads a whole file. Throws Error naming it when missing, unreadable, a folder, or over `maxBytes`.
std::vector<std::byte> readFile(const std::filesystem::path& file, size_t maxBytes = size_t(4) << 30);

// A file's bytes in memory, read as they are touched. Throws Error like readFile().
class MappedFile {
public:
    explicit MappedFile(const std::filesystem::path& file);
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;
    std::span<const std::byte> bytes() const { return bytes_; }

private:
    std::span<const std::byte> bytes_;
};

// Throws Error unless a file could be written there: commands call it before long work.
void checkWritable(const std::filesystem::path& file);

// "4711-HOST": in names of temporary files, so that processes and machines that share a folder do not meet.
std::string processMark();

// Removes what writeAtomically() left of `file` when its process was killed: on this machine at once, of
// others after ten minutes. Files that a living process writes stay.
void removeLeftovers(const std::filesystem::path& file);

// Calls `write` with a fresh temporary name beside `file` (same extension), then renames it over `file`.
// When `write` throws, the temporary is removed and `file` is untouched. Throws Error if the folder is
// missing or not writable.
void writeAtomically(const std::filesystem::path& file,
                     const std::function<void(const std::filesystem::path&)>& write);
void writeFileAtomically(const std::filesystem::path& file, const std::string& text);

// $XDG_CACHE_HOME/lumel, else ~/.cache/lumel (XDG Base Directory specification); made if missing.
std::filesystem::path cacheFolder();
// Marks a file of the cache as used now, which only deleteUnused() notices.
void markUsed(const std::filesystem::path& file);
// Deletes the files of a folder that were used least recently until the rest has at most so many bytes.
void deleteUnused(const std::filesystem::path& folder, uintmax_t mostBytes);

// Streaming 128-bit content hash (two FNV-1a lanes with different offsets). Not cryptographic: it keys
// the bake cache, where inputs are the user's own files.
class ContentHash {
public:
    ContentHash& add(const void* data, size_t size);
    ContentHash& add(const std::string& text) { return add(text.data(), text.size()).addValue(text.size()); }
    template<class T>
    ContentHash& addValue(const T& value)
    {
        static_assert(std::is_trivially_copyable_v<T>);
        return add(&value, sizeof value);
    }
    std::string hex() const; // 32 digits

private:
    uint64_t a_ = 0xcbf29ce484222325ull;
    uint64_t b_ = 0x84222325cbf29ce4ull;
};

} // namespace lumel
