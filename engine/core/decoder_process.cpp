#include "decoder_process.h"
#include "decoder_protocol.h"
#include "decoder_zygote.h"
#include "error.h"
#include "progress.h"
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace lumel {
namespace {

constexpr const char* kHasEnded = "the image decoder's process has ended; start lumel again";
constexpr const char* kNonsense = "damaged image (invalid reply from the decoder); export it again";
Descriptor control; // to the zygote
pid_t zygote = -1;
std::atomic<bool> direct = false;

// Libraries may start threads when they are loaded, which is before this: Debian's OpenImageIO brings
// log4cplus, whose four wait for work that nobody gives them, and hold nothing that a forked process needs.
const size_t threadsOfLibraries = threadCount();

// One line of printable characters: some of it is written by whoever made the file.
std::string lineOf(const DecodeReply& reply)
{
    std::string line(reply.text, strnlen(reply.text, std::min<size_t>(reply.textSize, 400)));
    for (char& c : line)
        if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f)
            c = '?';
    return line;
}

[[noreturn]] void failAsTold(const DecodeReply& reply)
{
    if (reply.outcome == DecodeReply::notStarted)
        throw Error(fmt::format("no process can be started to decode it ({}); close other programs",
                                std::strerror(reply.status)));
    if (reply.outcome == DecodeReply::refused)
        throw Error(lineOf(reply));
    if (reply.outcome != DecodeReply::ended)
        throw Error(kNonsense);
    const int signal = WIFSIGNALED(reply.status) ? WTERMSIG(reply.status) : 0;
    if (signal == SIGXCPU || signal == SIGALRM)
        throw Error("damaged image (decoding it takes longer than its size allows); export it again");
    throw Error(fmt::format("damaged image (its decoder ended: {}); export it again",
                            signal ? strsignal(signal) : "no reply"));
}

DecodeReply waitForReply(const Descriptor& socket)
{
    constexpr int kMilliseconds = 50; // between looks for Ctrl-C
    for (;;) {
        pollfd ready{socket.get(), POLLIN, 0};
        const int count = poll(&ready, 1, kMilliseconds);
        if (count > 0)
            break;
        checkInterrupted();
    }
    if (const auto reply = receiveReply(socket.get()))
        return *reply;
    throw Error(kHasEnded);
}

// Sealed first: nobody can make it shorter while it is read.
Mapping pixelsOf(const Descriptor& file, const DecodedShape& shape)
{
    const size_t size = shape.samples() * bytesOf(shape.type);
    struct stat status {};
    if (fcntl(file.get(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0 ||
        fstat(file.get(), &status) != 0 || size_t(status.st_size) != size)
        throw Error(kNonsense);
    return Mapping(file, size, Mapping::read);
}

Descriptor emptyMemoryFile()
{
    Descriptor file(memfd_create("lumel image", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    if (file.get() < 0)
        throw Error(
            fmt::format("no memory file for the pixels ({}); close other programs", std::strerror(errno)));
    return file;
}

Mapping decodeHere(const Descriptor& image, const DecodeRequest& request,
                   const std::function<void(const DecodedShape&)>& allocate)
{
    struct stat status {};
    fstat(image.get(), &status);
    const Mapping bytes(image, size_t(status.st_size), Mapping::read);
    Mapping pixels;
    const DecodedShape held = decode(bytes.bytes(), request, [&](const DecodedShape& shape) {
        allocate(shape);
        const Descriptor file = emptyMemoryFile();
        const size_t size = shape.samples() * bytesOf(shape.type);
        if (ftruncate(file.get(), off_t(size)) != 0)
            throw std::bad_alloc();
        pixels = Mapping(file, size, Mapping::write);
        return pixels.bytes().data();
    });
    if (request.part == ImagePart::header)
        allocate(held);
    return pixels;
}

} // namespace

DecoderProcess::DecoderProcess(ChildHook hook)
{
    if (control.get() >= 0 || threadCount() > threadsOfLibraries)
        throw std::logic_error("the image decoder is started once, in main(), before any thread");
    auto [ours, theirs] = makeSocketPair();
    const pid_t parent = getpid();
    zygote = fork();
    if (zygote == 0)
        runZygote(std::move(theirs), parent, hook);
    if (zygote < 0)
        throw Error(fmt::format("the image decoder's process cannot be started ({}); close other programs",
                                std::strerror(errno)));
    control = std::move(ours);
}

DecoderProcess::~DecoderProcess()
{
    control.reset();
    kill(zygote, SIGKILL); // it holds nothing; its children die with it
    waitpid(zygote, nullptr, 0);
}

pid_t DecoderProcess::id()
{
    return zygote;
}

void decodeInThisProcess()
{
    direct = true;
}

Mapping decodeElsewhere(Descriptor image, const DecodeRequest& request,
                        const std::function<void(const DecodedShape&)>& allocate)
{
    if (direct)
        return decodeHere(image, request, allocate);
    if (control.get() < 0)
        throw std::logic_error("images are decoded by a DecoderProcess, which main() starts");
    auto [ours, theirs] = makeSocketPair();
    RequestFiles files{std::move(image), emptyMemoryFile(), std::move(theirs)};
    if (!sendRequest(control.get(), request, files))
        throw Error(kHasEnded);
    files.reply.reset(); // the child's and the zygote's now: when both are gone, waiting ends
    const DecodeReply first = waitForReply(ours);
    if (first.outcome != DecodeReply::holds)
        failAsTold(first);
    const DecodedShape shape = shapeOf(first);
    allocate(shape);
    const DecodeReply last = waitForReply(ours);
    if (last.outcome != DecodeReply::decoded)
        failAsTold(last);
    return request.part == ImagePart::header ? Mapping() : pixelsOf(files.pixels, shape);
}

Descriptor memoryFile(std::span<const std::byte> bytes)
{
    Descriptor file = emptyMemoryFile();
    for (size_t done = 0; done < bytes.size();) {
        const ssize_t count = write(file.get(), bytes.data() + done, bytes.size() - done);
        if (count < 0 && errno != EINTR)
            throw std::bad_alloc();
        done += size_t(std::max<ssize_t>(count, 0));
    }
    return file;
}

} // namespace lumel
