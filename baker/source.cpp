#include "source.h"
#include "core/error.h"
#include "normals.h"
#include "shared/energy.h"
#include "shared/lobe.h"
#include <fmt/format.h>
#include <limits>

namespace lumel::baker {
namespace {

constexpr float kMaxReflectance = 60000.0f; // half float ends at 65504

void checkImage(const Image& image, const char* name, int channelsNeeded)
{
    if (image.empty() && image.width == 0 && image.height == 0)
        return;
    if (image.width < 1 || image.height < 1 || image.channels < 1 ||
        image.pixels.size() != size_t(image.width) * size_t(image.height) * size_t(image.channels))
        throw Error(fmt::format("{} map: {} x {} with {} channels is no image; load it again", name,
                                image.width, image.height, image.channels));
    if (image.channels < channelsNeeded)
        throw Error(fmt::format("{} map: {} channel(s), but {} are needed; export it with colour", name,
                                image.channels, channelsNeeded));
    for (size_t i = 0; i < image.pixels.size(); ++i)
        if (!std::isfinite(image.pixels[i])) {
            const size_t texel = i / size_t(image.channels);
            throw Error(fmt::format("{} map: the texel at ({}, {}) is not a finite number; repair the map",
                                    name, texel % size_t(image.width), texel / size_t(image.width)));
        }
}

void checkConstant(float value, float lowest, const char* name)
{
    if (!std::isfinite(value) || value < lowest)
        throw Error(
            fmt::format("{} {}: must be a finite number of at least {}; change it", name, value, lowest));
}

// Neighbours often have one roughness, and logarithms take long.
class PowerOfRoughness {
public:
    float operator()(float roughness)
    {
        if (roughness != roughness_) {
            roughness_ = roughness;
            power_ = shared::powerFromRoughness(roughness);
        }
        return power_;
    }

private:
    float roughness_ = std::numeric_limits<float>::quiet_NaN(), power_ = 0.0f;
};

float clampPower(float power)
{
    return std::clamp(power, shared::kMinPower, shared::kMaxPower);
}

} // namespace

// Bilinear lookup of a map of any size at the centre of texel (x, y) of the chain's level 0.
struct Source::Sampler {
    int i0, i1, j0, j1;
    float wi, wj;

    Sampler(const Source& s, int w, int h, int x, int y)
    {
        axis(x, w, s.width_, s.maps_.wrap, i0, i1, wi);
        axis(y, h, s.height_, s.maps_.wrap, j0, j1, wj);
    }
    static void axis(int x, int size, int fullSize, Wrap wrap, int& i0, int& i1, float& weight)
    {
        const double at = (x + 0.5) * size / fullSize - 0.5;
        const double below = std::floor(at);
        weight = float(at - below);
        i0 = wrapped(int(below), size, wrap);
        i1 = weight > 0.0f ? wrapped(int(below) + 1, size, wrap) : i0;
    }
    template<class Get>
    auto blend(const Get& get) const
    {
        return (get(i0, j0) * (1.0f - wi) + get(i1, j0) * wi) * (1.0f - wj) +
               (get(i0, j1) * (1.0f - wi) + get(i1, j1) * wi) * wj;
    }
};

void Lobes::resize(size_t count)
{
    for (auto* v : {&nx, &ny, &nz, &sxx, &sxy, &syy, ks, ks + 1, ks + 2, kd, kd + 1, kd + 2})
        v->resize(count);
}

void Lobes::append(const Lobes& other, size_t at)
{
    if (size() < at + other.size())
        resize(at + other.size());
    const auto copy = [&](const std::vector<float>& from, std::vector<float>& to) {
        std::copy(from.begin(), from.end(), to.begin() + std::ptrdiff_t(at));
    };
    copy(other.nx, nx);
    copy(other.ny, ny);
    copy(other.nz, nz);
    copy(other.sxx, sxx);
    copy(other.sxy, sxy);
    copy(other.syy, syy);
    for (int c = 0; c < 3; ++c) {
        copy(other.ks[c], ks[c]);
        copy(other.kd[c], kd[c]);
    }
}

float lowestPower(const Lobes& lobes, size_t m)
{
    const float mean = 0.5f * (lobes.sxx[m] + lobes.syy[m]), half = 0.5f * (lobes.sxx[m] - lobes.syy[m]);
    return 1.0f / (mean + std::sqrt(half * half + lobes.sxy[m] * lobes.sxy[m]));
}

Source::Source(const Maps& maps) : maps_(maps)
{
    if (maps.height.empty() && maps.normal.empty())
        throw Error("no height map and no normal map: give one of them");
    if (!maps.height.empty() && !maps.normal.empty())
        throw Error("both a height map and a normal map: give only one of them");
    checkImage(maps.height, "height", 1);
    checkImage(maps.normal, "normal", 2);
    checkImage(maps.power, "power", 1);
    checkImage(maps.roughness, "roughness", 1);
    checkImage(maps.anisotropy, "anisotropy", 1);
    checkImage(maps.tangentRotation, "tangent rotation", 1);
    checkImage(maps.specular, "specular", 1);
    checkImage(maps.diffuse, "diffuse", 1);
    if (!maps.height.empty() && (!std::isfinite(maps.heightScale) || maps.heightScale == 0.0f))
        throw Error("height scale 0: give the height of white in units of the map's width, such as 0.02");
    if (!maps.anisotropy.empty() && maps.roughness.empty())
        throw Error("an anisotropy map without a roughness map: give one");
    checkConstant(maps.normalScale, -1e6f, "normal scale");
    checkConstant(maps.powerConstant, 0.0f, "power");
    checkConstant(maps.anisotropicPower.x, 0.0f, "power along u");
    checkConstant(maps.anisotropicPower.y, 0.0f, "power along v");
    for (int c = 0; c < 3; ++c) {
        checkConstant(maps.specularConstant[c], 0.0f, "specular");
        checkConstant(maps.diffuseConstant[c], 0.0f, "diffuse");
    }
    width_ = mapSize(maps).x;
    height_ = mapSize(maps).y;
    const glm::vec2 p = maps.anisotropicPower;
    isotropic_ = maps.anisotropy.empty() && (p.x <= 0.0f || p.y <= 0.0f || p.x == p.y);
    colouredSpecular_ = maps.specular.channels >= 3;
    maxPower_ = shared::kMaxPower;
    constantPower_ = maps.power.empty() && maps.roughness.empty();
    if (constantPower_)
        maxPower_ = clampPower(isotropic_ && p.x <= 0.0f ? maps.powerConstant : std::max(p.x, p.y));
}

glm::vec3 Source::nativeNormal(int x, int y) const
{
    return maps_.height.empty() ? normalFromMap(maps_, x, y)
                                : normalFromHeight(maps_.height, maps_.heightScale, maps_.wrap, x, y);
}

void Source::readNormals(int y, int x0, int x1, Lobes& out, size_t at) const
{
    const Image& map = maps_.height.empty() ? maps_.normal : maps_.height;
    const bool sameSize = map.width == width_ && map.height == height_;
    for (int x = x0; x < x1; ++x, ++at) {
        glm::vec3 n;
        if (sameSize) {
            n = nativeNormal(x, y);
        } else {
            const Sampler sampler(*this, map.width, map.height, x, y);
            n = aboveHorizon(sampler.blend([&](int i, int j) { return nativeNormal(i, j); }));
        }
        out.nx[at] = n.x;
        out.ny[at] = n.y;
        out.nz[at] = n.z;
    }
}

// S = R diag(1/pu, 1/pv) R^T, R turning Tu by the texel's rotation. A power or roughness map sets the
// geometric mean sqrt(pu pv); the anisotropic constants then give only the ratio. With an anisotropy map the
// roughness is that along Tv.
void Source::readPowers(int y, int x0, int x1, Lobes& out, size_t at) const
{
    const glm::vec2 pair = maps_.anisotropicPower;
    const bool aniso = pair.x > 0.0f && pair.y > 0.0f;
    const float ratio = aniso ? std::sqrt(pair.x / pair.y) : 1.0f;
    const Image& map = maps_.roughness.empty() ? maps_.power : maps_.roughness;
    if (map.empty() && !aniso) {
        const auto fill = [&](std::vector<float>& values, float value) {
            std::fill_n(values.begin() + ptrdiff_t(at), x1 - x0, value);
        };
        fill(out.sxx, 1.0f / clampPower(maps_.powerConstant));
        fill(out.sxy, 0.0f);
        fill(out.syy, 1.0f / clampPower(maps_.powerConstant));
        return;
    }
    PowerOfRoughness powerAlong, powerAcross;
    for (int x = x0; x < x1; ++x, ++at) {
        const auto lookUp = [&](const Image& from) {
            const auto get = [&](int i, int j) { return *from.at(i, j); };
            return from.width == width_ && from.height == height_
                       ? get(x, y)
                       : Sampler(*this, from.width, from.height, x, y).blend(get);
        };
        float along = aniso ? std::sqrt(pair.x * pair.y) : maps_.powerConstant, across;
        if (!maps_.anisotropy.empty()) {
            const glm::vec2 rough = anisotropicRoughness(lookUp(map), lookUp(maps_.anisotropy));
            along = powerAlong(rough.x);
            across = powerAcross(rough.y);
        } else {
            if (!map.empty())
                along = maps_.roughness.empty() ? lookUp(map) : powerAlong(lookUp(map));
            across = along / ratio;
            along *= ratio;
        }
        const float su = 1.0f / clampPower(along);
        const float sv = 1.0f / clampPower(across);
        out.sxx[at] = su;
        out.sxy[at] = 0.0f;
        out.syy[at] = sv;
        if (su != sv && !maps_.tangentRotation.empty()) {
            const Image& rotation = maps_.tangentRotation;
            // The angle lives on a circle of period pi: nearest texel, since blending across the wrap
            // from 1 to 0 would turn it through every angle between.
            const int i = std::min(int((x + 0.5) * rotation.width / width_), rotation.width - 1);
            const int j = std::min(int((y + 0.5) * rotation.height / height_), rotation.height - 1);
            const float angle = *rotation.at(i, j) * shared::kPi;
            const float c = std::cos(angle), s = std::sin(angle);
            out.sxx[at] = c * c * su + s * s * sv;
            out.sxy[at] = c * s * (su - sv);
            out.syy[at] = s * s * su + c * c * sv;
        }
    }
}

void Source::readColours(const Image& image, glm::vec3 constant, int y, int x0, int x1,
                         std::vector<float>* channels, size_t at) const
{
    for (int c = 0; c < 3; ++c) {
        float* out = channels[c].data() + at;
        if (image.empty()) {
            std::fill_n(out, x1 - x0, std::clamp(constant[c], 0.0f, kMaxReflectance));
            continue;
        }
        const int channel = image.channels >= 3 ? c : 0;
        const bool sameSize = image.width == width_ && image.height == height_;
        for (int x = x0; x < x1; ++x) {
            const auto get = [&](int i, int j) { return image.at(i, j)[channel]; };
            const float value =
                sameSize ? get(x, y) : Sampler(*this, image.width, image.height, x, y).blend(get);
            out[x - x0] = std::clamp(value, 0.0f, kMaxReflectance);
        }
    }
}

void Source::read(int y, int x0, int x1, Lobes& out, size_t at) const
{
    readNormals(y, x0, x1, out, at);
    readPowers(y, x0, x1, out, at);
    readColours(maps_.specular, maps_.specularConstant, y, x0, x1, out.ks, at);
    readColours(maps_.diffuse, maps_.diffuseConstant, y, x0, x1, out.kd, at);
    glm::vec3 f0(-1.0f), covariance(0.0f), ks(0.0f); // of the texel before
    for (size_t i = at; i < at + size_t(x1 - x0); ++i) {
        const glm::vec3 f(out.ks[0][i], out.ks[1][i], out.ks[2][i]), s = out.covariance(i);
        if (f != f0 || s != covariance) {
            ks = glm::min(shared::specularStrength(f, s), kMaxReflectance);
            f0 = f;
            covariance = s;
        }
        for (int c = 0; c < 3; ++c)
            out.ks[c][i] = ks[c];
    }
}

glm::vec2 anisotropicRoughness(float perceptualRoughness, float strength)
{
    const float alpha = perceptualRoughness * perceptualRoughness;
    return {std::sqrt(alpha + (1.0f - alpha) * strength * strength), perceptualRoughness};
}

} // namespace lumel::baker
