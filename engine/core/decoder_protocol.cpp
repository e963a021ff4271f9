#include "decoder_protocol.h"
#include "error.h"
#include "image.h"
#include <array>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/uio.h>

namespace lumel {
namespace {

constexpr size_t kFiles = 3; // of a request
constexpr size_t kControlBytes = CMSG_SPACE(kFiles * sizeof(int));

template<class Call>
ssize_t restarted(const Call& call)
{
    ssize_t result = 0;
    do
        result = call();
    while (result < 0 && errno == EINTR);
    return result;
}

void append(DecodeReply& reply, const std::string& text)
{
    if (text.size() + 1 > sizeof reply.text - reply.textSize)
        throw Error("names of channels and attributes of more than 8 KiB; export it again");
    std::memcpy(reply.text + reply.textSize, text.c_str(), text.size() + 1);
    reply.textSize += uint32_t(text.size() + 1);
}

// A request with space for the descriptors that go along. It points into itself.
struct Envelope {
    explicit Envelope(DecodeRequest* request) : data{request, sizeof *request}
    {
        message.msg_iov = &data;
        message.msg_iovlen = 1;
        message.msg_control = control;
        message.msg_controllen = sizeof control;
    }
    Envelope(const Envelope&) = delete;

    iovec data;
    alignas(cmsghdr) char control[kControlBytes] = {};
    msghdr message{};
};

} // namespace

std::pair<Descriptor, Descriptor> makeSocketPair()
{
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
        throw Error(
            fmt::format("no socket for the image decoder ({}); close other programs", std::strerror(errno)));
    return {Descriptor(ends[0]), Descriptor(ends[1])};
}

bool sendRequest(int socket, const DecodeRequest& request, const RequestFiles& files)
{
    Envelope envelope(const_cast<DecodeRequest*>(&request)); // sendmsg() only reads it
    cmsghdr* header = CMSG_FIRSTHDR(&envelope.message);
    header->cmsg_level = SOL_SOCKET;
    header->cmsg_type = SCM_RIGHTS;
    header->cmsg_len = CMSG_LEN(kFiles * sizeof(int));
    const std::array<int, kFiles> numbers = {files.image.get(), files.pixels.get(), files.reply.get()};
    std::memcpy(CMSG_DATA(header), numbers.data(), sizeof numbers);
    return restarted([&] { return sendmsg(socket, &envelope.message, MSG_NOSIGNAL); }) ==
           ssize_t(sizeof request);
}

std::optional<std::pair<DecodeRequest, RequestFiles>> receiveRequest(int socket)
{
    std::pair<DecodeRequest, RequestFiles> received;
    Envelope envelope(&received.first);
    if (restarted([&] { return recvmsg(socket, &envelope.message, MSG_CMSG_CLOEXEC); }) !=
        ssize_t(sizeof(DecodeRequest)))
        return std::nullopt;
    const cmsghdr* header = CMSG_FIRSTHDR(&envelope.message);
    if (!header || header->cmsg_type != SCM_RIGHTS || header->cmsg_len != CMSG_LEN(kFiles * sizeof(int)))
        return std::nullopt;
    std::array<int, kFiles> numbers;
    std::memcpy(numbers.data(), CMSG_DATA(header), sizeof numbers);
    received.second = {Descriptor(numbers[0]), Descriptor(numbers[1]), Descriptor(numbers[2])};
    return received;
}

bool sendReply(int socket, const DecodeReply& reply)
{
    return restarted([&] { return send(socket, &reply, sizeof reply, MSG_NOSIGNAL); }) ==
           ssize_t(sizeof reply);
}

std::optional<DecodeReply> receiveReply(int socket)
{
    DecodeReply reply;
    if (restarted([&] { return recv(socket, &reply, sizeof reply, 0); }) != ssize_t(sizeof reply))
        return std::nullopt;
    return reply;
}

DecodeReply replyOf(const DecodedShape& shape)
{
    DecodeReply reply;
    reply.outcome = DecodeReply::holds;
    reply.width = shape.width;
    reply.height = shape.height;
    reply.channels = shape.channels;
    reply.levels = shape.levels;
    reply.type = shape.type;
    for (const std::string& name : shape.channelNames)
        append(reply, name.c_str());
    for (const auto& [name, value] : shape.attributes) {
        append(reply, name.c_str()); // up to a 0 inside
        append(reply, value.c_str());
    }
    return reply;
}

DecodedShape shapeOf(const DecodeReply& reply)
{
    constexpr int kMostChannels = 64, kMostLevels = 32;
    if (reply.width < 1 || reply.height < 1 || reply.channels < 1 || reply.channels > kMostChannels ||
        reply.levels < 1 || reply.levels > kMostLevels || reply.type > SampleType::f32 ||
        reply.textSize > sizeof reply.text)
        throw Error("damaged image (invalid reply from the decoder); export it again");
    DecodedShape shape{reply.width, reply.height, reply.channels, reply.levels, reply.type, {}, {}};
    checkImageSize(size_t(shape.width), size_t(shape.height), size_t(shape.channels), kMaxImagePixels);
    std::vector<std::string> texts;
    for (size_t at = 0; at < reply.textSize; at += texts.back().size() + 1)
        texts.emplace_back(reply.text + at, strnlen(reply.text + at, reply.textSize - at));
    const size_t names = std::min(texts.size(), size_t(shape.channels));
    shape.channelNames.assign(texts.begin(), texts.begin() + std::ptrdiff_t(names));
    for (size_t i = names; i + 1 < texts.size(); i += 2)
        shape.attributes[texts[i]] = texts[i + 1];
    return shape;
}

} // namespace lumel
