#include "texture_pool.h"
#include <algorithm>

namespace lumel::tsl {

size_t poolTextureBytes(glm::uvec2 size)
{
    size_t texels = 0;
    for (;;) {
        texels += size_t(size.x) * size.y;
        if (size.x == 1 && size.y == 1)
            return texels * 8; // four half floats
        size = glm::max(size / 2u, glm::uvec2(1));
    }
}

std::optional<int> TexturePool::findOwn(int object, glm::uvec2 size) const
{
    for (size_t i = 0; i < textures_.size(); ++i)
        if (textures_[i].alive && textures_[i].owner == object && textures_[i].size == size)
            return int(i);
    return std::nullopt;
}

std::optional<int> TexturePool::findRecyclable(glm::uvec2 size, uint64_t frame) const
{
    std::optional<int> best;
    for (size_t i = 0; i < textures_.size(); ++i) {
        const PoolTexture& t = textures_[i];
        if (!t.alive || t.size != size || (t.owner >= 0 && t.lastUsed == frame))
            continue;
        if (t.owner < 0)
            return int(i);
        if (!best || t.lastUsed < textures_[size_t(*best)].lastUsed)
            best = int(i);
    }
    return best;
}

// Gives up least recently used textures of any class until `bytes` fit below the cap.
bool TexturePool::makeRoom(size_t bytes, uint64_t frame)
{
    while (usedBytes_ + bytes > capBytes_) {
        PoolTexture* oldest = nullptr;
        for (PoolTexture& t : textures_)
            if (t.alive && (t.owner < 0 || t.lastUsed < frame) && (!oldest || t.lastUsed < oldest->lastUsed))
                oldest = &t;
        if (!oldest)
            return false;
        usedBytes_ -= poolTextureBytes(oldest->size);
        *oldest = {};
    }
    return true;
}

int TexturePool::addTexture(glm::uvec2 size)
{
    usedBytes_ += poolTextureBytes(size);
    const auto dead =
        std::find_if(textures_.begin(), textures_.end(), [](const auto& t) { return !t.alive; });
    const int index = int(dead - textures_.begin());
    if (dead == textures_.end())
        textures_.emplace_back();
    textures_[size_t(index)] = {.size = size, .alive = true};
    return index;
}

int TexturePool::claim(int texture, int object, uint64_t frame)
{
    PoolTexture& t = textures_[size_t(texture)];
    t.owner = object;
    t.lastUsed = frame;
    return texture;
}

std::optional<int> TexturePool::acquire(int object, glm::uvec2 size, uint64_t frame)
{
    if (const auto own = findOwn(object, size))
        return claim(*own, object, frame);
    // New memory before taking over: an object out of sight for a moment then keeps its lumels.
    const size_t bytes = poolTextureBytes(size);
    if (usedBytes_ + bytes <= capBytes_) {
        for (size_t i = 0; i < textures_.size(); ++i)
            if (textures_[i].alive && textures_[i].owner < 0 && textures_[i].size == size)
                return claim(int(i), object, frame);
        return claim(addTexture(size), object, frame);
    }
    if (const auto old = findRecyclable(size, frame))
        return claim(*old, object, frame);
    if (makeRoom(bytes, frame))
        return claim(addTexture(size), object, frame);
    return std::nullopt;
}

} // namespace lumel::tsl
