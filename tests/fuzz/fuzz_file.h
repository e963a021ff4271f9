// The fuzzers' inputs as files, which the loaders require.
#pragma once
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

namespace lumel {

// One file in memory for the life of the process, in a folder of its own.
class FuzzFile {
public:
    explicit FuzzFile(const std::string& extension)
    {
        std::string pattern = "/dev/shm/lumel-fuzz-XXXXXX";
        folder_ = mkdtemp(pattern.data());
        file_ = folder_ / ("input" + extension);
    }
    ~FuzzFile() { std::filesystem::remove_all(folder_); }
    FuzzFile(const FuzzFile&) = delete;

    const std::filesystem::path& write(const uint8_t* data, size_t size) const
    {
        std::ofstream(file_, std::ios::binary)
            .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
        return file_;
    }

private:
    std::filesystem::path folder_, file_;
};

} // namespace lumel
