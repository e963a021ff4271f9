#include "closed_form.h"
#include "core/error.h"
#include "footprint.h"
#include "normals.h"

namespace lumel::baker {

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
        break;
    }
    return shape;
}

HeightMips::HeightMips(const Maps& maps, int width, int height)
    : maps_(maps), fullWidth_(width), fullHeight_(height)
{
    if (maps.height.empty())
        throw Error("method height needs a height map; a normal map holds no heights");
}

void HeightMips::setLevel(int width, int height)
{
    // Box-filter the height map at its own resolution; where the level is finer than the map, keep it.
    const Image& map = maps_.height;
    const int w = std::min(width, map.width), h = std::min(height, map.height);
    level_ = Image(w, h, 1);
    for (int y = 0; y < h; ++y) {
        const Footprint fy(y, h, map.height);
        for (int x = 0; x < w; ++x) {
            const Footprint fx(x, w, map.width);
            double sum = 0.0;
            for (int j = fy.first; j < fy.last; ++j)
                for (int i = fx.first; i < fx.last; ++i)
                    sum += double(*map.at(i, j)) * fx.weight(i) * fy.weight(j);
            *level_.at(x, y) = float(sum / ((fx.end - fx.begin) * (fy.end - fy.begin)));
        }
    }
    fullWidth_ = width;
    fullHeight_ = height;
}

glm::vec3 HeightMips::normal(int x, int y) const
{
    const int i = std::min(int((x + 0.5) * level_.width / fullWidth_), level_.width - 1);
    const int j = std::min(int((y + 0.5) * level_.height / fullHeight_), level_.height - 1);
    return normalFromHeight(level_, maps_.heightScale, maps_.wrap, i, j);
}

} // namespace lumel::baker
