// A strict reader of KTX 2.0 for the formats that the export writes: whatever the specification demands and a
// lenient reader would let pass is an error. Returns what is wrong first, or nothing.
#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lumel::baker::test {

struct Ktx2 {
    uint32_t format = 0, width = 0, height = 0, scheme = 0;
    uint32_t model = 0, transfer = 0;
    std::vector<uint32_t> channels; // with their qualifiers
    std::map<std::string, std::string> values;
    std::vector<std::vector<std::byte>> levels; // finest first, decompressed
};

std::string readKtx2(const std::vector<std::byte>& bytes, Ktx2& result);

} // namespace lumel::baker::test
