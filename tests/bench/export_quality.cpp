// How near GGX maps come to the surface: the error of pictures of a square, at distances at which a pixel
// covers 1, 2, 4, 8 and 16 texels a side, beside means over all texels under each pixel. In dB of display
// values, of
//   average   an engine's own MIPs: averaged normals and roughness
//   vMF       averaged normals; alpha^2 + 2 / kappa, kappa from the length of the mean normal (Filament's
//             roughness-prefilter)
//   export    what lumel export writes
//   build/export_quality baked.exr...
// With a picture's name first, that picture in place of the table: a row for each material at the first level
// of 256 pixels or fewer; average, vMF, export and the mean over all texels.
//   build/export_quality picture.jpg baked.exr...
#include "baker/footprint.h"
#include "core/decoder_process.h"
#include "core/error.h"
#include "export/ggx.h"
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <numeric>
#include <span>
#include <tbb/parallel_for.h>

namespace lumel {
namespace {

using baker::GgxLevel;
using baker::GgxShape;
using baker::GgxTexel;

constexpr float kPi = 3.14159265f;

// Walter et al. 2007 with Smith's height-correlated masking (Heitz 2014) and Schlick's Fresnel; Lambert.
glm::vec3 shade(const GgxTexel& t, glm::vec3 l, glm::vec3 v)
{
    const glm::vec3 n = t.shape.normal, h = glm::normalize(l + v);
    const float nl = glm::dot(n, l), nv = std::max(glm::dot(n, v), 1e-3f), nh = glm::dot(n, h);
    if (nl <= 0.0f)
        return glm::vec3(0.0f);
    const float a2 = t.shape.alphaT * t.shape.alphaB, d = 1.0f + (a2 - 1.0f) * nh * nh;
    const float mask =
        nl * std::sqrt(a2 + (1.0f - a2) * nv * nv) + nv * std::sqrt(a2 + (1.0f - a2) * nl * nl);
    const float grazing = std::pow(1.0f - std::max(glm::dot(v, h), 0.0f), 5.0f);
    const glm::vec3 fresnel = t.f0 + (1.0f - t.f0) * grazing;
    return (fresnel * (a2 / (kPi * d * d) * 0.5f / mask) + t.diffuse / kPi) * nl;
}

// Of a point of the square [0, 1]^2: three lights from different sides.
glm::vec3 radiance(const GgxTexel& texel, glm::vec2 at)
{
    const glm::vec3 point(at, 0.0f), v = glm::normalize(glm::vec3(0.5f, -0.4f, 0.8f) - point);
    glm::vec3 sum(0.0f);
    for (const glm::vec3 light :
         {glm::vec3(0.5f, 1.4f, 0.8f), glm::vec3(-0.3f, 0.2f, 0.6f), glm::vec3(1.2f, 0.9f, 1.0f)})
        sum += shade(texel, glm::normalize(light - point), v);
    return sum;
}

glm::vec3 display(glm::vec3 colour)
{
    for (int c = 0; c < 3; ++c)
        colour[c] = linearToSrgb(1.0f - std::exp(-colour[c]));
    return colour;
}

std::vector<GgxTexel> texelsUnder(const GgxLevel& base, const GgxLevel& level, int x, int y)
{
    const baker::Footprint columns(x, level.width, base.width), rows(y, level.height, base.height);
    std::vector<GgxTexel> texels;
    for (int j = rows.first; j < rows.last; ++j)
        for (int i = columns.first; i < columns.last; ++i)
            texels.push_back(base.at(i, j));
    return texels;
}

// What maps that are averaged hold; with `spreads`, the spread of normals is in alpha.
GgxTexel averaged(const std::vector<GgxTexel>& texels, bool spreads)
{
    GgxTexel mean;
    glm::vec3 normal(0.0f);
    float roughness = 0.0f, squared = 0.0f;
    const float share = 1.0f / float(texels.size());
    for (const GgxTexel& t : texels) {
        const float product = t.shape.alphaT * t.shape.alphaB;
        normal += share * t.shape.normal;
        roughness += share * std::sqrt(std::sqrt(product));
        squared += share * product;
        mean.f0 += share * t.f0;
        mean.diffuse += share * t.diffuse;
    }
    const float r = std::min(glm::length(normal), 1.0f - 1e-7f);
    const float kappa = (3.0f * r - r * r * r) / (1.0f - r * r);
    mean.shape.normal = normal / r;
    mean.shape.alphaT = mean.shape.alphaB =
        spreads ? std::min(std::sqrt(squared + 2.0f / kappa), 1.0f) : roughness * roughness;
    return mean;
}

using Errors = glm::dvec3; // average, vMF, export

struct Pixel {
    glm::vec3 average, vmf, own, truth;
};

Pixel pixelAt(const GgxLevel& base, const GgxLevel& level, int x, int y)
{
    const glm::vec2 at((float(x) + 0.5f) / float(level.width), (float(y) + 0.5f) / float(level.height));
    const std::vector<GgxTexel> texels = texelsUnder(base, level, x, y);
    glm::vec3 truth(0.0f);
    for (const GgxTexel& t : texels)
        truth += radiance(t, at) / float(texels.size());
    return {display(radiance(averaged(texels, false), at)), display(radiance(averaged(texels, true), at)),
            display(radiance(level.at(x, y), at)), display(truth)};
}

Errors errorsAt(const GgxLevel& base, const GgxLevel& level, int x, int y)
{
    const Pixel p = pixelAt(base, level, x, y);
    const auto error = [&](glm::vec3 d) { return double(glm::dot(d - p.truth, d - p.truth)) / 3.0; };
    return {error(p.average), error(p.vmf), error(p.own)};
}

// Mean over up to 128 x 128 pixels, evenly spread.
Errors errorsOf(const GgxLevel& base, const GgxLevel& level)
{
    constexpr int kMost = 128;
    const int width = std::min(level.width, kMost), height = std::min(level.height, kMost);
    std::vector<Errors> rows(size_t(height), Errors(0.0));
    tbb::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x)
            rows[size_t(y)] += errorsAt(base, level, (2 * x + 1) * level.width / (2 * width),
                                        (2 * y + 1) * level.height / (2 * height));
    });
    return std::reduce(rows.begin(), rows.end()) / double(width * height);
}

std::string decibels(double error)
{
    return error < 1e-9 ? "same" : fmt::format("{:.1f}", -10.0 * std::log10(error));
}

void printRow(const std::filesystem::path& file)
{
    const std::vector<GgxLevel> levels = baker::fitGgx(baker::readExr(file), {});
    std::string row = "| " + file.stem().string() + " |";
    for (size_t l = 1; l < std::min<size_t>(levels.size(), 5); ++l) {
        const Errors e = errorsOf(levels[0], levels[l]);
        row += fmt::format(" {} / {} / {} |", decibels(e[0]), decibels(e[1]), decibels(e[2]));
    }
    fmt::print("{}\n", row);
}

// Appends the four pictures of a material, side by side.
void addRow(Image& picture, const std::filesystem::path& file)
{
    constexpr int kSide = 256, kGap = 6;
    const std::vector<GgxLevel> levels = baker::fitGgx(baker::readExr(file), {});
    const GgxLevel& level =
        *std::ranges::find_if(levels, [](const GgxLevel& l) { return std::max(l.width, l.height) <= kSide; });
    const int top = picture.height + (picture.height ? kGap : 0);
    Image grown(4 * kSide + 3 * kGap, top + level.height, 3);
    std::ranges::fill(grown.pixels, 1.0f);
    std::ranges::copy(picture.pixels, grown.pixels.begin());
    tbb::parallel_for(0, level.height, [&](int y) {
        for (int x = 0; x < level.width; ++x) {
            const Pixel p = pixelAt(levels[0], level, x, y);
            int left = x;
            for (const glm::vec3& colour : {p.average, p.vmf, p.own, p.truth}) {
                std::copy_n(&colour.x, 3, grown.at(left, top + y));
                left += kSide + kGap;
            }
        }
    });
    picture = std::move(grown);
}

void writePicture(const std::filesystem::path& picture, std::span<char*> files)
{
    Image rows(0, 0, 3);
    for (const char* file : files)
        addRow(rows, file);
    writeImage(picture, rows);
}

void printTable(std::span<char*> files)
{
    fmt::print("| average / vMF / export, dB | 2 | 4 | 8 | 16 |\n| --- | --- | --- | --- | --- |\n");
    for (const char* file : files)
        printRow(file);
}

} // namespace
} // namespace lumel

int main(int argc, char** argv)
{
    try {
        const lumel::DecoderProcess decoder; // before any thread
        const std::span files(argv + 1, size_t(argc - 1));
        const std::string first = files.empty() ? "" : files[0];
        if (first.ends_with(".jpg") || first.ends_with(".png"))
            lumel::writePicture(first, files.subspan(1));
        else
            lumel::printTable(files);
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "export_quality: {}\n", e.what());
        return 1;
    }
}
