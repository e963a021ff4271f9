#include "report_measure.h"
#include "footprint.h"
#include "report_diffuse.h"
#include "report_landscape.h"
#include "solver.h"
#include <numeric>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace lumel::baker {
namespace {

struct Named {
    Method method;
    const char* name;
};
constexpr Named kOneLobe = {Method::fit, "one lobe"};
constexpr Named kOthers[] = {{Method::fitPower, "fit-power"}, {Method::lean, "lean"},
                             {Method::toksvig, "toksvig"},    {Method::average, "average"},
                             {Method::height, "height"},      {Method::flat, "flat"}};

bool fitsPairs(const Options& options)
{
    return options.method == Method::fit && options.lobes != LobeCount::one;
}

// The methods to compare with: the fit of one lobe where two are baked, and the others. A normal map holds no
// heights to average.
std::vector<Named> baselines(const Maps& maps, const Options& options)
{
    std::vector<Named> list;
    if (fitsPairs(options))
        list.push_back(kOneLobe);
    for (const Named& form : kOthers)
        if (form.method != Method::height || maps.height.width > 0)
            list.push_back(form);
    return list;
}

StoredLobe storedLobe(const Level& level, int x, int y)
{
    const float* t = level.at(x, y);
    StoredLobe lobe{{t[kNx], t[kNy], t[kSxx], t[kSxy], t[kSyy]},
                    luminance({t[kKsR], t[kKsG], t[kKsB]}),
                    0.0,
                    luminance({t[kKdR], t[kKdG], t[kKdB]}),
                    0.0,
                    {},
                    0.0,
                    {t[kNx], t[kNy]}};
    if (!level.second.empty()) {
        const float* s = level.secondAt(x, y);
        lobe.second = {s[kN2x], s[kN2y], s[kS2xx], s[kS2xy], s[kS2yy]};
        lobe.secondKs = luminance({s[kKs2R], s[kKs2G], s[kKs2B]});
        lobe.diffuseNormal = glm::dvec2(pairNormal(t, s));
    }
    return lobe;
}

// At most kReportTexels texels: one of each run of equally many, at a pseudo-random place in it, so that
// no regular pattern of the map can hide between them. The same for every bake of this size.
std::vector<int> sampleOf(const Level& level)
{
    const int64_t total = int64_t(level.width) * level.height;
    const int64_t count = std::min<int64_t>(total, kReportTexels);
    std::vector<int> sample;
    uint64_t random = 1;
    for (int64_t i = 0; i < count; ++i) {
        const int64_t from = i * total / count, to = (i + 1) * total / count;
        random = random * 6364136223846793005ull + 1442695040888963407ull; // Knuth's MMIX generator
        sample.push_back(int(from + int64_t((random >> 33) % uint64_t(to - from))));
    }
    return sample;
}

ErrorFigures figuresOf(std::vector<double> errors)
{
    std::sort(errors.begin(), errors.end());
    const size_t rank = size_t(std::ceil(0.95 * double(errors.size())));
    return {std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size()), errors[rank - 1],
            errors.back()};
}

// The steps of measure().
class Meter {
public:
    Meter(const Maps& maps, const Options& options, const ReflectanceMips& baked, const SeeChain& seen,
          Progress* progress)
        : maps_(maps), options_(options), baked_(baked), seen_(seen), progress_(progress), source_(maps),
          baselines_(baselines(maps, options))
    {
    }

    Measurement run()
    {
        const Narrowness narrow = narrowness(source_);
        auto grid = std::make_shared<DiscGrid>(gridSide(narrow));
        result_.grid = grid;
        grid_ = grid.get();
        result_.gridSide = grid->side();
        result_.narrowestDeviation = narrow.firstPercentile;
        result_.width = source_.width();
        result_.height = source_.height();
        result_.meanKs = !isFitted(options_.method) && !options_.bestKs;
        result_.oneLobe = fitsPairs(options_) ? 1 : 0;
        result_.methods = {baked_.method + (result_.meanKs ? ", mean Ks" : "")};
        collect();
        const Averages averages(source_, baked_.levels, *grid, kReportTexels);
        const Averages diffuse(source_, baked_.levels, lights_.size(), lights_.adder(), kReportTexels);
        advance(progressUnits(maps_));
        for (MeasuredLevel& level : result_.levels)
            measureLevel(averages, diffuse, level, texels_[size_t(level.number)]);
        advance(progressUnits(maps_));
        return std::move(result_);
    }

private:
    void advance(size_t units) const
    {
        if (progress_)
            progress_->advance(units);
    }

    // What every method stored at the texels to measure. One closed-form chain is held at a time.
    void collect()
    {
        texels_.resize(baked_.levels.size());
        for (size_t l = 0; l < baked_.levels.size(); ++l) {
            const Level& level = baked_.levels[l];
            if (level.width == source_.width() && level.height == source_.height())
                continue; // the input itself
            result_.levels.push_back(
                {int(l), int(l) + options_.reduce, level.width, level.height, sampleOf(level), {}, {}, {}});
            for (const int i : result_.levels.back().sample)
                texels_[l].push_back({i % level.width, i / level.width, {}});
        }
        const auto store = [&](const std::vector<Level>& levels) {
            for (size_t l = 0; l < texels_.size(); ++l)
                for (MeasuredTexel& texel : texels_[l])
                    texel.lobes.push_back(storedLobe(levels[l], texel.x, texel.y));
        };
        store(baked_.levels);
        for (const Named& form : baselines_) {
            Options options = options_;
            options.method = form.method;
            options.lobes = LobeCount::one;
            options.bestKs = true;
            ReflectanceMips chain = bake(maps_, options, progress_);
            chain.method = form.name;
            store(chain.levels);
            if (seen_)
                seen_(chain);
            result_.methods.push_back(form.name);
        }
    }

    void measureTexel(const std::vector<float>& g, std::vector<float>& f, MeasuredTexel& texel) const
    {
        const double energy = grid_->integral(g.data(), g.data());
        for (StoredLobe& lobe : texel.lobes) {
            if (energy <= 0.0)
                continue; // black: no error
            f = g;
            lobe.addTo(*grid_, -1.0f, f.data());
            lobe.error = grid_->integral(f.data(), f.data()) / energy;
        }
    }

    void measureLevel(const Averages& averages, const Averages& diffuse, MeasuredLevel& level,
                      std::vector<MeasuredTexel>& texels) const
    {
        tbb::parallel_for(tbb::blocked_range<size_t>(0, texels.size()), [&](const auto& range) {
            std::vector<float> g(grid_->size()), f, matte(lights_.size());
            for (size_t i = range.begin(); i < range.end(); ++i) {
                advance(0); // Ctrl-C
                averages.get(size_t(level.number), texels[i].x, texels[i].y, g.data());
                measureTexel(g, f, texels[i]);
                diffuse.get(size_t(level.number), texels[i].x, texels[i].y, matte.data());
                for (StoredLobe& lobe : texels[i].lobes)
                    lobe.diffuseError = diffuseError(lights_, matte, lobe.diffuseNormal, lobe.kd);
            }
        });
        for (size_t m = 0; m < result_.methods.size(); ++m) {
            std::vector<double> errors, diffuseErrors;
            for (const MeasuredTexel& texel : texels) {
                errors.push_back(texel.lobes[m].error);
                diffuseErrors.push_back(texel.lobes[m].diffuseError);
            }
            level.figures.push_back(figuresOf(std::move(errors)));
            level.diffuse.push_back(figuresOf(std::move(diffuseErrors)));
        }
        chooseExhibits(averages, level, texels);
    }

    // The best, the median and the worst texel by the first method's error.
    void chooseExhibits(const Averages& averages, MeasuredLevel& level,
                        const std::vector<MeasuredTexel>& texels) const
    {
        std::vector<size_t> order(texels.size());
        std::iota(order.begin(), order.end(), size_t(0));
        std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
            return texels[a].lobes[0].error < texels[b].lobes[0].error;
        });
        const auto show = [&](const char* rank, size_t i) {
            level.exhibits.push_back({rank, texels[order[i]], {}, {}});
        };
        if (texels.size() > 1)
            show("best", 0);
        if (texels.size() != 2)
            show(texels.size() == 1 ? "only" : "median", (texels.size() - 1) / 2);
        if (texels.size() > 1)
            show("worst", texels.size() - 1);
        tbb::parallel_for(size_t(0), level.exhibits.size(),
                          [&](size_t i) { complete(averages, level.number, level.exhibits[i]); });
    }

    void complete(const Averages& averages, int number, Exhibit& exhibit) const
    {
        exhibit.average.resize(grid_->size());
        averages.get(size_t(number), exhibit.texel.x, exhibit.texel.y, exhibit.average.data());
        std::vector<PathStart> starts;
        if (options_.method == Method::fit) {
            for (size_t m = 0; m < baselines_.size(); ++m)
                if (baselines_[m].method != Method::flat && baselines_[m].method != Method::height &&
                    baselines_[m].method != Method::fit)
                    starts.push_back({baselines_[m].name, exhibit.texel.lobes[m + 1].shape});
            addChildren(number, exhibit.texel, starts);
        }
        exhibit.landscape = landscapeOf(*grid_, exhibit.average, exhibit.texel.lobes[result_.oneLobe], starts,
                                        options_.model == Model::blinnPhong, source_.maxPower());
    }

    // The finer level's lobes under the texel, which the baker starts from too.
    void addChildren(int number, const MeasuredTexel& texel, std::vector<PathStart>& starts) const
    {
        if (number == 0)
            return;
        const Level &level = baked_.levels[size_t(number)], &finer = baked_.levels[size_t(number) - 1];
        const Footprint fx(texel.x, level.width, finer.width), fy(texel.y, level.height, finer.height);
        for (int j = fy.first; j < fy.last; ++j)
            for (int i = fx.first; i < fx.last; ++i)
                starts.push_back({"a finer lobe", storedLobe(finer, i, j).shape});
    }

    const Maps& maps_;
    const Options& options_;
    const ReflectanceMips& baked_;
    const SeeChain& seen_;
    Progress* progress_;
    Source source_;
    std::vector<Named> baselines_;
    const DiscGrid* grid_ = nullptr;
    const LightGrid lights_;
    Measurement result_;
    std::vector<std::vector<MeasuredTexel>> texels_; // [level]
};

} // namespace

void StoredLobe::addTo(const DiscGrid& grid, float scale, float* g) const
{
    grid.add(shape, scale * float(ks), g);
    if (secondKs > 0.0)
        grid.add(second, scale * float(secondKs), g);
}

size_t measureUnits(const Maps& maps, const Options& options)
{
    return (baselines(maps, options).size() + 2) * progressUnits(maps);
}

Measurement measure(const Maps& maps, const Options& options, const ReflectanceMips& baked,
                    const SeeChain& seen, Progress* progress)
{
    Measurement result;
    tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
    arena.execute([&] { result = Meter(maps, options, baked, seen, progress).run(); });
    result.box = options.reconstruction == Reconstruction::box;
    result.threads = arena.max_concurrency();
    return result;
}

} // namespace lumel::baker
