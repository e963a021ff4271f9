#include "file.h"
#include "error.h"
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lumel {
namespace fs = std::filesystem;

std::vector<std::byte> readFile(const fs::path& file, size_t maxBytes)
{
    std::error_code code;
    const auto status = fs::status(file, code);
    if (!fs::exists(status))
        throw Error(fmt::format("{}: no such file; check the path", file.string()));
    if (!fs::is_regular_file(status))
        throw Error(fmt::format("{}: not a regular file; name a file", file.string()));
    const auto size = fs::file_size(file, code);
    if (code || size > maxBytes)
        throw Error(fmt::format("{}: {}", file.string(),
                                code ? code.message()
                                     : fmt::format("{} bytes exceed the limit of {}", size, maxBytes)));
    std::vector<std::byte> bytes(size);
    std::ifstream stream(file, std::ios::binary);
    if (!stream.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size)))
        throw Error(fmt::format("{}: cannot be read; check its permissions", file.string()));
    return bytes;
}

MappedFile::MappedFile(const fs::path& file)
{
    const int opened = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    if (opened < 0 || fstat(opened, &status) != 0 || !S_ISREG(status.st_mode)) {
        if (opened >= 0)
            close(opened);
        throw Error(fmt::format("{}: cannot be read; check its permissions", file.string()));
    }
    const auto size = size_t(status.st_size);
    // At once: page after page would be a fault each.
    void* const at =
        size > 0 ? mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, opened, 0) : nullptr;
    close(opened);
    if (at == MAP_FAILED)
        throw Error(fmt::format("{}: cannot be read ({})", file.string(), std::strerror(errno)));
    bytes_ = {static_cast<const std::byte*>(at), size};
}

MappedFile::~MappedFile()
{
    if (!bytes_.empty())
        munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
}

namespace {
fs::path folderOf(const fs::path& file)
{
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}
} // namespace

void checkWritable(const fs::path& file)
{
    const fs::path folder = folderOf(file);
    if (!fs::is_directory(folder))
        throw Error(
            fmt::format("{}: folder {} does not exist; make it first", file.string(), folder.string()));
    if (access(folder.c_str(), W_OK) != 0)
        throw Error(
            fmt::format("{}: folder {} is not writable; choose another", file.string(), folder.string()));
    if (fs::is_directory(file))
        throw Error(fmt::format("{}: is a folder; name a file", file.string()));
}

namespace {

std::string hostName()
{
    char name[65] = {};
    gethostname(name, sizeof name - 1);
    std::string text = name;
    std::erase_if(text, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
    return text;
}

// No other process writes a file that has not changed for so long.
constexpr auto kForgotten = std::chrono::minutes(10);

// Whether whoever wrote a temporary file is gone: a process of this machine, or one that forgot it.
bool isLeftover(const fs::path& temporary, const std::string& mark)
{
    const size_t dash = mark.find('-');
    const std::string digits = mark.substr(0, dash);
    if (digits.empty() || digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos)
        return false;
    if (dash != std::string::npos && mark.substr(dash + 1) == hostName())
        return kill(pid_t(std::stol(digits)), 0) != 0 && errno == ESRCH;
    std::error_code code;
    const auto written = fs::last_write_time(temporary, code);
    return !code && fs::file_time_type::clock::now() - written > kForgotten;
}

} // namespace

std::string processMark()
{
    static const std::string host = hostName();
    return fmt::format("{}-{}", getpid(), host);
}

void removeLeftovers(const fs::path& file)
{
    const std::string begin = fmt::format(".{}.", file.stem().string()), end = file.extension().string();
    std::error_code code;
    for (const auto& found : fs::directory_iterator(folderOf(file), code)) {
        const std::string name = found.path().filename().string();
        if (!name.starts_with(begin) || !name.ends_with(end) || name.size() <= begin.size() + end.size())
            continue;
        std::error_code ignored;
        if (isLeftover(found.path(), name.substr(begin.size(), name.size() - begin.size() - end.size())))
            fs::remove_all(found.path(), ignored);
    }
}

void writeAtomically(const fs::path& file, const std::function<void(const fs::path&)>& write)
{
    checkWritable(file);
    const fs::path temporary = folderOf(file) / fmt::format(".{}.{}{}", file.stem().string(), processMark(),
                                                            file.extension().string());
    try {
        write(temporary);
        fs::rename(temporary, file);
    } catch (const fs::filesystem_error& e) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        throw Error(fmt::format("{}: cannot be written ({})", file.string(), e.code().message()));
    } catch (...) {
        std::error_code ignored;
        fs::remove(temporary, ignored);
        throw;
    }
}

void writeFileAtomically(const fs::path& file, const std::string& text)
{
    writeAtomically(file, [&](const fs::path& temporary) {
        std::ofstream stream(temporary, std::ios::binary);
        stream << text;
        stream.close();
        if (!stream)
            throw Error(fmt::format("{}: cannot be written ({})", file.string(), std::strerror(errno)));
    });
}

fs::path cacheFolder()
{
    const char* xdg = std::getenv("XDG_CACHE_HOME");
    const char* home = std::getenv("HOME");
    fs::path folder;
    if (xdg && fs::path(xdg).is_absolute()) // the specification ignores relative paths
        folder = fs::path(xdg) / "lumel";
    else if (home && *home)
        folder = fs::path(home) / ".cache" / "lumel";
    else
        folder = fs::temp_directory_path() / "lumel-cache";
    std::error_code code;
    fs::create_directories(folder, code);
    if (code)
        throw Error(fmt::format("{}: the cache folder cannot be made ({}); set XDG_CACHE_HOME",
                                folder.string(), code.message()));
    return folder;
}

void markUsed(const fs::path& file)
{
    const timespec times[2] = {{.tv_sec = 0, .tv_nsec = UTIME_NOW}, {.tv_sec = 0, .tv_nsec = UTIME_OMIT}};
    utimensat(AT_FDCWD, file.c_str(), times, 0); // where it fails, the file is deleted sooner: no harm
}

void deleteUnused(const fs::path& folder, uintmax_t mostBytes)
{
    struct Used {
        fs::path file;
        time_t when;
        uintmax_t bytes;
    };
    std::vector<Used> files;
    uintmax_t bytes = 0;
    std::error_code code;
    for (const auto& entry : fs::directory_iterator(folder, code)) {
        struct stat status {};
        if (stat(entry.path().c_str(), &status) != 0 || !S_ISREG(status.st_mode))
            continue;
        files.push_back(
            {entry.path(), std::max(status.st_atime, status.st_mtime), uintmax_t(status.st_size)});
        bytes += files.back().bytes;
    }
    std::ranges::sort(files, {}, &Used::when);
    for (const Used& used : files) {
        if (bytes <= mostBytes)
            return;
        if (fs::remove(used.file, code))
            bytes -= used.bytes;
    }
}

// Fowler, Noll and Vo's FNV-1a (64 bit), eight bytes a step where there are eight; the second lane runs
// over the complemented words, so that a collision must hit both.
ContentHash& ContentHash::add(const void* data, size_t size)
{
    constexpr uint64_t kPrime = 0x100000001b3ull;
    const auto* bytes = static_cast<const unsigned char*>(data);
    const auto step = [&](uint64_t word) {
        a_ = (a_ ^ word) * kPrime;
        a_ ^= a_ >> 29; // words, not bytes: without this, high bits would never reach low ones
        b_ = (b_ ^ ~word) * 0x9e3779b97f4a7c15ull;
        b_ ^= b_ >> 32;
    };
    for (; size >= 8; size -= 8, bytes += 8) {
        uint64_t word;
        std::memcpy(&word, bytes, 8);
        step(word);
    }
    for (; size > 0; --size)
        step(*bytes++);
    return *this;
}

std::string ContentHash::hex() const
{
    return fmt::format("{:016x}{:016x}", a_, b_);
}

} // namespace lumel
