// The baked file: a tiled, MIP-mapped OpenEXR with named channels, written whole or not at all and
// checked completely when read, because it also serves as the bake cache.
#include "bake.h"
#include "core/error.h"
#include "core/file.h"
#include <OpenImageIO/imageio.h>
#include <atomic>
#include <bit>
#include <fmt/format.h>
#include <fstream>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace lumel::baker {
namespace {

constexpr const char* kChannelNames[kChannels] = {"N.x",  "N.y",  "S.xx", "S.xy", "S.yy", "Ks.R",
                                                  "Ks.G", "Ks.B", "Kd.R", "Kd.G", "Kd.B", "E"};
constexpr const char* kSecondNames[kSecondChannels] = {"N2.x",  "N2.y",  "S2.xx", "S2.xy",
                                                       "S2.yy", "Ks2.R", "Ks2.G", "Ks2.B"};
constexpr float kMaxHalf = 65504.0f;
constexpr int kTileSize = 64;
// Of a file whose texels are all the same: RLE keeps 3, ZIP 43. More is declared by damaged headers only, and
// would be allocated.
constexpr size_t kMaxTexelsPerByte = 256;
static_assert(LevelSink::kBand % kTileSize == 0);

std::string firstLine(const std::string& text)
{
    return text.substr(0, text.find('\n'));
}

// Rounds to the nearest half float (11 significant bits) and back, as floatsToHalf() does; |v| is at most
// kMaxHalf.
float roundToHalf(float v)
{
    const uint32_t bits = std::bit_cast<uint32_t>(v), sign = bits & 0x80000000u, size = bits ^ sign;
    const uint32_t normal = (size + 0xfffu + ((size >> 13) & 1u)) & ~0x1fffu;
    // Subnormal halves are multiples of 2^-24, as floats from 0.5 to 1 are.
    const uint32_t subnormal = std::bit_cast<uint32_t>((std::bit_cast<float>(size) + 0.5f) - 0.5f);
    return std::bit_cast<float>((size < std::bit_cast<uint32_t>(6.103515625e-5f) ? subnormal : normal) |
                                sign);
}

// One lobe as it is stored: the first five channels and three of Ks.
bool isLobe(const float* t)
{
    bool good = true;
    for (int c = 0; c < kSecondChannels; ++c)
        good = good && std::isfinite(t[c]);
    good = good && t[kNx] * t[kNx] + t[kNy] * t[kNy] <= 1.0f;
    return good && t[kSxx] > 0.0f && t[kSyy] > 0.0f && t[kSxx] * t[kSyy] > t[kSxy] * t[kSxy];
}
static_assert(int(kN2x) == int(kNx) && int(kS2xy) == int(kSxy) && int(kKs2B) == int(kKsB));

OIIO::ImageSpec makeSpec(const ReflectanceMips& mips, int width, int height, bool asFloat, bool secondLobes)
{
    const int channels = kChannels + (secondLobes ? int(kSecondChannels) : 0);
    OIIO::ImageSpec spec(width, height, channels, asFloat ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::HALF);
    spec.channelnames.assign(kChannelNames, kChannelNames + kChannels);
    if (secondLobes)
        spec.channelnames.insert(spec.channelnames.end(), kSecondNames, kSecondNames + kSecondChannels);
    spec.alpha_channel = -1;
    spec.z_channel = -1;
    spec.tile_width = spec.tile_height = kTileSize;
    spec.attribute("compression", "rle");              // zip: 15 % more time, files 25 to 45 % smaller
    spec.attribute("textureformat", "Plain Texture");  // asks OpenImageIO for MIPMAP_LEVELS
    spec.attribute("DateTime", "1970:01:01 00:00:00"); // the same chain is the same file
    spec.attribute("lumel:model", mips.model);
    spec.attribute("lumel:method", mips.method);
    spec.attribute("lumel:lobes", mips.lobes);
    spec.attribute("lumel:version", mips.version);
    spec.attribute("lumel:source", mips.source);
    return spec;
}

// Writes levels as they come.
class ExrSink : public LevelSink {
public:
    ExrSink(const std::filesystem::path& name, const std::filesystem::path& temporary,
            const ReflectanceMips& mips, bool asFloat)
        : name_(name), temporary_(temporary), mips_(mips), asFloat_(asFloat),
          output_(OIIO::ImageOutput::create("openexr"))
    {
        if (!output_)
            fail(OIIO::geterror());
    }

    void begin(bool secondLobes) override { secondLobes_ = secondLobes; }

    void rows(int number, int width, int height, int firstRow, int count, const float* texels,
              const float* second) override
    {
        const auto mode = number == 0 ? OIIO::ImageOutput::Create : OIIO::ImageOutput::AppendMIPLevel;
        if (firstRow == 0 &&
            !output_->open(temporary_.string(), makeSpec(mips_, width, height, asFloat_, secondLobes_), mode))
            fail(output_->geterror());
        for (int row = firstRow; row < firstRow + count; row += kBand) {
            const size_t first = size_t(row - firstRow) * size_t(width);
            writeBand(width, row, std::min(kBand, firstRow + count - row), texels + first * kChannels,
                      second ? second + first * kSecondChannels : nullptr);
        }
    }

    void close()
    {
        if (!output_->close())
            fail(output_->geterror());
    }

private:
    [[noreturn]] void fail(const std::string& why) const
    {
        throw Error(fmt::format("{}: cannot be written ({})", name_.string(), firstLine(why)));
    }

    void writeBand(int width, int firstRow, int count, const float* texels, const float* second)
    {
        const size_t channels = kChannels + (secondLobes_ ? size_t(kSecondChannels) : 0);
        const size_t values = size_t(width) * channels; // of a row
        floats_.resize(asFloat_ ? values * size_t(count) : 0);
        halves_.resize(asFloat_ ? 0 : values * size_t(count));
        tbb::parallel_for(tbb::blocked_range<size_t>(0, size_t(count)), [&](const auto& rows) {
            std::vector<float> own(asFloat_ ? 0 : values);
            for (size_t row = rows.begin(); row < rows.end(); ++row) {
                const size_t first = row * size_t(width);
                float* to = asFloat_ ? &floats_[row * values] : own.data();
                joinRow(texels + first * kChannels, second ? second + first * kSecondChannels : nullptr,
                        size_t(width), to);
                if (!asFloat_)
                    floatsToHalf(own, &halves_[row * values]);
            }
        });
        const void* band = asFloat_ ? static_cast<const void*>(floats_.data()) : halves_.data();
        if (!output_->write_tiles(0, width, firstRow, firstRow + count, 0, 1,
                                  asFloat_ ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::HALF, band))
            fail(output_->geterror());
    }

    // All channels of one texel after the other.
    void joinRow(const float* texels, const float* second, size_t width, float* to) const
    {
        for (size_t x = 0; x < width; ++x, texels += kChannels) {
            std::copy_n(texels, +kChannels, to);
            if (!asFloat_)
                quantise(to);
            to += kChannels;
            if (!secondLobes_)
                continue;
            std::copy_n(second ? second + x * kSecondChannels : kNoSecondLobe, +kSecondChannels, to);
            if (!asFloat_)
                quantiseSecond(to);
            to += kSecondChannels;
        }
    }

    std::filesystem::path name_, temporary_;
    const ReflectanceMips& mips_;
    bool asFloat_, secondLobes_ = false;
    std::unique_ptr<OIIO::ImageOutput> output_;
    std::vector<float> floats_; // of a band, in one of these
    std::vector<uint16_t> halves_;
};

[[noreturn]] void reject(const std::string& name, const std::string& why)
{
    throw Error(fmt::format("{}: {}; bake it again", name, why));
}

void checkTexels(const Level& level, size_t number, const std::string& name)
{
    std::atomic<bool> good = true;
    tbb::parallel_for(0, level.height, [&](int y) {
        bool isGood = true;
        for (int x = 0; x < level.width; ++x) {
            const float* t = level.at(x, y);
            isGood = isGood && isLobe(t) && (level.second.empty() || isLobe(level.secondAt(x, y)));
            for (int c = kSecondChannels; c < kChannels; ++c)
                isGood = isGood && std::isfinite(t[c]);
        }
        if (!isGood)
            good = false;
    });
    if (!good)
        reject(name, fmt::format("level {} holds a texel that is no lobe", number));
}

// Where each of our channels sits in the file, which may order them differently: those of one lobe, and
// those of a second where there are any.
std::vector<size_t> channelIndices(const std::vector<std::string>& names, const std::string& file)
{
    constexpr size_t kBoth = size_t(kChannels) + size_t(kSecondChannels);
    if (names.size() != kChannels && names.size() != kBoth)
        reject(file, fmt::format("{} channels instead of {} or {}: no baked reflectance", names.size(),
                                 +kChannels, kBoth));
    std::vector<size_t> indices;
    for (size_t c = 0; c < names.size(); ++c) {
        const char* name = c < kChannels ? kChannelNames[c] : kSecondNames[c - kChannels];
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
            reject(file, fmt::format("channel {} is missing: no baked reflectance", name));
        indices.push_back(size_t(found - names.begin()));
    }
    return indices;
}

// A level from its picture. Level 0 has no second lobes.
Level levelOf(const Image& image, const std::vector<size_t>& indices, bool isFinest)
{
    const size_t count = size_t(image.width) * size_t(image.height), channels = indices.size();
    Level level{image.width, image.height, std::vector<float>(count * kChannels), {}};
    const bool secondLobes = channels > kChannels && !isFinest;
    level.second.resize(secondLobes ? count * kSecondChannels : 0);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 4096), [&](const auto& range) {
        for (size_t i = range.begin(); i < range.end(); ++i) {
            const float* from = &image.pixels[i * channels];
            for (size_t c = 0; c < kChannels; ++c)
                level.texels[i * kChannels + c] = from[indices[c]];
            for (size_t c = 0; secondLobes && c < kSecondChannels; ++c)
                level.second[i * kSecondChannels + c] = from[indices[kChannels + c]];
        }
    });
    return level;
}

bool isReadable(const std::string& version)
{
    return version == kVersion || version == kOneLobeVersion;
}

std::string attribute(const ImageFile& file, const char* name)
{
    const auto found = file.attributes.find(name);
    return found == file.attributes.end() ? std::string() : found->second;
}

ReflectanceMips metadataOf(const ImageFile& file, const std::string& name)
{
    ReflectanceMips mips;
    mips.model = attribute(file, "lumel:model");
    mips.method = attribute(file, "lumel:method");
    mips.lobes = attribute(file, "lumel:lobes");
    if (mips.lobes.empty()) // older files do not tell which way two came about
        mips.lobes = nameOf(file.channelNames.size() > kChannels ? LobeCount::automatic : LobeCount::one);
    mips.version = attribute(file, "lumel:version");
    mips.source = attribute(file, "lumel:source");
    if (!isReadable(mips.version))
        reject(name, fmt::format("baked by version '{}' instead of '{}'", mips.version, kVersion));
    return mips;
}

} // namespace

namespace {

// Long thin lobes at an angle have det S far below the product of its rounded entries; |S.xy| then gives way.
void quantiseLobe(float* texel)
{
    // A normal near the horizon may round to outside the disc.
    while (texel[kNx] * texel[kNx] + texel[kNy] * texel[kNy] >= 1.0f) {
        texel[kNx] = roundToHalf(texel[kNx] * (1.0f - 1.0f / 1024.0f));
        texel[kNy] = roundToHalf(texel[kNy] * (1.0f - 1.0f / 1024.0f));
    }
    const float product = texel[kSxx] * texel[kSyy];
    while (product - texel[kSxy] * texel[kSxy] < 2e-4f * product) {
        const float step = std::max(std::abs(texel[kSxy]) / 2048.0f, 6e-8f);
        texel[kSxy] = roundToHalf(std::copysign(std::abs(texel[kSxy]) - step, texel[kSxy]));
    }
}

void roundAll(float* values, int count)
{
    for (int c = 0; c < count; ++c)
        values[c] = roundToHalf(std::clamp(values[c], -kMaxHalf, kMaxHalf));
}

} // namespace

void quantise(float* texel)
{
    roundAll(texel, kChannels);
    quantiseLobe(texel);
}

void quantiseSecond(float* texel)
{
    roundAll(texel, kSecondChannels);
    quantiseLobe(texel);
}

void writeExr(const std::filesystem::path& file, const ReflectanceMips& mips, bool asFloat)
{
    if (mips.levels.empty())
        throw Error(fmt::format("{}: nothing baked to write; bake first", file.string()));
    writeAtomically(file, [&](const std::filesystem::path& temporary) {
        ExrSink sink(file, temporary, mips, asFloat);
        sink.begin(std::ranges::any_of(mips.levels, [](const Level& l) { return !l.second.empty(); }));
        for (size_t l = 0; l < mips.levels.size(); ++l) {
            const Level& level = mips.levels[l];
            sink.rows(int(l), level.width, level.height, 0, level.height, level.texels.data(),
                      level.second.empty() ? nullptr : level.second.data());
        }
        sink.close();
    });
}

ReflectanceMips bakeExr(const std::filesystem::path& file, const Maps& maps, const Options& options,
                        bool asFloat, Progress* progress)
{
    const ReflectanceMips mips = metadata(maps, options);
    writeAtomically(file, [&](const std::filesystem::path& temporary) {
        ExrSink sink(file, temporary, mips, asFloat);
        bake(maps, options, sink, progress);
        sink.close();
    });
    return mips;
}

ReflectanceMips readExr(const std::filesystem::path& file)
{
    const std::string name = file.string();
    ImageFile read = readExrLevels(file, kMaxTexelsPerByte);
    const auto indices = channelIndices(read.channelNames, name);
    ReflectanceMips mips = metadataOf(read, name);
    for (Image& image : read.levels) {
        Level level = levelOf(image, indices, mips.levels.empty());
        image = Image();
        checkTexels(level, mips.levels.size(), name);
        mips.levels.push_back(std::move(level));
    }
    return mips;
}

ReflectanceMips readExrMetadata(const std::filesystem::path& file, bool* isFloat)
{
    const ImageFile header = readExrHeader(file);
    channelIndices(header.channelNames, file.string());
    if (isFloat)
        *isFloat = header.isFloat;
    return metadataOf(header, file.string());
}

std::string bakedSource(const std::filesystem::path& file, bool* isFloat)
{
    try {
        return readExrMetadata(file, isFloat).source;
    } catch (const Error&) {
        return "";
    }
}

} // namespace lumel::baker
