// Recycled lit textures: who draws which texture. CPU bookkeeping only; passes/lit_pool.h owns the images.
// Objects own nothing. A texture belongs to a size class (powers of two); within a class the least recently
// used one is taken over first, and the sum of all bytes never passes the cap.
#pragma once
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

namespace lumel::tsl {

struct PoolTexture {
    glm::uvec2 size{0};
    int owner = -1;        // object, -1 = free
    uint32_t litLevel = 0; // the owner's level of MIP 0
    uint64_t lastUsed = 0; // frame
    bool alive = false;    // has memory
};

// Bytes of an RGBA16F texture with its full MIP chain.
size_t poolTextureBytes(glm::uvec2 size);

class TexturePool {
public:
    explicit TexturePool(size_t capBytes) : capBytes_(capBytes) {}

    // A texture of `size` for the object in this frame: its own when it has one of that size, else a free
    // one, else a new one within the cap, else the least recently used of an earlier frame (of the same
    // class, or of others, whose memory is then given up). nullopt when everything left is in use this frame.
    std::optional<int> acquire(int object, glm::uvec2 size, uint64_t frame);

    const std::vector<PoolTexture>& textures() const { return textures_; }
    size_t usedBytes() const { return usedBytes_; }
    size_t capBytes() const { return capBytes_; }

private:
    int claim(int texture, int object, uint64_t frame);
    std::optional<int> findOwn(int object, glm::uvec2 size) const;
    std::optional<int> findRecyclable(glm::uvec2 size, uint64_t frame) const;
    bool makeRoom(size_t bytes, uint64_t frame);
    int addTexture(glm::uvec2 size);

    size_t capBytes_;
    size_t usedBytes_ = 0;
    std::vector<PoolTexture> textures_; // slots; dead ones are reused
};

} // namespace lumel::tsl
