#include "environment.h"
#include "core/error.h"
#include "shared/environment.h"
#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace lumel::scene {
namespace {

using shared::kEnvironmentLevels;
using shared::kEnvironmentSize;
using shared::kPi;

constexpr float kMostRadiance = 60000.0f;                        // half float's largest is 65504
constexpr size_t kMostPixels = size_t(8192) * 4096;              // of a file: 0.4 GB decoded
constexpr int kWorkingWidth = 2 * int(shared::kEnvironmentSize); // finer pictures are averaged down first

// The picture with a direction for each pixel, which products of tables give.
struct LatLong {
    Image image;
    std::vector<float> cosLongitude, sinLongitude, cosLatitude, sinLatitude; // of columns; of rows, from +Y

    explicit LatLong(Image picture) : image(std::move(picture))
    {
        for (int x = 0; x < image.width; ++x) {
            const float angle = 2.0f * kPi * ((float(x) + 0.5f) / float(image.width) - 0.5f);
            cosLongitude.push_back(std::cos(angle));
            sinLongitude.push_back(std::sin(angle));
        }
        for (int y = 0; y < image.height; ++y) {
            const float angle = kPi * (float(y) + 0.5f) / float(image.height);
            cosLatitude.push_back(std::cos(angle));
            sinLatitude.push_back(std::sin(angle));
        }
    }
    glm::vec3 direction(int x, int y) const
    {
        const size_t i = size_t(x), j = size_t(y);
        return {sinLatitude[j] * cosLongitude[i], cosLatitude[j], sinLatitude[j] * sinLongitude[i]};
    }
    glm::vec3 at(int x, int y) const
    {
        const float* p = image.at(x, y);
        return {p[0], p[1], p[2]};
    }
};

// Half as wide and high: each pixel the average of four by their solid angles, which sinLatitude is in
// proportion to.
Image halved(const LatLong& fine)
{
    Image half(std::max(1, fine.image.width / 2), std::max(1, fine.image.height / 2), 3);
    tbb::parallel_for(0, half.height, [&](int y) {
        for (int x = 0; x < half.width; ++x) {
            glm::vec3 sum(0.0f);
            float weight = 0.0f;
            for (int k = 0; k < 4; ++k) {
                const int i = std::min(2 * x + k % 2, fine.image.width - 1);
                const int j = std::min(2 * y + k / 2, fine.image.height - 1);
                sum += fine.sinLatitude[size_t(j)] * fine.at(i, j);
                weight += fine.sinLatitude[size_t(j)];
            }
            for (int c = 0; c < 3; ++c)
                half.at(x, y)[c] = sum[c] / weight;
        }
    });
    return half;
}

glm::vec3 bilinear(const Image& image, glm::vec2 place, bool wrapsX)
{
    const float x = place.x * float(image.width) - 0.5f, y = place.y * float(image.height) - 0.5f;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const float fx = x - float(x0), fy = y - float(y0);
    glm::vec3 sum(0.0f);
    for (int k = 0; k < 4; ++k) {
        int i = x0 + k % 2;
        i = wrapsX ? (i + image.width) % image.width : std::clamp(i, 0, image.width - 1);
        const float* p = image.at(i, std::clamp(y0 + k / 2, 0, image.height - 1));
        sum += glm::vec3(p[0], p[1], p[2]) * (k % 2 ? fx : 1.0f - fx) * (k / 2 ? fy : 1.0f - fy);
    }
    return sum;
}

template<class Radiance>
Image octahedralImage(int size, Radiance radianceOf)
{
    Image image(size, size, 3);
    tbb::parallel_for(0, size, [&](int y) {
        for (int x = 0; x < size; ++x) {
            const glm::vec3 radiance = glm::min(radianceOf(x, y), kMostRadiance);
            std::copy_n(&radiance.x, 3, image.at(x, y));
        }
    });
    return image;
}

// Level 0: the picture itself, four lookups a texel.
Image resampled(const LatLong& picture)
{
    constexpr float kSize = float(kEnvironmentSize);
    return octahedralImage(int(kEnvironmentSize), [&](int x, int y) {
        glm::vec3 sum(0.0f);
        for (int k = 0; k < 4; ++k) {
            const glm::vec2 place((float(x) + 0.25f + 0.5f * float(k % 2)) / kSize,
                                  (float(y) + 0.25f + 0.5f * float(k / 2)) / kSize);
            sum += 0.25f * bilinear(picture.image, latLongPlace(shared::environmentDirection(place)), true);
        }
        return sum;
    });
}

// What a lobe of power p that is looked at along its normal takes from light at an angle of cosine c to it:
// (N.h)^p (N.l) / (l.h)^2 with N.h = l.h the cosine of half the angle.
float lobeWeight(float power, float c)
{
    const float c2 = 0.5f + 0.5f * c;
    return c > 0.0f ? std::pow(c2, 0.5f * power) * c / c2 : 0.0f;
}

// The picture averaged over lobes of the level's covariance.
class LobeFilter {
public:
    LobeFilter(const LatLong& picture, float power) : picture_(picture)
    {
        constexpr float kLeastWeight = 5e-3f;
        constexpr int kEntries = 4096;
        leastCosine_ = std::max(0.0f, 2.0f * std::pow(kLeastWeight, 2.0f / power) - 1.0f);
        radius_ = std::acos(leastCosine_);
        scale_ = float(kEntries) / (1.0f - leastCosine_);
        for (int i = 0; i <= kEntries; ++i)
            weights_.push_back(lobeWeight(power, leastCosine_ + (float(i) + 0.5f) / scale_));
    }

    glm::vec3 operator()(glm::vec3 normal) const
    {
        const Image& image = picture_.image;
        const float latitude = std::acos(std::clamp(normal.y, -1.0f, 1.0f)),
                    perRow = kPi / float(image.height);
        const int first = std::max(0, int((latitude - radius_) / perRow - 0.5f));
        const int last = std::min(image.height - 1, int((latitude + radius_) / perRow + 0.5f));
        glm::vec3 sum(0.0f);
        float total = 0.0f;
        for (int y = first; y <= last; ++y)
            addRow(normal, y, sum, total);
        return sum / std::max(total, 1e-20f);
    }

private:
    void addRow(glm::vec3 normal, int y, glm::vec3& sum, float& total) const
    {
        const float cosRow = picture_.cosLatitude[size_t(y)], sinRow = picture_.sinLatitude[size_t(y)];
        const float across = sinRow * std::sqrt(std::max(1.0f - normal.y * normal.y, 0.0f));
        // The row's part within the radius: cos(angle) = across cos(longitudes apart) + cosRow normal.y.
        const float edge = (leastCosine_ - cosRow * normal.y) / std::max(across, 1e-12f);
        const int width = picture_.image.width;
        int from = 0, count = width;
        if (edge > 1.0f)
            return;
        if (edge > -1.0f) {
            const float middle = latLongPlace(normal).x * float(width) - 0.5f;
            const float reach = std::acos(edge) / (2.0f * kPi) * float(width);
            from = int(std::ceil(middle - reach));
            count = std::min(width, int(std::floor(middle + reach)) - from + 1);
        }
        for (int i = 0, x = (from + width) % width; i < count; ++i, x = x + 1 == width ? 0 : x + 1) {
            const float c = sinRow * (picture_.cosLongitude[size_t(x)] * normal.x +
                                      picture_.sinLongitude[size_t(x)] * normal.z) +
                            cosRow * normal.y;
            if (c <= leastCosine_)
                continue;
            const float weight = sinRow * weights_[size_t((c - leastCosine_) * scale_)];
            sum += weight * picture_.at(x, y);
            total += weight;
        }
    }

    const LatLong& picture_;
    float leastCosine_ = 0.0f, radius_ = 0.0f, scale_ = 1.0f;
    std::vector<float> weights_; // by cosine from leastCosine_ to 1
};

// Ramamoorthi and Hanrahan 2001, "An Efficient Representation for Irradiance Environment Maps": the spherical
// harmonics up to order 2 (eq. 3) of the radiance, times those of the clamped cosine over pi (1, 2/3 and
// 1/4), as a polynomial in the normal. Its z^2 term is 3 z^2 - 1 of eq. 3; the -1 goes into the constant.
std::array<glm::vec3, 9> diffuseOf(const LatLong& picture)
{
    std::array<glm::dvec3, 9> sums{};
    for (int y = 0; y < picture.image.height; ++y)
        for (int x = 0; x < picture.image.width; ++x) {
            const glm::dvec3 d = picture.direction(x, y);
            const glm::dvec3 radiance = double(picture.sinLatitude[size_t(y)]) * glm::dvec3(picture.at(x, y));
            const double basis[9] = {1.0,
                                     d.x,
                                     d.y,
                                     d.z,
                                     d.x * d.y,
                                     d.y * d.z,
                                     d.x * d.z,
                                     d.x * d.x - d.y * d.y,
                                     3.0 * d.z * d.z - 1.0};
            for (size_t i = 0; i < 9; ++i)
                sums[i] += basis[i] * radiance;
        }
    // Squares of eq. 3's constants, times the cosine's.
    constexpr double pi = double(kPi);
    constexpr double linear = 2.0 / 3.0 * 3.0 / (4.0 * pi), product = 0.25 * 15.0 / (4.0 * pi);
    constexpr double factors[9] = {
        1.0 / (4.0 * pi),        linear, linear, linear, product, product, product, 0.25 * 15.0 / (16.0 * pi),
        0.25 * 5.0 / (16.0 * pi)};
    const double solidAngle = 2.0 * pi / picture.image.width * pi / picture.image.height; // by sinLatitude
    std::array<glm::vec3, 9> diffuse;
    for (size_t i = 0; i < 9; ++i)
        diffuse[i] = glm::vec3(sums[i] * factors[i] * solidAngle);
    diffuse[0] -= diffuse[8];
    diffuse[8] *= 3.0f;
    return diffuse;
}

} // namespace

glm::vec3 latLongDirection(glm::vec2 place)
{
    const float longitude = 2.0f * kPi * (place.x - 0.5f), latitude = kPi * place.y;
    return {std::sin(latitude) * std::cos(longitude), std::cos(latitude),
            std::sin(latitude) * std::sin(longitude)};
}

glm::vec2 latLongPlace(glm::vec3 d)
{
    return {std::atan2(d.z, d.x) / (2.0f * kPi) + 0.5f, std::acos(std::clamp(d.y, -1.0f, 1.0f)) / kPi};
}

Environment makeEnvironment(const Image& picture)
{
    std::vector<LatLong> halves; // each half as wide as the one before
    halves.emplace_back(picture);
    while (halves.back().image.width > kWorkingWidth) {
        Image half = halved(halves.back());
        halves.clear();
        halves.emplace_back(std::move(half));
    }
    Environment environment;
    environment.diffuse = diffuseOf(halves.front());
    environment.levels.push_back(resampled(halves.front()));
    size_t source = 0;
    for (uint32_t level = 1; level < kEnvironmentLevels; ++level) {
        const float variance = shared::environmentVariance(float(level));
        // Pixels about half as wide as the lobe's deviation, which is twice that of its half vectors.
        const float widest = std::sqrt(variance);
        while (2.0f * kPi / float(halves[source].image.width) < 0.7f * widest &&
               halves[source].image.width > 64) {
            if (source + 1 == halves.size())
                halves.emplace_back(halved(halves.back()));
            ++source;
        }
        const LobeFilter filter(halves[source], 1.0f / variance);
        const float size = float(kEnvironmentSize >> level);
        environment.levels.push_back(octahedralImage(int(size), [&](int x, int y) {
            return filter(
                shared::environmentDirection(glm::vec2((float(x) + 0.5f) / size, (float(y) + 0.5f) / size)));
        }));
    }
    return environment;
}

Environment loadEnvironment(const std::filesystem::path& file)
{
    const std::string name = file.string(), extension = file.extension().string();
    if (extension != ".hdr" && extension != ".exr")
        throw Error(
            fmt::format("{}: unknown environment format; use a Radiance .hdr or an OpenEXR .exr", name));
    const Image image = readImage(file, kMostPixels);
    if (image.width != 2 * image.height)
        throw Error(fmt::format("{}: {} x {} pixels are not an equirectangular map; it is twice as wide "
                                "as high",
                                name, image.width, image.height));
    Image rgb(image.width, image.height, 3);
    const int grey = image.channels < 3 ? 0 : 1;
    for (size_t i = 0; i < rgb.pixels.size(); ++i) {
        const size_t channel = grey * (i % 3);
        const float value = image.pixels[i / 3 * size_t(image.channels) + channel];
        if (!std::isfinite(value) || value < 0.0f)
            throw Error(fmt::format("{}: pixel {}, {} is {}, not a radiance; export it again", name,
                                    i / 3 % size_t(image.width), i / 3 / size_t(image.width),
                                    std::isfinite(value) ? "negative" : "not a finite number"));
        rgb.pixels[i] = std::min(value, 1e9f); // sums stay finite
    }
    return makeEnvironment(rgb);
}

std::shared_ptr<const Environment> chooseEnvironment(const std::string& name, const Scene& scene)
{
    if (name == "none" || (name.empty() && !scene.lights.empty()))
        return nullptr;
    return std::make_shared<const Environment>(name.empty() || name == "sky" ? skyEnvironment()
                                                                             : loadEnvironment(name));
}

glm::vec3 lookUp(const Environment& environment, glm::vec3 direction, float level)
{
    const glm::vec2 place = shared::environmentPlace(direction);
    level = std::clamp(level, 0.0f, float(kEnvironmentLevels - 1));
    const auto fine = size_t(level), coarse = std::min(fine + 1, environment.levels.size() - 1);
    return glm::mix(bilinear(environment.levels[fine], place, false),
                    bilinear(environment.levels[coarse], place, false), level - float(fine));
}

std::vector<Light> lightsOf(const Scene& scene)
{
    return scene.lights.empty() ? lightsOf(scene.environment.get()) : scene.lights;
}

std::vector<Light> lightsOf(const Environment* environment)
{
    return environment ? environment->lights : threeLightRig();
}

} // namespace lumel::scene
