// Meshes and images for subjects.
#include "subject.h"
#include <random>

namespace lumel::test {
namespace {

void addGrid(Shape& shape, int rows, int columns)
{
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const auto a = uint32_t(y * (columns + 1) + x), b = a + 1, c = a + uint32_t(columns) + 1,
                       d = c + 1;
            shape.indices.insert(shape.indices.end(), {a, c, d, a, d, b});
        }
}

} // namespace

Shape sheet(int cells)
{
    Shape shape;
    for (int y = 0; y <= cells; ++y)
        for (int x = 0; x <= cells; ++x) {
            const glm::vec2 uv = glm::vec2(x, y) / float(cells);
            shape.positions.push_back({2.0f * uv.x - 1.0f, 1.0f - 2.0f * uv.y, 0.0f});
            shape.normals.push_back({0, 0, 1});
            shape.tangents.push_back({1, 0, 0, 1});
            shape.uvs.push_back(uv);
            shape.secondUvs.push_back({uv.y, 1.0f - uv.x});
        }
    addGrid(shape, cells, cells);
    return shape;
}

Shape ball(int rows, int columns)
{
    Shape shape;
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= columns; ++x) {
            const glm::vec2 uv(float(x) / float(columns), float(y) / float(rows));
            const float phi = 2.0f * shared::kPi * uv.x, theta = shared::kPi * uv.y;
            const glm::vec3 n(std::sin(theta) * std::sin(phi), std::cos(theta),
                              std::sin(theta) * std::cos(phi));
            shape.positions.push_back(n);
            shape.normals.push_back(n);
            shape.tangents.push_back({std::cos(phi), 0.0f, -std::sin(phi), 1.0f});
            shape.uvs.push_back(uv);
            shape.secondUvs.push_back({uv.y, 1.0f - uv.x});
        }
    addGrid(shape, rows, columns);
    return shape;
}

Image patches(int size, int cells, uint32_t seed, bool withAlpha)
{
    std::mt19937 random(seed);
    Image cell(cells, cells, 4);
    for (size_t i = 0; i < cell.pixels.size(); ++i)
        cell.pixels[i] = i % 4 == 3 ? float(random() >> 8 & 1u) : float(random() % 256u) / 255.0f;
    Image image(size, size, withAlpha ? 4 : 3);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x)
            std::copy_n(cell.at(x * cells / size, y * cells / size), image.channels, image.at(x, y));
    return image;
}

Image holes(int size, int cells, uint32_t seed)
{
    Image image = patches(size, cells, seed, true);
    for (size_t i = 0; i < image.pixels.size(); ++i)
        if (i % 4 != 3)
            image.pixels[i] = i % 4 == 0 ? 0.9f : 0.3f;
    return image;
}

Image bumps(int size, uint32_t seed)
{
    std::mt19937 random(seed);
    struct Wave {
        float x, y, phase, slope;
    };
    std::vector<Wave> waves;
    for (int i = 0; i < 6; ++i)
        waves.push_back({float(random() % 9u) - 4.0f, float(random() % 9u) - 4.0f,
                         float(random() % 628u) / 100.0f, 0.15f});
    Image image(size, size, 3);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            glm::vec2 slope(0.0f);
            for (const Wave& wave : waves) {
                const float at = 2.0f * shared::kPi * (wave.x * float(x) + wave.y * float(y)) / float(size);
                slope += glm::vec2(wave.x, wave.y) * (0.5f * wave.slope * std::cos(at + wave.phase));
            }
            const glm::vec3 n = 0.5f + 0.5f * glm::normalize(glm::vec3(slope, 1.0f));
            std::copy_n(&n.x, 3, image.at(x, y));
        }
    return image;
}

} // namespace lumel::test
