// What the decoder's processes say to each other, over Unix sockets that keep messages apart.
#pragma once
#include "decode.h"
#include "descriptor.h"
#include <optional>

namespace lumel {

// With DecodeRequest goes: the image file, the memory file for the pixels, the socket for the reply.
struct RequestFiles {
    Descriptor image, pixels, reply;
};

// Two for each request: what the file holds, as soon as that is known, then `decoded`. Or one of the others.
struct DecodeReply {
    enum Outcome : uint32_t {
        holds,
        decoded,
        refused,    // text says why
        ended,      // the child ended without a reply; `status` is that of waitpid()
        notStarted, // `status` is errno
    } outcome = refused;
    int32_t status = 0;
    int32_t width = 0, height = 0, channels = 0, levels = 0;
    SampleType type = SampleType::f32;
    uint32_t textSize = 0;
    // Of `holds`: names of channels, then attributes' names and values in turn, each with a 0 at its end.
    char text[8192] = {};
};

std::pair<Descriptor, Descriptor> makeSocketPair();

// False when the other end is gone or the system refuses.
bool sendRequest(int socket, const DecodeRequest& request, const RequestFiles& files);
// Waits. Nothing when the other end is gone.
std::optional<std::pair<DecodeRequest, RequestFiles>> receiveRequest(int socket);
bool sendReply(int socket, const DecodeReply& reply);
std::optional<DecodeReply> receiveReply(int socket);

// Both for `holds`. It may come from a process that was taken over: the second believes nothing, and throws
// Error for what decode() would never say.
DecodeReply replyOf(const DecodedShape& shape);
DecodedShape shapeOf(const DecodeReply& reply);

} // namespace lumel
