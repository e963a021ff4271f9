#include "report_chart.h"
#include "report_pictures.h"
#include <fmt/format.h>
#include <numeric>

namespace lumel::baker {
namespace {

constexpr double kLeastError = 1e-4; // the chart's floor

// A plot area in SVG units within its margins.
struct Plot {
    double left, top, width, height;
    double x(double t) const { return left + t * width; }
    double y(double t) const { return top + (1.0 - t) * height; }
};

struct Label {
    std::string method;
    double y, mean;
};

// Moves labels apart that would overlap.
void spread(std::vector<Label>& labels, double apart)
{
    std::sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) { return a.y < b.y; });
    for (int pass = 0; pass < 50; ++pass)
        for (size_t i = 1; i < labels.size(); ++i)
            if (const double missing = apart - (labels[i].y - labels[i - 1].y); missing > 0.0) {
                labels[i - 1].y -= 0.5 * missing;
                labels[i].y += 0.5 * missing;
            }
}

std::string gridLines(const Plot& plot, double low, double high, const Measurement& report)
{
    std::string svg;
    for (double decade = low; decade <= high * 1.001; decade *= 10.0)
        for (int i = 1; i < 10 && decade * i <= high * 1.001; ++i) {
            const double y = plot.y(std::log(decade * i / low) / std::log(high / low));
            svg += fmt::format("<path d='M{:.1f} {:.1f}h{:.1f}' class='{}'/>", plot.left, y, plot.width,
                               i == 1 ? "major" : "minor");
            if (i == 1)
                svg += fmt::format("<text x='{:.1f}' y='{:.1f}' class='tick' text-anchor='end'>{:g}</text>",
                                   plot.left - 8, y + 4, decade);
        }
    const size_t count = report.levels.size();
    for (size_t l = 0; l < count; ++l)
        svg += fmt::format("<text x='{:.1f}' y='{:.1f}' class='tick' text-anchor='middle'>{}"
                           "<tspan class='faint' x='{:.1f}' dy='14'>{}²</tspan></text>",
                           plot.x(count > 1 ? double(l) / double(count - 1) : 0.5),
                           plot.top + plot.height + 18, report.levels[l].above,
                           plot.x(count > 1 ? double(l) / double(count - 1) : 0.5), report.levels[l].width);
    return svg;
}

std::string powerTicks(const Plot& plot, const Landscape& land)
{
    std::string svg;
    for (const double decade : {1.0, 10.0, 100.0, 1000.0, 10000.0})
        for (const double step : {1.0, 2.0, 5.0}) {
            const double t =
                std::log(decade * step / land.powerFrom) / std::log(land.powerTo / land.powerFrom);
            if (t < 0.02 || t > 0.98)
                continue;
            svg += fmt::format("<path d='M{:.1f} {:.1f}v4' class='major'/>"
                               "<text x='{:.1f}' y='{:.1f}' class='tick' text-anchor='middle'>{:g}</text>",
                               plot.x(t), plot.top + plot.height, plot.x(t), plot.top + plot.height + 15,
                               decade * step);
        }
    return svg;
}

} // namespace

const char* methodColour(const std::string& label)
{
    const std::string method = label.substr(0, label.find(','));
    if (method == "fit")
        return "#ffc94d";
    if (method == "one lobe")
        return "#e6e6a0";
    if (method == "fit-power")
        return "#ff9f43";
    if (method == "lean")
        return "#4cc9f0";
    if (method == "toksvig")
        return "#b794ff";
    if (method == "average")
        return "#ff7a8a";
    if (method == "height")
        return "#7ddc8a";
    return "#98a3b8";
}

std::string formatError(double error)
{
    if (error < 5e-5)
        return error <= 0.0 ? "0" : "&lt;0.0001";
    if (error < 0.01)
        return fmt::format("{:.4f}", error);
    return error < 10.0 ? fmt::format("{:.3f}", error) : fmt::format("{:.{}f}", error, error < 100.0 ? 1 : 0);
}

std::string errorChart(const Measurement& report)
{
    const Plot plot{64, 16, 1060, 300};
    double low = 1.0, high = 0.01;
    for (const MeasuredLevel& level : report.levels)
        for (const ErrorFigures& e : level.figures) {
            low = std::min(low, std::max(e.mean, kLeastError));
            high = std::max(high, e.mean);
        }
    low = std::pow(10.0, std::floor(std::log10(low)));
    high = std::max(high * 1.15, 10.0 * low);
    std::string svg =
        "<svg class='chart' viewBox='0 0 1260 356' role='img' aria-label='Mean error by level'>" +
        gridLines(plot, low, high, report);
    std::vector<Label> labels;
    for (size_t m = report.methods.size(); m-- > 0;) { // what was baked on top
        std::string line, dots;
        double y = 0.0, mean = 0.0;
        for (size_t l = 0; l < report.levels.size(); ++l) {
            const size_t count = report.levels.size();
            const double x = plot.x(count > 1 ? double(l) / double(count - 1) : 0.5);
            mean = report.levels[l].figures[m].mean;
            y = plot.y(std::log(std::max(mean, low) / low) / std::log(high / low));
            line += fmt::format("{}{:.1f} {:.1f}", l ? "L" : "M", x, y);
            dots += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='{}'/>", x, y, m == 0 ? 4.5 : 3.0);
        }
        const char* colour = methodColour(report.methods[m]);
        svg += fmt::format("<g fill='{0}' stroke='none'><path d='{1}' fill='none' stroke='{0}' "
                           "stroke-width='{2}' stroke-linejoin='round'/>{3}</g>",
                           colour, line, m == 0 ? 3.0 : 1.8, dots);
        labels.push_back({report.methods[m], y, mean});
    }
    spread(labels, 17.0);
    for (const Label& label : labels)
        svg +=
            fmt::format("<text x='{:.1f}' y='{:.1f}' class='label' fill='{}'>{}</text>",
                        plot.left + plot.width + 14, label.y + 4, methodColour(label.method), label.method);
    return svg + "</svg>";
}

std::string landscapeChart(const Landscape& land, const StoredLobe& fit)
{
    if (land.logError.empty())
        return "<div class='black'>black</div>";
    const Plot plot{30, 4, 240, 160};
    const auto px = [&](double power) {
        return plot.x(std::log(power / land.powerFrom) / std::log(land.powerTo / land.powerFrom));
    };
    const auto py = [&](double ks) { return plot.y(ks / land.ksTo); };
    std::string svg = fmt::format("<svg class='land' viewBox='0 0 276 196' role='img'>"
                                  "<image x='{}' y='{}' width='{}' height='{}' href='{}'/>",
                                  plot.left, plot.top, plot.width, plot.height, landscapePicture(land));
    svg += powerTicks(plot, land);
    svg += fmt::format("<text x='{}' y='194' class='tick' text-anchor='middle'>power</text>", plot.x(0.5));
    for (const double t : {0.25, 0.5, 0.75})
        svg += fmt::format("<path d='M{:.1f} {:.1f}h-4' class='major'/>", plot.left, plot.y(t));
    svg += fmt::format("<text transform='translate(11 {:.1f}) rotate(-90)' class='tick' text-anchor='middle'>"
                       "Ks, 0 to {:.2g}</text>",
                       plot.y(0.5), land.ksTo);
    std::string line, dots;
    for (const Landscape::Step& step : land.path) {
        line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", px(step.power), py(step.ks));
        dots += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='2'/>", px(step.power), py(step.ks));
    }
    if (!land.path.empty()) {
        const Landscape::Step& first = land.path.front();
        svg += fmt::format("<path d='{0}' class='halo'/><path d='{0}' class='path'/><g class='dots'>{1}</g>"
                           "<circle cx='{2:.1f}' cy='{3:.1f}' r='4.5' class='start'/>",
                           line, dots, px(first.power), py(first.ks));
    }
    const double power = scalarPower(fit.shape);
    svg += fmt::format("<path d='M{0:.1f} {1:.1f}m-6 0h12m-6 -6v12' class='halo'/>"
                       "<path d='M{0:.1f} {1:.1f}m-6 0h12m-6 -6v12' class='goal'/>",
                       px(power), py(fit.ks));
    return svg + "</svg>";
}

} // namespace lumel::baker
