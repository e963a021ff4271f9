#include "bake.h"
#include "chain.h"
#include "footprint.h"
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace lumel::baker {

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
    case Method::fitPower:
        return "fit-power";
    }
    return "";
}

const char* nameOf(Model model)
{
    return model == Model::blinnPhong ? "blinn-phong" : "ashikhmin-shirley";
}

const char* nameOf(LobeCount lobes)
{
    return lobes == LobeCount::one ? "1" : lobes == LobeCount::two ? "2" : "auto";
}

namespace {

struct MemorySink : LevelSink {
    std::vector<Level>& levels;
    explicit MemorySink(std::vector<Level>& to) : levels(to) {}
    void begin(bool) override {}
    void rows(int number, int width, int height, int firstRow, int count, const float* texels,
              const float* second) override
    {
        if (firstRow == 0)
            levels.push_back({width, height, {}, {}});
        Level& level = levels[size_t(number)];
        const auto append = [&](std::vector<float>& to, const float* from, size_t channels) {
            to.reserve(size_t(width) * size_t(height) * channels);
            to.insert(to.end(), from, from + size_t(width) * size_t(count) * channels);
        };
        append(level.texels, texels, kChannels);
        if (second)
            append(level.second, second, kSecondChannels);
    }
};

} // namespace

ReflectanceMips bake(const Maps& maps, const Options& options, LevelSink& sink, Progress* progress)
{
    tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
    arena.execute([&] { Chain(maps, options, progress).run(sink); });
    return metadata(maps, options);
}

ReflectanceMips bake(const Maps& maps, const Options& options, Progress* progress)
{
    std::vector<Level> levels;
    MemorySink sink(levels);
    ReflectanceMips mips = bake(maps, options, sink, progress);
    mips.levels = std::move(levels);
    return mips;
}

ReflectanceMips metadata(const Maps& maps, const Options& options)
{
    ReflectanceMips mips;
    mips.model = nameOf(options.model);
    mips.method = nameOf(options.method);
    mips.lobes = nameOf(options.method == Method::fit ? options.lobes : LobeCount::one);
    mips.version = kVersion;
    mips.source = sourceHash(maps, options);
    return mips;
}

glm::ivec2 mapSize(const Maps& maps)
{
    glm::ivec2 size(0);
    for (const Image* image : {&maps.height, &maps.normal, &maps.power, &maps.roughness, &maps.anisotropy,
                               &maps.tangentRotation, &maps.specular, &maps.diffuse})
        size = glm::max(size, glm::ivec2(image->width, image->height));
    return size;
}

size_t progressUnits(const Maps& maps)
{
    const glm::ivec2 size = mapSize(maps);
    return size.x > 0 && size.y > 0 ? size_t(size.x) * size_t(size.y) * size_t(levelCount(size.x, size.y) - 1)
                                    : 0;
}

} // namespace lumel::baker
