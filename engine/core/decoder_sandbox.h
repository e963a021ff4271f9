// What a process that decodes other people's images may do: little.
#pragma once
#include "decode.h"
#include <chrono>

namespace lumel {

// From here on this process can open nothing (no file, no socket, no process), write to no file but those
// that are open, and has the memory, processor time and file size of a file of `fileBytes` whose header is
// being read. `ownBytes` is what the program itself maps.
void enterSandbox(size_t fileBytes, size_t ownBytes);

// Now the header is known: as much as decoding such a picture may take.
void allowFor(const DecodedShape& shape, size_t fileBytes, size_t ownBytes);

// Processor time that an honest file never needs. Two seconds, and 100 ns a sample: twice what the slowest
// formats (PNG of 16-bit noise, PIZ) take on a slow machine; 50 ns a byte of the file for what is skipped.
std::chrono::seconds decodingSeconds(size_t samples, size_t fileBytes);

} // namespace lumel
