// Hooks in the test programs' decoders: files that begin with these words make them misbehave.
#pragma once
#include "core/error.h"
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lumel::test {

// What became of each way out, by name: "open: Operation not permitted, ...".
inline std::string tryToEscape()
{
    std::string report;
    const auto tried = [&](const char* what, long result) {
        report += std::string(what) + ": " + (result < 0 ? strerrorname_np(errno) : "done") + ", ";
    };
    tried("open", open("/dev/null", O_RDONLY));
    tried("create", open("/tmp/lumel-escaped", O_CREAT | O_WRONLY, 0600));
    tried("socket", socket(AF_INET, SOCK_STREAM, 0));
    tried("fork", fork());
    tried("unlink", unlink("/tmp/lumel-escaped"));
    tried("kill", kill(getppid(), 0));
    tried("execute", execl("/bin/true", "true", nullptr));
    tried("code", mmap(nullptr, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) == MAP_FAILED
                      ? -1
                      : 0);
    rlimit files{};
    getrlimit(RLIMIT_NOFILE, &files);
    return report + "descriptors: " + std::to_string(files.rlim_max);
}

inline void decoderHook(std::span<const std::byte> bytes)
{
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("TEST escape"))
        throw Error(tryToEscape());
    if (text.starts_with("TEST killed"))
        raise(SIGKILL);
    if (text.starts_with("TEST crash"))
        raise(SIGSEGV);
    if (text.starts_with("TEST leave"))
        _exit(0);
    if (text.starts_with("TEST lines"))
        throw Error("one\ntwo\x1b[31m");
    if (text.starts_with("TEST work"))
        for (std::atomic<unsigned> count = 0;;) // without an effect, a loop may be taken to end
            ++count;
    if (text.starts_with("TEST eat"))
        for (;;)
            std::memset(::operator new(size_t(1) << 26), 1, size_t(1) << 26);
}

} // namespace lumel::test
