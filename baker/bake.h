// The baker's one call: height, normal and gloss maps in, fitted reflectance MIP chain out.
// Each coarser texel holds the lobe (shaders/shared/lobe.h) that best reproduces the average
// reflectance of the level-0 texels under it (Baker, "MIP-Mapping Reflectance Models").
#pragma once
#include "core/image.h"
#include "core/progress.h"
#include <array>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace lumel::baker {

inline constexpr const char* kVersion = "6"; // of baked files: raise when what they hold means something else
// With it part of the cache key: raise when results change.
inline constexpr const char* kResults = "3";
// Files of this version hold one lobe a texel and are still read.
inline constexpr const char* kOneLobeVersion = "5";

// fitPower is the talk's cheap mode: N stays the average, P and Ks are fitted.
enum class Method { fit, average, flat, height, toksvig, lean, fitPower };
inline bool isFitted(Method method)
{
    return method == Method::fit || method == Method::fitPower;
}

enum class Model { blinnPhong, ashikhminShirley };
enum class Wrap { repeat, clamp };
// What a texel represents: the box it covers, or its bilinear footprint (tent.h).
enum class Reconstruction { box, bilinear };

// Lobes of a texel above level 0. Automatic: a second one where it lowers E by a quarter and by 0.005.
enum class LobeCount { one, two, automatic };

// As options and baked files name them.
const char* nameOf(Method method);
const char* nameOf(Model model);
const char* nameOf(LobeCount lobes);

// One texel of a baked level; the order of the file's channels.
enum Channel { kNx, kNy, kSxx, kSxy, kSyy, kKsR, kKsG, kKsB, kKdR, kKdG, kKdB, kError, kChannels };
// Its second lobe, F = F1 + F2. Kd then is along the lobes' mean normal: x and y of both, weighted by the
// luminance of Ks and Ks2.
enum SecondChannel { kN2x, kN2y, kS2xx, kS2xy, kS2yy, kKs2R, kKs2G, kKs2B, kSecondChannels };
inline constexpr float kNoSecondLobe[kSecondChannels] = {0, 0, 1, 0, 1, 0, 0, 0}; // reflects nothing

// Maps may differ in size; the chain has the size of the largest one, the others are resampled
// bilinearly. Empty images mean "use the constant". Images are linear; heights and normals as decoded
// from the file (normals in [0, 1], or signed when `signedNormals`).
struct Maps {
    Image height;             // channel 0: height; needs heightScale
    float heightScale = 0.0f; // height of value 1 in units of the map's width
    Image normal;             // rgb tangent-space normal
    bool normalGreenUp = true;
    bool signedNormals = false;
    float normalScale = 1.0f; // glTF normalTexture.scale: multiplies x and y before normalising
    Wrap wrap = Wrap::repeat; // for height derivatives and resampling across the border

    Image power; // channel 0: Blinn-Phong power, as stored
    float powerConstant = 200.0f;
    Image roughness;                  // channel 0: glTF perceptual roughness (energy.h); wins over power
    Image anisotropy;                 // channel 0: glTF anisotropy strength in [0, 1]; needs a roughness map
    Image tangentRotation;            // channel 0: [0, 1] = rotation of the anisotropy axes by [0, pi)
    glm::vec2 anisotropicPower{0.0f}; // base power along Tu and Tv; 0 = isotropic
    Image specular; // rgb or grey F0; level 0 holds Ks, which is F0 times energy.h's factors
    glm::vec3 specularConstant{0.04f};
    Image diffuse; // rgb or grey Kd, linear
    glm::vec3 diffuseConstant{0.0f};
};

struct Options {
    Method method = Method::fit;
    Model model = Model::ashikhminShirley;
    int threads = 0; // 0 = all cores
    // Drops the finest levels: for height maps of micro-geometry (brush strokes, scratches) that is never
    // seen as such. An 8192 x 8192 map reduced by 3 becomes a 1024 x 1024 chain whose level 0 is fitted.
    int reduce = 0;
    Reconstruction reconstruction = Reconstruction::box;
    // A closed form whose E is below this stays, and that much may E rise by what makes the fit fast: texels
    // are fitted to mixtures of lobes in place of sums at quadrature nodes. 0: the exact fit throughout.
    float precision = 0.002f;
    LobeCount lobes = LobeCount::one; // of the method fit; the others have one
    // Closed forms state the mean Ks, which keeps the energy of a lobe of their shape. With this they get the
    // Ks of least error instead, <G, f> / <f, f>, as the fit does: comparisons use that.
    bool bestKs = false;
    class Profile* profile = nullptr; // counts the time of each step
};

struct Level {
    int width = 0;
    int height = 0;
    std::vector<float> texels; // width * height * kChannels, row-major, row 0 on top
    // width * height * kSecondChannels; empty on level 0 and in chains without a second lobe.
    std::vector<float> second;
    const float* at(int x, int y) const { return texels.data() + (size_t(y) * width + x) * kChannels; }
    const float* secondAt(int x, int y) const
    {
        return second.data() + (size_t(y) * width + x) * kSecondChannels;
    }
};

struct ReflectanceMips {
    std::vector<Level> levels; // level L is max(1, floor(size / 2^L)); the last is 1 x 1
    std::string model, method, lobes, version, source; // the file's lumel:* metadata
};

// Of the chain's level 0, before any reduction: that of the largest map.
glm::ivec2 mapSize(const Maps& maps);

// Perceptual roughness along and across the direction of anisotropy (KHR_materials_anisotropy):
// alpha along it is mix(alpha, 1, strength^2), across it alpha.
glm::vec2 anisotropicRoughness(float perceptualRoughness, float strength);

// Receives a chain's levels as they are finished, the finest first, each from its first row to its last.
struct LevelSink {
    static constexpr int kBand = 64; // rows per call, fewer for the last of a level
    virtual ~LevelSink() = default;
    // Called once, first. With second lobes, rows() gets some from level 1 on.
    virtual void begin(bool secondLobes) = 0;
    // `second` is null where a level has no second lobes.
    virtual void rows(int number, int width, int height, int firstRow, int count, const float* texels,
                      const float* second) = 0;
};

// Bakes all levels. Throws Error for unusable maps (none given, both height and normal, zero size, NaN)
// and Interrupted after Ctrl-C. `progress` counts progressUnits(): as many units as level 0 has texels for
// each level above it.
ReflectanceMips bake(const Maps& maps, const Options& options, Progress* progress = nullptr);
size_t progressUnits(const Maps& maps);
// The same without keeping the levels, which are the bulk of a large chain. Returns the metadata only.
ReflectanceMips bake(const Maps& maps, const Options& options, LevelSink& sink, Progress* progress);

// Stands in for such a chain until that is there, at a small part of its cost: of the same size, with the
// same level 0, in coarser levels the method's closed form (LEAN for what is fitted), and no error: E = 0.
ReflectanceMips placeholder(const Maps& maps, const Options& options);

// The metadata of such a bake.
ReflectanceMips metadata(const Maps& maps, const Options& options);
// Hash of every input and option that changes the result: the file's lumel:source and the cache key.
std::string sourceHash(const Maps& maps, const Options& options);

// Rounds a texel to half floats, so that it is still a lobe: finite, and S positive definite.
void quantise(float* texel);
void quantiseSecond(float* texel); // kSecondChannels

// OpenEXR (baker/README.md): tiled, MIPMAP_LEVELS, half (or float), channels by name
// (N.x N.y S.xx S.xy S.yy Ks.R Ks.G Ks.B Kd.R Kd.G Kd.B E, and N2.x to Ks2.B where there are second lobes),
// metadata lumel:*. Atomic.
void writeExr(const std::filesystem::path& file, const ReflectanceMips& mips, bool asFloat = false);
// Writes levels as they are finished; the result holds no texels.
ReflectanceMips bakeExr(const std::filesystem::path& file, const Maps& maps, const Options& options,
                        bool asFloat, Progress* progress);
// Throws Error when the file is not such a chain, complete and finite.
ReflectanceMips readExr(const std::filesystem::path& file);
// Its metadata without its levels. Throws Error when readExr() would not accept the file by its header.
// `isFloat`, when given, is set to whether it stores single precision.
ReflectanceMips readExrMetadata(const std::filesystem::path& file, bool* isFloat = nullptr);
// lumel:source of a file whose metadata can be read, else empty.
std::string bakedSource(const std::filesystem::path& file, bool* isFloat = nullptr);

} // namespace lumel::baker
