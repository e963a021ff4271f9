#include "closed_form.h"
#include "core/error.h"
#include "footprint.h"
#include "normals.h"
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace lumel::baker {
namespace {

// The first channel, each texel the mean of the area that it covers.
Image averaged(const Image& in, int width, int height)
{
    Image out(width, height, 1);
    std::vector<Footprint> columns;
    for (int x = 0; x < width; ++x)
        columns.emplace_back(x, width, in.width);
    tbb::parallel_for(tbb::blocked_range<int>(0, height, 16), [&](const auto& rows) {
        for (int y = rows.begin(); y < rows.end(); ++y) {
            const Footprint fy(y, height, in.height);
            for (int x = 0; x < width; ++x) {
                const Footprint& fx = columns[size_t(x)];
                double sum = 0.0;
                for (int j = fy.first; j < fy.last; ++j)
                    for (int i = fx.first; i < fx.last; ++i)
                        sum += double(*in.at(i, j)) * fx.weight(i) * fy.weight(j);
                *out.at(x, y) = float(sum / ((fx.end - fx.begin) * (fy.end - fy.begin)));
            }
        }
    });
    return out;
}

} // namespace

Shape closedFormShape(Method method, const Moments& mean, glm::vec3 mapNormal)
{
    Shape shape = averageShape(mean);
    switch (method) {
    case Method::toksvig:
        return toksvigShape(mean);
    case Method::lean:
        return leanShape(mean);
    case Method::flat:
    case Method::height:
        shape.nx = mapNormal.x;
        shape.ny = mapNormal.y;
        return shape;
    case Method::average:
    case Method::fit:
    case Method::fitPower:
        break;
    }
    return shape;
}

HeightMips::HeightMips(const Maps& maps, int width, int height) : maps_(maps), width_(width), height_(height)
{
    if (maps.height.empty())
        throw Error("method height needs a height map; a normal map holds no heights");
    const int count = levelCount(width, height);
    for (int level = 1; level < count; ++level) {
        // Averages of the map's own texels: where the level is finer than the map, they are the map's.
        const Image& map = maps.height;
        const int w = std::min(levelSize(width, level), map.width);
        const int h = std::min(levelSize(height, level), map.height);
        // Averages of averages where texels nest, which costs less.
        const Image* finer = levels_.empty() ? &map : &levels_.back();
        if (finer->width % w != 0 || finer->height % h != 0)
            finer = &map;
        levels_.push_back(averaged(*finer, w, h));
    }
}

glm::vec3 HeightMips::normal(int level, int x, int y) const
{
    const Image& heights = levels_[size_t(level - 1)];
    const int i = std::min(int((x + 0.5) * heights.width / levelSize(width_, level)), heights.width - 1);
    const int j = std::min(int((y + 0.5) * heights.height / levelSize(height_, level)), heights.height - 1);
    return normalFromHeight(heights, maps_.heightScale, maps_.wrap, i, j);
}

} // namespace lumel::baker
