#include "staged_files.h"
#include "core/error.h"
#include "core/file.h"
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>

namespace lumel::baker {
namespace fs = std::filesystem;

StagedFiles::StagedFiles(fs::path folder) : folder_(std::move(folder))
{
    if (!fs::exists(folder_)) {
        std::error_code code;
        madeFolder_ = fs::create_directory(folder_, code);
        if (code)
            throw Error(fmt::format("{}: the folder cannot be made ({}); choose another", folder_.string(),
                                    code.message()));
    }
    if (!fs::is_directory(folder_))
        throw Error(fmt::format("{}: is a file; name a folder", folder_.string()));
    removeLeftovers(folder_ / "lumel"); // of exports that were killed
    temporary_ = folder_ / fmt::format(".lumel.{}", processMark());
    std::error_code code;
    fs::create_directory(temporary_, code);
    if (code)
        throw Error(fmt::format("{}: the folder is not writable ({}); choose another", folder_.string(),
                                code.message()));
}

StagedFiles::~StagedFiles()
{
    std::error_code ignored;
    fs::remove_all(temporary_, ignored);
    if (madeFolder_)
        fs::remove(folder_, ignored); // which leaves one that holds anything
}

fs::path StagedFiles::path(const std::string& name)
{
    names_.push_back(name);
    const fs::path file = temporary_ / name;
    std::error_code ignored; // what cannot be made cannot be written, which is said then
    fs::create_directories(file.parent_path(), ignored);
    return file;
}

void StagedFiles::write(const std::string& name, std::span<const std::byte> bytes)
{
    std::ofstream stream(path(name), std::ios::binary);
    stream.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    stream.close();
    if (!stream)
        throw Error(
            fmt::format("{}: cannot be written ({})", (folder_ / name).string(), std::strerror(errno)));
}

void StagedFiles::write(const std::string& name, const std::string& text)
{
    write(name, std::as_bytes(std::span(text)));
}

void StagedFiles::publish()
{
    for (const std::string& name : names_)
        if (fs::is_directory(folder_ / name))
            throw Error(fmt::format("{}: is a folder; remove it", (folder_ / name).string()));
    for (const std::string& name : names_) {
        std::error_code code;
        fs::create_directories((folder_ / name).parent_path(), code);
        fs::rename(temporary_ / name, folder_ / name, code);
        if (code)
            throw Error(fmt::format("{}: cannot be written ({})", (folder_ / name).string(), code.message()));
    }
}

} // namespace lumel::baker
