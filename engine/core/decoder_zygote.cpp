#include "decoder_zygote.h"
#include "decoder_protocol.h"
#include "decoder_sandbox.h"
#include <OpenImageIO/imageio.h>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <linux/close_range.h>
#include <map>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace lumel {
namespace {

// Whatever happens to the parent happens to this process.
void dieWith(pid_t parent)
{
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) // it was faster
        _exit(0);
}

// Nothing of the terminal, and nothing that a shell may have left open.
void keepOnly(const Descriptor& descriptor)
{
    const int nothing = open("/dev/null", O_RDWR);
    for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
#ifdef __SANITIZE_ADDRESS__ // whose reports go to stderr
        if (standard == STDERR_FILENO)
            continue;
#endif
        dup2(nothing, standard);
    }
    const auto kept = unsigned(descriptor.get());
    if (kept > 3)
        close_range(3, kept - 1, 0);
    close_range(kept + 1, ~0u, 0);
}

// What the program itself maps: libraries and the heap so far.
size_t mappedBytes()
{
    size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    return pages * size_t(sysconf(_SC_PAGESIZE));
}

// What OpenImageIO sets up when it is first used. Its pool of threads is emptied, because a forked process
// has only the thread that forked it.
void warmUp()
{
    OIIO::attribute("threads", 1); // the caller
    while (threadCount() > 1)      // the pool makes one that ends on its own time
        usleep(100);
    // OpenEXR's come when it opens a file.
    OIIO::attribute("exr_threads", int(std::clamp(std::thread::hardware_concurrency(), 1u, 4u)));
    for (const char* format : {"png", "jpeg", "openexr", "hdr", "tiff", "targa"})
        OIIO::ImageInput::create(format);
}

DecodeReply refusal(const char* why)
{
    DecodeReply reply;
    std::strncpy(reply.text, why, sizeof reply.text - 1);
    reply.textSize = uint32_t(std::strlen(reply.text));
    return reply;
}

// What is mapped stays so: this process ends soon, and its parent waits.
struct Mapped {
    Mapping image, pixels;
};

DecodeReply decodeSandboxed(const DecodeRequest& request, const RequestFiles& files, size_t ownBytes,
                            ChildHook hook, Mapped& mapped)
{
    try {
        struct stat status {};
        fstat(files.image.get(), &status);
        mapped.image = Mapping(files.image, size_t(status.st_size), Mapping::read);
        const std::span<const std::byte> bytes = mapped.image.bytes();
        enterSandbox(bytes.size(), ownBytes);
        if (hook)
            hook(bytes);
        const DecodedShape held = decode(bytes, request, [&](const DecodedShape& shape) {
            sendReply(files.reply.get(), replyOf(shape)); // the parent allocates meanwhile
            allowFor(shape, bytes.size(), ownBytes);
            const size_t size = shape.samples() * bytesOf(shape.type);
            if (ftruncate(files.pixels.get(), off_t(size)) != 0)
                throw std::bad_alloc();
            mapped.pixels = Mapping(files.pixels, size, Mapping::write);
            return mapped.pixels.bytes().data();
        });
        if (request.part == ImagePart::header)
            sendReply(files.reply.get(), replyOf(held));
        DecodeReply reply;
        reply.outcome = DecodeReply::decoded;
        return reply;
    } catch (const std::bad_alloc&) {
        return refusal("damaged image (decoding it takes more memory than its size allows); export it again");
    } catch (const std::exception& e) {
        return refusal(e.what());
    }
}

class Zygote {
public:
    Zygote(Descriptor control, ChildHook hook) : control_(std::move(control)), hook_(hook)
    {
        sigset_t children;
        sigemptyset(&children);
        sigaddset(&children, SIGCHLD);
        sigprocmask(SIG_BLOCK, &children, nullptr);
        ended_ = Descriptor(signalfd(-1, &children, SFD_CLOEXEC | SFD_NONBLOCK));
        ownBytes_ = mappedBytes();
    }

    [[noreturn]] void run()
    {
        for (;;) {
            std::array<pollfd, 2> ready{{{control_.get(), POLLIN, 0}, {ended_.get(), POLLIN, 0}}};
            if (poll(ready.data(), ready.size(), -1) < 0 && errno != EINTR)
                _exit(1);
            if (ready[1].revents)
                tellOfEnded();
            if (ready[0].revents)
                serve();
        }
    }

private:
    void serve()
    {
        auto received = receiveRequest(control_.get());
        if (!received)
            _exit(0); // the parent is gone
        auto& [request, files] = *received;
        const pid_t zygote = getpid(), child = fork();
        if (child == 0)
            beChild(zygote, request, std::move(files));
        DecodeReply reply;
        reply.outcome = DecodeReply::notStarted;
        reply.status = errno;
        if (child < 0)
            sendReply(files.reply.get(), reply);
        else
            replies_[child] = std::move(files.reply);
    }

    [[noreturn]] void beChild(pid_t zygote, const DecodeRequest& request, RequestFiles files)
    {
        dieWith(zygote);
        replies_.clear(); // the other children's
        control_.reset();
        ended_.reset();
        Mapped mapped;
        sendReply(files.reply.get(), decodeSandboxed(request, files, ownBytes_, hook_, mapped));
        _exit(0);
    }

    // After the child's own reply, if it sent one; later ones are not read.
    void tellOfEnded()
    {
        signalfd_siginfo ignored;
        while (read(ended_.get(), &ignored, sizeof ignored) > 0) {
        }
        DecodeReply reply;
        reply.outcome = DecodeReply::ended;
        for (pid_t child = 0; (child = waitpid(-1, &reply.status, WNOHANG)) > 0;) {
            sendReply(replies_[child].get(), reply);
            replies_.erase(child);
        }
    }

    Descriptor control_, ended_;
    ChildHook hook_;
    size_t ownBytes_ = 0;
    std::map<pid_t, Descriptor> replies_; // to the parent, of the children that decode
};

} // namespace

void runZygote(Descriptor control, pid_t parent, ChildHook hook)
{
    dieWith(parent);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) // the parent decides
        std::signal(signal, SIG_IGN);
    keepOnly(control);
    warmUp();
    Zygote(std::move(control), hook).run();
}

} // namespace lumel
