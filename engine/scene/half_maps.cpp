#include "half_maps.h"
#include "material_maps.h"
#include "shared/moments.h"
#include <bit>
#include <glm/gtc/type_ptr.hpp>
#include <tbb/parallel_for.h>

namespace lumel::scene {
namespace {

using enum baker::Channel;
using Channels = std::array<baker::Channel, 4>;

constexpr float kMaxHalf = 65504.0f;
constexpr Channels kNormal = {kNx, kNy, kSxx, kSyy}, kSpecular = {kKsR, kKsG, kKsB, kSxy},
                   kDiffuse = {kKdR, kKdG, kKdB, kError};

size_t levelsOf(glm::ivec2 size)
{
    return size_t(std::bit_width(uint32_t(std::max(size.x, size.y))));
}

// Four channels of every level, one level after the other.
std::vector<uint16_t> pack(const baker::ReflectanceMips& mips, const Channels& channels)
{
    size_t count = 0;
    for (const baker::Level& level : mips.levels)
        count += 4 * size_t(level.width) * size_t(level.height);
    std::vector<uint16_t> halves(count);
    uint16_t* to = halves.data();
    for (const baker::Level& level : mips.levels) {
        const size_t width = size_t(level.width);
        tbb::parallel_for(0, level.height, [&](int y) {
            std::vector<float> row(4 * width);
            const float* texel = level.at(0, y);
            for (size_t x = 0; x < width; ++x, texel += baker::kChannels)
                for (size_t c = 0; c < 4; ++c)
                    row[4 * x + c] = texel[channels[c]];
            floatsToHalf(row, to + 4 * width * size_t(y));
        });
        to += 4 * width * size_t(level.height);
    }
    return halves;
}

HalfChain chainOf(const baker::ReflectanceMips& mips, const Channels& channels)
{
    const auto halves = std::make_shared<const std::vector<uint16_t>>(pack(mips, channels));
    const baker::Level& finest = mips.levels.front();
    return {{finest.width, finest.height}, halves->data(), halves};
}

float secondStrength(const float* t)
{
    return shared::luminanceOf({t[baker::kKs2R], t[baker::kKs2G], t[baker::kKs2B]});
}

glm::vec4 packSecond(const float* t)
{
    const float k = secondStrength(t), s = k * shared::kSecondCovarianceScale;
    return {k * t[baker::kN2x], k * t[baker::kN2y], s * t[baker::kS2xx], s * t[baker::kS2yy]};
}

glm::vec4 packSecondSpecular(const float* t)
{
    const float s = secondStrength(t) * shared::kSecondCovarianceScale;
    return {t[baker::kKs2R], t[baker::kKs2G], t[baker::kKs2B], s * t[baker::kS2xy]};
}

// One of the two maps of second lobes, from level 1 on.
HalfChain secondChain(const baker::ReflectanceMips& mips, glm::vec4 (*pack)(const float* texel))
{
    std::vector<Image> levels;
    for (size_t l = 1; l < mips.levels.size(); ++l) {
        const baker::Level& level = mips.levels[l];
        Image& image = levels.emplace_back(level.width, level.height, 4);
        tbb::parallel_for(0, level.height, [&](int y) {
            for (int x = 0; x < level.width; ++x) {
                const glm::vec4 packed = pack(level.secondAt(x, y));
                std::copy_n(&packed.x, 4, image.at(x, y));
            }
        });
    }
    return HalfChain(levels);
}

bool hasSecondLobes(const baker::ReflectanceMips& mips)
{
    for (const baker::Level& level : mips.levels)
        for (size_t i = 0; i < level.second.size(); i += baker::kSecondChannels)
            if (secondStrength(level.second.data() + i) > 0.0f)
                return true;
    return false;
}

} // namespace

void HalfChain::setSize(glm::ivec2 size, size_t levels)
{
    size_ = size;
    offsets_ = {0};
    for (size_t level = 0; level < levels; ++level) {
        const glm::ivec2 extent = this->size(level);
        offsets_.push_back(offsets_.back() + 4 * size_t(extent.x) * size_t(extent.y));
    }
}

HalfChain::HalfChain(glm::ivec2 size, size_t levels,
                     const std::function<void(size_t level, int y, float* rgba)>& fill)
{
    setSize(size, levels);
    const auto halves = std::make_shared<std::vector<uint16_t>>(offsets_.back());
    for (size_t level = 0; level < levels; ++level) {
        const glm::ivec2 extent = this->size(level);
        tbb::parallel_for(0, extent.y, [&](int y) {
            std::vector<float> rgba(4 * size_t(extent.x));
            fill(level, y, rgba.data());
            floatsToHalf(rgba, halves->data() + offsets_[level] + rgba.size() * size_t(y));
        });
    }
    texels_ = halves->data();
    owner_ = halves;
}

HalfChain::HalfChain(const std::vector<Image>& levels)
    : HalfChain({levels.front().width, levels.front().height}, levels.size(),
                [&](size_t level, int y, float* rgba) {
                    const Image& image = levels[level];
                    const auto channels = size_t(image.channels), width = size_t(image.width);
                    const float* from = image.at(0, y);
                    for (size_t x = 0; x < width; ++x)
                        for (size_t c = 0; c < 4; ++c)
                            rgba[4 * x + c] =
                                c < channels ? std::clamp(from[x * channels + c], -kMaxHalf, kMaxHalf) : 1.0f;
                })
{
}

HalfChain::HalfChain(glm::ivec2 size, const uint16_t* texels, std::shared_ptr<const void> owner)
    : texels_(texels), owner_(std::move(owner))
{
    setSize(size, levelsOf(size));
}

size_t HalfChain::byteCount(glm::ivec2 size)
{
    HalfChain chain;
    chain.setSize(size, levelsOf(size));
    return chain.byteCount();
}

glm::vec4 HalfChain::at(size_t level, int x, int y) const
{
    glm::vec4 texel;
    halfToFloats(texels(level).subspan(4 * (size_t(y) * size_t(size(level).x) + size_t(x)), 4), &texel.x);
    return texel;
}

Reflectance::Reflectance(baker::ReflectanceMips mips)
{
    for (baker::Level& level : mips.levels)
        tbb::parallel_for(0, level.height, [&](int y) {
            float* texel = level.texels.data() + size_t(y) * size_t(level.width) * baker::kChannels;
            for (int x = 0; x < level.width; ++x, texel += baker::kChannels)
                baker::quantise(texel);
            if (level.second.empty())
                return;
            float* second = level.second.data() + size_t(y) * size_t(level.width) * baker::kSecondChannels;
            for (int x = 0; x < level.width; ++x, second += baker::kSecondChannels)
                baker::quantiseSecond(second);
        });
    normal = chainOf(mips, kNormal);
    specular = chainOf(mips, kSpecular);
    diffuse = chainOf(mips, kDiffuse);
    base = HalfChain(baseReflectance(mips));
    if (hasSecondLobes(mips)) {
        second = secondChain(mips, packSecond);
        secondSpecular = secondChain(mips, packSecondSpecular);
    }
}

std::array<float, baker::kChannels> Reflectance::at(size_t level, int x, int y) const
{
    std::array<float, baker::kChannels> texel{};
    const auto take = [&](const HalfChain& chain, const Channels& channels) {
        const glm::vec4 four = chain.at(level, x, y);
        for (size_t c = 0; c < 4; ++c)
            texel[channels[c]] = four[int(c)];
    };
    take(normal, kNormal);
    take(specular, kSpecular);
    take(diffuse, kDiffuse);
    return texel;
}

std::array<float, baker::kSecondChannels> Reflectance::secondAt(size_t level, int x, int y) const
{
    auto texel = std::to_array(baker::kNoSecondLobe);
    if (level == 0 || !hasSecond())
        return texel;
    const glm::vec4 lobe = second.at(level - 1, x, y), specular = secondSpecular.at(level - 1, x, y);
    const float k = shared::luminanceOf(glm::vec3(specular)), s = k * shared::kSecondCovarianceScale;
    if (k > 0.0f)
        texel = {lobe.x / k, lobe.y / k, lobe.z / s, specular.w / s,
                 lobe.w / s, specular.x, specular.y, specular.z};
    return texel;
}

FirstLobeMaps firstLobeMaps(const Reflectance& reflectance)
{
    if (!reflectance.hasSecond())
        return {reflectance.normal, reflectance.specular};
    const HalfChain &normals = reflectance.normal, &speculars = reflectance.specular;
    const auto premultiplied = [&](glm::vec4 (*texelOf)(glm::vec4 normal, glm::vec4 specular, float weight)) {
        return HalfChain(normals.size(), normals.levels(), [&](size_t level, int y, float* rgba) {
            const size_t values = 4 * size_t(normals.size(level).x), first = values * size_t(y);
            std::vector<float> specular(values);
            halfToFloats(normals.texels(level).subspan(first, values), rgba);
            halfToFloats(speculars.texels(level).subspan(first, values), specular.data());
            for (size_t i = 0; i < values; i += 4) {
                const glm::vec4 s = glm::make_vec4(&specular[i]);
                const float k = shared::luminanceOf(glm::vec3(s)) + shared::kLeastWeight;
                const glm::vec4 texel = texelOf(glm::make_vec4(rgba + i), s, k);
                std::copy_n(&texel.x, 4, rgba + i);
            }
        });
    };
    constexpr float kScale = shared::kSecondCovarianceScale;
    return {premultiplied([](glm::vec4 n, glm::vec4, float k) {
                return glm::vec4(k * n.x, k * n.y, k * kScale * n.z, k * kScale * n.w);
            }),
            premultiplied(
                [](glm::vec4, glm::vec4 s, float k) { return glm::vec4(s.x, s.y, s.z, k * kScale * s.w); })};
}

} // namespace lumel::scene
