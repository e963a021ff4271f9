// Baked maps as the GPU reads them: MIP chains of RGBA half floats.
#pragma once
#include "baker/bake.h"
#include "core/image.h"
#include <functional>
#include <memory>

namespace lumel::scene {

// Never changes once it is made, so that copies share its texels.
class HalfChain {
public:
    HalfChain() = default;
    // Of one to four channels; missing ones are 1, infinite values as large as half floats get.
    explicit HalfChain(const std::vector<Image>& levels);
    // Of rows of finite RGBA values that `fill` gives.
    HalfChain(glm::ivec2 size, size_t levels,
              const std::function<void(size_t level, int y, float* rgba)>& fill);
    // All levels down to 1 x 1, in texels that `owner` keeps, as bytes() gives them.
    HalfChain(glm::ivec2 size, const uint16_t* texels, std::shared_ptr<const void> owner);

    glm::ivec2 size() const { return size_; }
    size_t levels() const { return offsets_.size() - 1; }
    glm::ivec2 size(size_t level) const { return glm::max(size_ >> int(level), glm::ivec2(1)); }
    std::span<const uint16_t> texels(size_t level) const
    {
        return {texels_ + offsets_[level], offsets_[level + 1] - offsets_[level]};
    }
    glm::vec4 at(size_t level, int x, int y) const;
    // Of all levels, the finest first.
    std::span<const std::byte> bytes() const
    {
        return {reinterpret_cast<const std::byte*>(texels_), byteCount()};
    }
    size_t byteCount() const { return offsets_.back() * sizeof(uint16_t); }
    // Of a chain of this size.
    static size_t byteCount(glm::ivec2 size);

private:
    void setSize(glm::ivec2 size, size_t levels);

    glm::ivec2 size_{0};
    std::vector<size_t> offsets_{0}; // of each level, and the end; in half floats
    const uint16_t* texels_ = nullptr;
    std::shared_ptr<const void> owner_;
};

// What the baker gives, rounded as in a baked file.
struct Reflectance {
    HalfChain normal;   // N.x, N.y, S.xx, S.yy
    HalfChain specular; // Ks, S.xy
    HalfChain diffuse;  // Kd, E
    HalfChain base;     // of baseReflectance()
    // Second lobes, premultiplied by their strength K so that what has none does not count where texels are
    // filtered (material.glsl). They begin with level 1; empty in a chain without any.
    HalfChain second;         // K N2.x, K N2.y, k K S2.xx, k K S2.yy; k is kSecondCovarianceScale
    HalfChain secondSpecular; // Ks2, k K S2.xy

    Reflectance() = default;
    Reflectance(baker::ReflectanceMips mips); // NOLINT: the same in another form

    glm::ivec2 size() const { return normal.size(); }
    size_t levels() const { return normal.levels(); }
    bool hasSecond() const { return second.size().x > 0; }
    // By baker::Channel.
    std::array<float, baker::kChannels> at(size_t level, int x, int y) const;
    // By baker::SecondChannel; kNoSecondLobe where there is none.
    std::array<float, baker::kSecondChannels> secondAt(size_t level, int x, int y) const;
};

// The maps of first lobes as shaders read them: beside second ones they are premultiplied too, by their
// strength and kLeastWeight. (Files keep them as they are: level 0 has no second lobes to share with.)
struct FirstLobeMaps {
    HalfChain normal, specular;
};
FirstLobeMaps firstLobeMaps(const Reflectance& reflectance);

} // namespace lumel::scene
