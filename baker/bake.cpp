#include "bake.h"
#include "chain.h"
#include "footprint.h"
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace lumel::baker {
namespace {

const char* nameOf(Method method)
{
    switch (method) {
    case Method::fit:
        return "fit";
    case Method::average:
        return "average";
    case Method::flat:
        return "flat";
    case Method::height:
        return "height";
    case Method::toksvig:
        return "toksvig";
    case Method::lean:
        return "lean";
    }
    return "";
}

} // namespace

ReflectanceMips bake(const Maps& maps, const Options& options, Progress* progress)
{
    ReflectanceMips mips;
    tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
    arena.execute([&] { mips.levels = Chain(maps, options, progress).run(); });
    mips.model = options.model == Model::blinnPhong ? "blinn-phong" : "ashikhmin-shirley";
    mips.method = nameOf(options.method);
    mips.version = kVersion;
    mips.source = sourceHash(maps, options);
    return mips;
}

size_t progressUnits(const Maps& maps)
{
    int width = 0, height = 0;
    for (const Image* image : {&maps.height, &maps.normal, &maps.power, &maps.roughness,
                               &maps.tangentRotation, &maps.specular, &maps.diffuse}) {
        width = std::max(width, image->width);
        height = std::max(height, image->height);
    }
    return size_t(width) * size_t(height) *
           size_t(width > 0 && height > 0 ? levelCount(width, height) - 1 : 0);
}

} // namespace lumel::baker
