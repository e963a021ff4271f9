// The report as a page. Pictures are 8-bit BMPs inside the page: no other file, no script.
#include "averager.h"
#include "closed_form.h"
#include "footprint.h"
#include "report.h"
#include "shared/lobe.h"
#include "solver.h"
#include <fmt/format.h>
#include <iterator>

namespace lumel::baker {
namespace {

constexpr int kDisc = 72;        // pixels across a picture of the disc
constexpr int kMostLobes = 4096; // texels over more lobes get no pictures

std::string base64(const std::vector<unsigned char>& bytes)
{
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
        const size_t left = bytes.size() - i;
        const unsigned v = unsigned(bytes[i]) << 16 | (left > 1 ? unsigned(bytes[i + 1]) << 8 : 0u) |
                           (left > 2 ? unsigned(bytes[i + 2]) : 0u);
        text += digits[v >> 18];
        text += digits[v >> 12 & 63];
        text += left > 1 ? digits[v >> 6 & 63] : '=';
        text += left > 2 ? digits[v & 63] : '=';
    }
    return text;
}

// Black, violet, orange, white: dark to light in print too.
void palette(int i, unsigned char* bgr)
{
    const float t = float(i) / 255.0f;
    bgr[2] = static_cast<unsigned char>(255.0f * std::min(1.0f, 1.6f * t));
    bgr[1] = static_cast<unsigned char>(255.0f * std::clamp(1.7f * t - 0.6f, 0.0f, 1.0f));
    bgr[0] = static_cast<unsigned char>(
        255.0f * (t < 0.4f ? 1.2f * t : std::max(0.48f - 1.6f * (t - 0.4f), 3.3f * t - 2.3f)));
}

// An <img> of values in [0, 1], rows from top to bottom.
std::string picture(const std::vector<float>& values, int width, int height)
{
    const int stride = (width + 3) / 4 * 4;
    const unsigned offset = 54 + 1024, size = offset + unsigned(stride * height);
    std::vector<unsigned char> bmp(size, 0);
    const auto put32 = [&](size_t at, unsigned v) {
        for (size_t k = 0; k < 4; ++k)
            bmp[at + k] = static_cast<unsigned char>(v >> (8 * k));
    };
    bmp[0] = 'B';
    bmp[1] = 'M';
    put32(2, size);
    put32(10, offset);
    put32(14, 40);
    put32(18, unsigned(width));
    put32(22, unsigned(height));
    bmp[26] = 1; // planes
    bmp[28] = 8; // bits
    for (int i = 0; i < 256; ++i)
        palette(i, &bmp[54 + 4 * size_t(i)]);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float v = std::clamp(values[size_t(y * width + x)], 0.0f, 1.0f);
            bmp[offset + size_t((height - 1 - y) * stride + x)] =
                static_cast<unsigned char>(255.0f * v + 0.5f);
        }
    return fmt::format("<img width={} height={} src=\"data:image/bmp;base64,{}\">", 2 * width, 2 * height,
                       base64(bmp));
}

// The disc's pixels as nodes; those outside have no area.
NodeSet discPixels()
{
    NodeSet nodes;
    for (int j = 0; j < kDisc; ++j)
        for (int i = 0; i < kDisc; ++i) {
            const float x = 2.0f * (float(i) + 0.5f) / kDisc - 1.0f,
                        y = 1.0f - 2.0f * (float(j) + 0.5f) / kDisc;
            const float z2 = 1.0f - x * x - y * y;
            if (z2 > 0.0f)
                nodes.add(x, y, std::sqrt(z2), 4.0f / (kDisc * kDisc));
            else
                nodes.add(0.0f, 0.0f, 1.0f, 0.0f);
        }
    nodes.pad();
    return nodes;
}

struct Sample {
    int x, y;
    const char* name;
};

std::vector<Sample> chooseSamples(const Level& level)
{
    std::vector<size_t> order(level.texels.size() / kChannels);
    for (size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
        return level.texels[a * kChannels + kError] < level.texels[b * kChannels + kError];
    });
    const auto at = [&](size_t k, const char* name) {
        return Sample{int(order[k] % size_t(level.width)), int(order[k] / size_t(level.width)), name};
    };
    if (order.size() < 3)
        return {at(0, "texel")};
    return {at(0, "best"), at(order.size() / 2, "median"), at(order.size() - 1, "worst")};
}

class Page {
public:
    Page(const Maps& maps, const ReflectanceMips& mips)
        : source_(maps), averager_(source_.isotropic(), false), mips_(mips), pixels_(discPixels())
    {
    }

    std::string row(size_t l, const Sample& sample)
    {
        gather(l, sample);
        averager_.average(lobes_, members_, false, pixels_);
        const std::vector<float> g(averager_.g()[0], averager_.g()[0] + pixels_.size());
        const float peak = *std::max_element(g.begin(), g.end());
        const Level& level = mips_.levels[l];
        const float* t = level.at(sample.x, sample.y);
        const Shape fit{t[kNx], t[kNy], t[kSxx], t[kSxy], t[kSyy]};
        std::string html = fmt::format("<tr><td>{}<br>({}, {})<br>E = {:.4f}</td>", sample.name, sample.x,
                                       sample.y, t[kError]);
        html += fmt::format("<td>{}</td>", discPicture(g, peak));
        const double ks = luminance({t[kKsR], t[kKsG], t[kKsB]});
        html += fmt::format("<td>{}</td>", lobePicture(fit, float(ks), peak));
        const Moments mean = mean_;
        for (const Shape& shape : {averageShape(mean), toksvigShape(mean), leanShape(mean)})
            html += fmt::format("<td>{}</td>", lobePicture(shape, float(luminance(mean.ks)), peak));
        return html + fmt::format("<td>{}</td></tr>\n", errorMap(g, fit));
    }

private:
    void gather(size_t l, const Sample& sample)
    {
        const Level& level = mips_.levels[l];
        const Footprint fx(sample.x, level.width, source_.width()),
            fy(sample.y, level.height, source_.height());
        const int width = fx.last - fx.first;
        const double area = (fx.end - fx.begin) * (fy.end - fy.begin);
        lobes_.resize(size_t(width) * size_t(fy.last - fy.first));
        members_.clear();
        Moments sum;
        for (int j = fy.first; j < fy.last; ++j) {
            const size_t row = size_t(j - fy.first) * size_t(width);
            source_.read(j, fx.first, fx.last, lobes_, row);
            for (int i = fx.first; i < fx.last; ++i) {
                const uint32_t m = uint32_t(row + size_t(i - fx.first));
                const double share = double(fx.weight(i)) * fy.weight(j) / area;
                members_.push_back({m, float(share)});
                sum.add(lobes_, m, share);
            }
        }
        mean_ = sum.mean();
    }

    // Square roots, so that tails show.
    std::string discPicture(const std::vector<float>& values, float peak) const
    {
        std::vector<float> shown(size_t(kDisc * kDisc));
        for (size_t k = 0; k < shown.size(); ++k)
            shown[k] =
                pixels_.area[k] > 0.0f ? 0.08f + 0.92f * std::sqrt(values[k] / std::max(peak, 1e-9f)) : 0.0f;
        return picture(shown, kDisc, kDisc);
    }

    std::string lobePicture(const Shape& shape, float ks, float peak) const
    {
        const Sym2 p = Sym2{shape.sxx, shape.sxy, shape.syy}.inverse();
        const float nz = std::sqrt(std::max(1e-4f, 1.0f - shape.nx * shape.nx - shape.ny * shape.ny));
        const LobeTerm term{
            shape.nx, shape.ny, nz, float(p.xx), float(p.xy), float(p.yy), ks * float(std::sqrt(p.det()))};
        std::vector<float> values(pixels_.size(), 0.0f);
        const NodeList list{int(pixels_.size()), pixels_.x.data(), pixels_.y.data(), pixels_.z.data(),
                            nullptr};
        kernels().average(&term, 1, false, list, values.data());
        return discPicture(values, peak);
    }

    // log(1 + error) of isotropic lobes at the fitted normal over power (to the right, 1 to 1024,
    // logarithmic) and Ks (up, 0 to twice the mean), with the points where BFGS stood.
    std::string errorMap(const std::vector<float>& g, const Shape& fit) const
    {
        std::vector<float> weight(pixels_.size());
        double energy = 0.0;
        for (size_t k = 0; k < weight.size(); ++k) {
            weight[k] = pixels_.area[k] * g[k];
            energy += double(weight[k]) * g[k];
        }
        FitJob job;
        job.nodes = {int(pixels_.size()), pixels_.x.data(), pixels_.y.data(), pixels_.z.data(),
                     weight.data()};
        job.energy = float(energy);
        std::vector<float> scratch((pixels_.size() * 4 + 64) * kMaxLanes);
        const float highestKs = 2.0f * float(luminance(mean_.ks)) + 1e-9f;
        std::vector<float> values(size_t(kDisc * kDisc));
        const auto overlaps = [&](const Shape& shape, float& overlap, float& norm) {
            toUnknowns(shape, job.maxLog, job.unknowns);
            kernels().evaluate(job, &overlap, &norm, nullptr, scratch.data());
        };
        float overlap = 0.0f, norm = 1.0f;
        for (int i = 0; i < kDisc; ++i) {
            const float s = std::exp2(-10.0f * (float(i) + 0.5f) / kDisc);
            overlaps({fit.nx, fit.ny, s, 0.0f, s}, overlap, norm);
            for (int j = 0; j < kDisc; ++j) {
                const float ks = highestKs * (1.0f - (float(j) + 0.5f) / kDisc);
                const double error =
                    1.0 - 2.0 * double(ks) * overlap / energy + double(ks) * ks * norm / energy;
                values[size_t(j * kDisc + i)] = std::min(1.0f, float(std::log1p(std::max(0.0, error))));
            }
        }
        SearchSettings settings;
        for (int step = 1; step <= 16; ++step) { // where the search stands after `step` evaluations
            toUnknowns(isotropicShape(leanShape(mean_)), job.maxLog, job.unknowns);
            FitJob* pointer = &job;
            settings.maxEvaluations = step;
            kernels().minimise(&pointer, 1, settings, scratch.data());
            const double ks = std::sqrt(std::max(0.0, (1.0 - double(job.error)) * energy / job.norm));
            const double power = kBase + std::exp(2.0 * double(job.unknowns[kL1]));
            const int i = std::clamp(int(std::log2(power) / 10.0 * kDisc), 0, kDisc - 1);
            const int j = std::clamp(int((1.0 - ks / double(highestKs)) * kDisc), 0, kDisc - 1);
            values[size_t(j * kDisc + i)] = 1.0f;
        }
        return picture(values, kDisc, kDisc);
    }

    Source source_;
    Averager averager_;
    const ReflectanceMips& mips_;
    NodeSet pixels_;
    Lobes lobes_;
    std::vector<Member> members_;
    Moments mean_;
};

std::string numbers(const Report& report)
{
    std::string html = "<table><tr><th>level</th>";
    for (const MethodErrors& m : report.levels.front().methods)
        html += fmt::format("<th>{}</th>", m.method);
    html += "</tr>\n";
    for (const LevelReport& level : report.levels) {
        html += fmt::format("<tr><td>{} ({} x {})</td>", level.level, level.width, level.height);
        for (const MethodErrors& m : level.methods)
            html += fmt::format("<td>{:.4f} / {:.4f} / {:.4f}</td>", m.mean, m.p95, m.worst);
        html += "</tr>\n";
    }
    return html + "</table>\n";
}

} // namespace

std::string reportHtml(const Maps& maps, const Options& options, const ReflectanceMips& mips,
                       const Report& report)
{
    std::string html = "<!doctype html><meta charset=utf-8><title>Reflectance MIPs</title>\n"
                       "<style>body{font:14px sans-serif;margin:2em}table{border-collapse:collapse}"
                       "td,th{padding:4px 8px;text-align:left}img{image-rendering:pixelated}</style>\n";
    html +=
        fmt::format("<h1>Fitted reflectance, {}</h1><p>{:.2f} s, at most {:.0f} MiB. Error relative to the "
                    "energy of the exact average: mean / 95th percentile / worst texel.</p>\n",
                    report.model, report.seconds, report.peakMiB);
    if (report.levels.empty())
        return html + "<p>One texel: nothing to fit.</p>\n";
    html += numbers(report);
    Page page(maps, mips);
    for (const LevelReport& entry : report.levels) {
        const size_t l = size_t(entry.level - options.reduce);
        if ((size_t(1) << (2 * entry.level)) > size_t(kMostLobes))
            break;
        html += fmt::format(
            "<h2>Level {}</h2><p>Half vectors on the disc, square root of F. Last: log(1 + error) "
            "over power (right, 1 to 1024) and Ks (up), white dots: the minimiser's path.</p>\n"
            "<table><tr><th></th><th>exact average</th><th>{}</th><th>average</th><th>toksvig</th>"
            "<th>lean</th><th>error</th></tr>\n",
            entry.level, mips.method);
        for (const Sample& sample : chooseSamples(mips.levels[l]))
            html += page.row(l, sample);
        html += "</table>\n";
    }
    return html;
}

} // namespace lumel::baker
