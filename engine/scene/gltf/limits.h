// Limits of the glTF loader, each with what it bounds. Real models stay far below them.
#pragma once
#include <cstddef>

namespace lumel::scene {

inline constexpr size_t kMaxNesting = 128; // recursion of tinygltf on extras, 1 KiB of stack a level
inline constexpr size_t kMaxJsonValues = 20'000'000;         // some 100 bytes of memory each
inline constexpr size_t kMaxJsonBytes = size_t(1) << 31;     // tinygltf counts with 32 bits
inline constexpr size_t kMaxTotalBytes = size_t(4) << 30;    // all buffers, unpacked too, and images together
inline constexpr size_t kMaxVertices = size_t(1) << 24;      // of one mesh; 48 bytes each: 768 MiB
inline constexpr size_t kMaxIndices = 6 * kMaxVertices;      // of one mesh: 384 MiB
inline constexpr size_t kMaxSceneVertices = size_t(1) << 26; // of all meshes: 3 GiB
inline constexpr size_t kMaxReadElements = size_t(1) << 29;  // used or not: bounds the time, some 10 s
inline constexpr size_t kMaxObjects = size_t(1) << 20;       // nodes times primitives, before any is made
inline constexpr size_t kMaxMorphElements = size_t(1) << 25; // targets times vertices, 40 bytes each: 1.3 GiB
inline constexpr size_t kMaxMorphWeights = size_t(1) << 22;  // of all nodes
inline constexpr size_t kMaxJoints = size_t(1) << 20;        // of all skins that are used
inline constexpr size_t kMaxDeformedVertices = size_t(1) << 24; // a copy for each pose: 1 GiB
inline constexpr int kMaxNodeDepth = 256;                       // deeper trees are damage, not design

} // namespace lumel::scene
