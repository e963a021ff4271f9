// Stands in for a chain while that is fitted: sums of moments alone, and no error is measured.
#include "closed_form.h"
#include "footprint.h"
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace lumel::baker {
namespace {

// What closed forms need of the mean moments of a texel; as Moments, a level would be larger than the chain.
struct MeanMoments {
    std::array<float, 24> values{};

    MeanMoments() = default;
    explicit MeanMoments(const Moments& sums)
    {
        const Moments m = sums.mean();
        size_t i = 0;
        const auto add = [&](const auto&... numbers) { ((values[i++] = float(numbers)), ...); };
        for (const Sym2* s : {&m.normalNormal, &m.discCovariance, &m.precision})
            add(s->xx, s->xy, s->yy);
        for (const glm::dvec3* v : {&m.normal, &m.ks, m.kdNormal, m.kdNormal + 1, m.kdNormal + 2})
            add(v->x, v->y, v->z);
    }
    void add(const MeanMoments& other, float share)
    {
        for (size_t i = 0; i < values.size(); ++i)
            values[i] += share * other.values[i];
    }
    Moments moments() const
    {
        Moments m;
        m.weight = 1.0;
        const float* from = values.data();
        for (Sym2* s : {&m.normalNormal, &m.discCovariance, &m.precision}) {
            *s = {from[0], from[1], from[2]};
            from += 3;
        }
        for (glm::dvec3* v : {&m.normal, &m.ks, m.kdNormal, m.kdNormal + 1, m.kdNormal + 2}) {
            *v = {from[0], from[1], from[2]};
            from += 3;
        }
        return m;
    }
};

class Placeholder {
public:
    Placeholder(const Maps& maps, const Options& options) : options_(options), source_(maps)
    {
        if (options.method == Method::height)
            heights_ = std::make_unique<HeightMips>(maps, source_.width(), source_.height());
    }

    std::vector<Level> levels()
    {
        const int count = levelCount(source_.width(), source_.height());
        std::vector<Level> levels;
        for (int number = 0; number < count; ++number) {
            const int width = levelSize(source_.width(), number);
            const int height = levelSize(source_.height(), number);
            levels.push_back(
                {width, height, std::vector<float>(size_t(width) * size_t(height) * kChannels), {}});
        }
        writeBase(levels.front());
        for (int number = 1; number < count; ++number) {
            checkInterrupted();
            if (number == 1)
                sumSource(levels[1]);
            else
                sumLevel(levels[size_t(number)], levels[size_t(number - 1)]);
            write(levels[size_t(number)], number);
        }
        return levels;
    }

private:
    template<class Row>
    static void forRows(int height, const Row& row)
    {
        tbb::parallel_for(tbb::blocked_range<int>(0, height, 8), [&](const auto& rows) {
            Lobes lobes;
            for (int y = rows.begin(); y < rows.end(); ++y)
                row(y, lobes);
        });
    }

    void writeBase(Level& level) const
    {
        forRows(level.height, [&](int y, Lobes& lobes) {
            lobes.resize(size_t(level.width));
            source_.read(y, 0, level.width, lobes, 0);
            float* t = level.texels.data() + size_t(y) * size_t(level.width) * kChannels;
            for (size_t x = 0; x < lobes.size(); ++x, t += kChannels) {
                const Shape shape{lobes.nx[x], lobes.ny[x], lobes.sxx[x], lobes.sxy[x], lobes.syy[x]};
                put(t, shape, {lobes.ks[0][x], lobes.ks[1][x], lobes.ks[2][x]},
                    {lobes.kd[0][x], lobes.kd[1][x], lobes.kd[2][x]});
            }
        });
    }

    // Level 1, from the lobes.
    void sumSource(const Level& level)
    {
        sums_.resize(size_t(level.width) * size_t(level.height));
        forRows(level.height, [&](int y, Lobes& lobes) {
            const Footprint fy(y, level.height, source_.height());
            std::vector<Moments> row(static_cast<size_t>(level.width));
            lobes.resize(size_t(source_.width()));
            for (int j = fy.first; j < fy.last; ++j) {
                source_.read(j, 0, source_.width(), lobes, 0);
                for (int x = 0; x < level.width; ++x) {
                    const Footprint fx(x, level.width, source_.width());
                    for (int i = fx.first; i < fx.last; ++i)
                        row[size_t(x)].add(lobes, size_t(i), double(fx.weight(i)) * fy.weight(j));
                }
            }
            std::ranges::transform(row, sums_.begin() + ptrdiff_t(y) * level.width,
                                   [](const Moments& sums) { return MeanMoments(sums); });
        });
    }

    // A coarser one from the one before.
    void sumLevel(const Level& level, const Level& finer)
    {
        const std::vector<MeanMoments> below = std::move(sums_);
        sums_.assign(size_t(level.width) * size_t(level.height), {});
        forRows(level.height, [&](int y, Lobes&) {
            const Footprint fy(y, level.height, finer.height);
            for (int x = 0; x < level.width; ++x) {
                const Footprint fx(x, level.width, finer.width);
                const double area = (fx.end - fx.begin) * (fy.end - fy.begin);
                MeanMoments& sum = sums_[size_t(y) * size_t(level.width) + size_t(x)];
                for (int j = fy.first; j < fy.last; ++j)
                    for (int i = fx.first; i < fx.last; ++i)
                        sum.add(below[size_t(j) * size_t(finer.width) + size_t(i)],
                                float(fx.weight(i) * fy.weight(j) / area));
            }
        });
    }

    void write(Level& level, int number) const
    {
        const Method method = isFitted(options_.method) ? Method::lean : options_.method;
        const bool isotropic = isFitted(options_.method) && options_.model == Model::blinnPhong;
        forRows(level.height, [&](int y, Lobes&) {
            for (int x = 0; x < level.width; ++x) {
                const size_t i = size_t(y) * size_t(level.width) + size_t(x);
                const Moments mean = sums_[i].moments();
                const glm::vec3 normal =
                    heights_ ? heights_->normal(number, x, y) : glm::vec3(0.0f, 0.0f, 1.0f);
                Shape shape = closedFormShape(method, mean, normal);
                if (isotropic)
                    shape = isotropicShape(shape);
                put(level.texels.data() + i * kChannels, shape, mean.ks, diffuseAlong(normalOf(shape), mean));
            }
        });
    }

    static void put(float* texel, const Shape& shape, glm::vec3 ks, glm::vec3 kd)
    {
        const float values[kChannels] = {shape.nx, shape.ny, shape.sxx, shape.sxy, shape.syy, ks.r,
                                         ks.g,     ks.b,     kd.r,      kd.g,      kd.b,      0.0f};
        std::ranges::copy(values, texel);
    }

    const Options& options_;
    Source source_;
    std::unique_ptr<HeightMips> heights_;
    std::vector<MeanMoments> sums_; // of the last level
};

} // namespace

ReflectanceMips placeholder(const Maps& maps, const Options& options)
{
    ReflectanceMips mips;
    tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
    arena.execute([&] { mips.levels = Placeholder(maps, options).levels(); });
    return mips;
}

} // namespace lumel::baker
