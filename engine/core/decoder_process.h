// Image files are other people's data, and the libraries that decode them crash on some that are damaged, or
// worse. So they are decoded in processes that can open nothing, one an image, and that may die:
//
//   lumel --DecodeRequest, image file, memory file, socket--> zygote --fork--> child: sandbox, decode()
//   lumel <-----------------DecodeReply, over that socket, pixels in the memory file------'
//
// The zygote is forked from main() before the program has threads, and dies with it.
#pragma once
#include "decode.h"
#include "descriptor.h"
#include <sys/types.h>

namespace lumel {

// For tests: called in each child, in its sandbox, with the file's bytes, before they are decoded.
using ChildHook = void (*)(std::span<const std::byte>);

class DecoderProcess {
public:
    // Throws std::logic_error when the program has threads already: what one locks would stay locked for
    // ever.
    explicit DecoderProcess(ChildHook hook = nullptr);
    ~DecoderProcess();
    DecoderProcess(const DecoderProcess&) = delete;
    static pid_t id(); // of the zygote
};

// For fuzzers, which look for crashes: in place of a DecoderProcess, images are decoded right here.
void decodeInThisProcess();

// Decodes an open file by the one DecoderProcess that there is. `allocate` is called as soon as it is known
// what the file holds, while the other process decodes. Returns the pixels; none of ImagePart::header. Any
// number of threads may wait for different images. Throws Error without the file's name, and Interrupted
// after Ctrl-C.
Mapping decodeElsewhere(Descriptor image, const DecodeRequest& request,
                        const std::function<void(const DecodedShape&)>& allocate);

// A file in memory that holds the bytes.
Descriptor memoryFile(std::span<const std::byte> bytes);

} // namespace lumel
