// Limits of resources work on every Unix; Linux's filter of system calls (seccomp_filter.txt in its
// documentation) is used where it is known to us.
#include "decoder_sandbox.h"
#include "image.h"
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__)
#define LUMEL_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define LUMEL_ADDRESS_SANITIZER 1
#endif
#endif

namespace lumel {
namespace {

#ifdef LUMEL_ADDRESS_SANITIZER
// Its shadow maps terabytes, everything takes several times as long, and where memory can be read it finds
// out by writing it into a pipe.
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

constexpr size_t kMiB = size_t(1) << 20;
constexpr size_t kMostSamples = 4 * kMaxImagePixels;
constexpr unsigned kMostWallSeconds = 600; // should a decoder sleep rather than work

void limit(int resource, rlim_t soft, rlim_t hard)
{
    rlimit present{};
    if (getrlimit(__rlimit_resource_t(resource), &present) == 0)
        hard = std::min(hard, present.rlim_max);
    const rlimit both{std::min(soft, hard), hard};
    setrlimit(__rlimit_resource_t(resource), &both);
}

// Of all MIP levels.
size_t mostPixelBytes(size_t samples)
{
    return samples * sizeof(float) * 4 / 3 + kMiB;
}

// The pixels themselves, up to three more copies in a decoder's hands, and a GiB for tables and for threads,
// which reserve much more than they use.
size_t memoryFor(size_t samples, size_t fileBytes, size_t ownBytes)
{
    return ownBytes + fileBytes + 4 * mostPixelBytes(samples) + 1024 * kMiB;
}

void limitResources(size_t samples, size_t fileBytes, size_t ownBytes)
{
    // A soft limit can be raised later, up to the hard one.
    limit(RLIMIT_CPU, rlim_t(decodingSeconds(samples, fileBytes).count()),
          rlim_t(decodingSeconds(kMostSamples, fileBytes).count()));
    limit(RLIMIT_FSIZE, samples == 0 ? 0 : mostPixelBytes(samples), mostPixelBytes(kMostSamples));
    if (!kSanitized)
        limit(RLIMIT_AS, memoryFor(samples, fileBytes, ownBytes),
              memoryFor(kMostSamples, fileBytes, ownBytes));
}

#if defined(__x86_64__) || defined(__aarch64__)
#if defined(__x86_64__)
constexpr uint32_t kArchitecture = AUDIT_ARCH_X86_64;
#else
constexpr uint32_t kArchitecture = AUDIT_ARCH_AARCH64;
#endif

// What pthread_create() asks for, and nothing else: OpenEXR decodes with several threads.
constexpr uint32_t kThread = CLONE_VM | CLONE_FS | CLONE_FILES | CLONE_SIGHAND | CLONE_THREAD |
                             CLONE_SYSVSEM | CLONE_SETTLS | CLONE_PARENT_SETTID | CLONE_CHILD_CLEARTID;

// Memory, locks, time, reading and writing what is open, threads, and the end; a stack for the address
// sanitizer's handler of signals.
constexpr std::array kHarmless = {SYS_read,
                                  SYS_write,
                                  SYS_pread64,
                                  SYS_lseek,
                                  SYS_sendto,
                                  SYS_ftruncate,
                                  SYS_munmap,
                                  SYS_mremap,
                                  SYS_madvise,
                                  SYS_brk,
                                  SYS_futex,
                                  SYS_rt_sigreturn,
                                  SYS_getpid,
                                  SYS_gettid,
                                  SYS_getrandom,
                                  SYS_sched_yield,
                                  SYS_clock_gettime,
                                  SYS_gettimeofday,
                                  SYS_exit,
                                  SYS_exit_group,
                                  SYS_close,
                                  SYS_sigaltstack,
                                  SYS_sched_getaffinity,
                                  SYS_set_robust_list,
                                  SYS_rseq};

constexpr uint32_t argument(size_t i) // its low half, on little-endian machines
{
    return uint32_t(offsetof(seccomp_data, args) + i * sizeof(uint64_t));
}

class Filter {
public:
    Filter()
    {
        load(offsetof(seccomp_data, arch));
        add(BPF_JMP | BPF_JEQ | BPF_K, kArchitecture, 1, 0);
        add(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS);
        load(offsetof(seccomp_data, nr));
        for (const long call : kHarmless) {
            add(BPF_JMP | BPF_JEQ | BPF_K, uint32_t(call), 0, 1);
            add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
        }
        for (const long call : {SYS_mmap, SYS_mprotect}) // no code
            allowIf(call, 2, BPF_JSET, PROT_EXEC, false);
        allowIf(SYS_prlimit64, 0, BPF_JEQ, 0, true);               // its own limits
        allowIf(SYS_tgkill, 0, BPF_JEQ, uint32_t(getpid()), true); // abort()
        allowIf(SYS_clone, 0, BPF_JEQ, kThread, true);
        if (kSanitized)
            allowIf(SYS_pipe2, 1, BPF_JEQ, 0, true);
        add(BPF_JMP | BPF_JEQ | BPF_K, SYS_clone3, 0, 1); // its flags are in memory: the C library uses clone
        add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | ENOSYS);
        add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM);
    }

    bool install()
    {
        sock_fprog program{uint16_t(size_), code_.data()};
        return prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program) == 0;
    }

private:
    void add(int code, uint32_t value, uint8_t ifTrue = 0, uint8_t ifFalse = 0)
    {
        code_.at(size_++) = {uint16_t(code), ifTrue, ifFalse, value};
    }
    void load(size_t offset) { add(BPF_LD | BPF_W | BPF_ABS, uint32_t(offset)); }

    // The call with that number, if the test of its argument comes out as it is to.
    void allowIf(long call, size_t which, int test, uint32_t value, bool outcome)
    {
        add(BPF_JMP | BPF_JEQ | BPF_K, uint32_t(call), 0, 5);
        load(argument(which));
        add(BPF_JMP | test | BPF_K, value, outcome ? 0 : 1, outcome ? 1 : 0);
        add(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
        add(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM);
        load(offsetof(seccomp_data, nr));
    }

    std::array<sock_filter, 128> code_;
    size_t size_ = 0;
};

void filterSystemCalls()
{
    Filter().install(); // a kernel without it leaves the limits of resources
}
#else
void filterSystemCalls() {}
#endif

} // namespace

std::chrono::seconds decodingSeconds(size_t samples, size_t fileBytes)
{
    const double seconds = 2.0 + 100e-9 * double(samples) + 50e-9 * double(fileBytes);
    return std::chrono::seconds(int64_t(std::ceil(seconds * (kSanitized ? 4.0 : 1.0))));
}

void enterSandbox(size_t fileBytes, size_t ownBytes)
{
    limitResources(0, fileBytes, ownBytes);
    limit(RLIMIT_CORE, 0, 0);
    if (!kSanitized)
        limit(RLIMIT_NOFILE, 0, 0); // no further descriptor, whatever asks for it
    alarm(kMostWallSeconds);
    prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0); // or the filter would need a privilege
    filterSystemCalls();
}

void allowFor(const DecodedShape& shape, size_t fileBytes, size_t ownBytes)
{
    limitResources(shape.samples(), fileBytes, ownBytes);
}

} // namespace lumel
