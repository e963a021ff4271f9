// The report as one page without outside files: figures, chart, table, then the texels to look at.
#include "report.h"
#include "report_chart.h"
#include "report_pictures.h"
#include <fmt/format.h>

namespace lumel::baker {
namespace {

constexpr const char* kStyle = R"(
:root{color-scheme:dark}
*{box-sizing:border-box}
body{margin:0;background:#0e1016;color:#d7dce6;font:15px/1.5 "Inter","Segoe UI","DejaVu Sans",system-ui,sans-serif}
main{max-width:1340px;margin:0 auto;padding:36px 32px 64px}
h1{font-size:27px;font-weight:600;margin:0;color:#fff;overflow-wrap:anywhere}
h2{font-size:18px;font-weight:600;margin:44px 0 6px;color:#fff}
p{margin:4px 0 14px;color:#98a3b8;max-width:1000px}
.cards{display:flex;flex-wrap:wrap;gap:10px;margin:22px 0 8px}
.card{background:#171a23;border:1px solid #242936;border-radius:10px;padding:11px 13px 12px;flex:none}
.card b{display:block;font-size:19px;font-weight:600;color:#fff;font-variant-numeric:tabular-nums}
.card span{color:#98a3b8;font-size:12.5px;white-space:nowrap}
.panel{background:#141720;border:1px solid #242936;border-radius:12px;padding:18px}
svg{display:block;width:100%;height:auto}
svg text{font-family:inherit}
.tick{fill:#98a3b8;font-size:12px}.faint{fill:#5d6678;font-size:11px}.label{font-size:14px;font-weight:600}
.major{stroke:#333a4a;fill:none}.minor{stroke:#1d212c;fill:none}
table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}
th,td{padding:6px 12px;text-align:right;border-bottom:1px solid #202532;white-space:nowrap}
th{font-weight:600;border-bottom-color:#333a4a}
th:first-child,td:first-child,th:nth-child(2),td:nth-child(2){text-align:left}
td b{font-weight:600;font-size:15px;color:#e9edf5}td small{display:block;color:#7b8599;font-size:12px}
td.first b{color:#ffc94d}
.level{margin-top:18px}
.level h3{margin:0 0 10px;font-size:16px;color:#fff;font-weight:600}
.level h3 span{color:#98a3b8;font-weight:400;font-size:14px;margin-left:8px}
.row{display:grid;gap:10px;align-items:start;padding:12px 0;border-top:1px solid #202532}
.row:first-of-type{border-top:0;padding-top:0}
.who{font-size:13px;color:#98a3b8;padding-top:2px}.who b{display:block;color:#fff;font-size:15px}
figure{margin:0;text-align:center}
figure img{display:block;width:100%;border-radius:6px}
figcaption{font-size:12.5px;margin-top:4px;line-height:1.35;color:#98a3b8}
figcaption b{display:block;font-size:14px;color:#e9edf5;font-variant-numeric:tabular-nums;font-weight:600}
.land .tick{font-size:11px}
.halo{fill:none;stroke:#000;stroke-width:4.5;stroke-opacity:.6;stroke-linejoin:round;stroke-linecap:round}
.path{fill:none;stroke:#fff;stroke-width:1.8;stroke-linejoin:round}
.dots circle{fill:#fff}.start{fill:#0e1016;stroke:#fff;stroke-width:2}
.goal{fill:none;stroke:#ff4d6d;stroke-width:2.4;stroke-linecap:round}
.black{color:#5d6678;padding:40px 0;text-align:center}
.scale{display:flex;gap:12px;align-items:center;font-size:13px;color:#98a3b8;margin:6px 0 2px}
.scale div{position:relative;width:360px;height:14px}.scale img{width:360px;height:14px;border-radius:4px;display:block}
.ticks{position:relative;height:16px;width:360px}
.ticks span{position:absolute;transform:translateX(-50%);font-size:12px}
footer{margin-top:40px;color:#5d6678;font-size:12.5px;overflow-wrap:anywhere}
)";

std::string escaped(const std::string& text)
{
    std::string html;
    for (const char c : text)
        switch (c) {
        case '<':
            html += "&lt;";
            break;
        case '>':
            html += "&gt;";
            break;
        case '&':
            html += "&amp;";
            break;
        case '"':
            html += "&quot;";
            break;
        default:
            html += c;
        }
    return html;
}

std::string card(const std::string& value, const std::string& what)
{
    return fmt::format("<div class='card'><b>{}</b><span>{}</span></div>", value, what);
}

std::string cards(const Report& report)
{
    const Measurement& m = report.measured;
    std::string html = "<div class='cards'>";
    html += card(fmt::format("{} × {}", m.width, m.height), "texels in");
    html += card(m.methods.front(), escaped(report.model));
    html += card(fmt::format("{:.{}f} s", report.seconds, report.seconds < 10.0 ? 2 : 1),
                 fmt::format("bake, {} thread{}", m.threads, m.threads == 1 ? "" : "s"));
    html += card(fmt::format("{:.0f} MiB", report.peakMiB), "peak memory");
    // The levels' mean errors added up, against each closed form's.
    std::vector<double> sums(m.methods.size());
    for (const MeasuredLevel& level : m.levels)
        for (size_t i = 0; i < sums.size(); ++i)
            sums[i] += level.figures[i].mean;
    html += card(formatError(sums[0]), "mean errors, all levels");
    for (size_t i = 1; i < sums.size(); ++i)
        if (sums[i] > 0.0)
            html += card(fmt::format("{:.2f} ×", sums[0] / sums[i]),
                         fmt::format("the error of <span style='color:{}'>{}</span>",
                                     methodColour(m.methods[i]), m.methods[i]));
    return html + "</div>";
}

// Of the specular or of the diffuse term.
std::string table(const Measurement& report, const std::vector<ErrorFigures> MeasuredLevel::*figures)
{
    std::string html = "<div class='panel'><table><tr><th>Level</th><th>Size</th>";
    for (const std::string& method : report.methods)
        html += fmt::format("<th style='color:{}'>{}</th>", methodColour(method), method);
    html += "</tr>";
    for (const MeasuredLevel& level : report.levels) {
        html += fmt::format("<tr><td><b>{}</b></td><td>{} × {}<small>{} measured</small></td>", level.above,
                            level.width, level.height, level.sample.size());
        for (size_t m = 0; m < (level.*figures).size(); ++m) {
            const ErrorFigures& e = (level.*figures)[m];
            html += fmt::format("<td{}><b>{}</b><small>{} · {}</small></td>", m == 0 ? " class='first'" : "",
                                formatError(e.mean), formatError(e.p95), formatError(e.worst));
        }
        html += "</tr>";
    }
    return html + "</table></div>";
}

// The fits for box and for bilinear reconstruction, looked up between texels.
std::string lookups(const Report& report)
{
    std::string rows;
    for (const LevelReport& level : report.levels)
        if (level.boxLookup >= 0.0)
            rows +=
                fmt::format("<tr><td><b>{}</b></td><td>{} × {}</td><td><b>{}</b></td><td><b>{}</b></td></tr>",
                            level.level, level.width, level.height, formatError(level.boxLookup),
                            formatError(level.bilinearLookup));
    if (rows.empty())
        return "";
    return "<h2>Between texels</h2><p>Mean E of bilinear lookups between texel centres, in the chain fitted "
           "for "
           "the box under a texel and in the one fitted for bilinear reconstruction.</p><div class='panel'>"
           "<table><tr><th>Level</th><th>Size</th><th>box</th><th>bilinear</th></tr>" +
           rows + "</table></div>";
}

std::string figure(const std::string& picture, const std::string& name, const std::string& colour,
                   const std::string& below)
{
    return fmt::format("<figure><img alt='{0}' src='{1}'><figcaption><span style='color:{2}'>{0}</span>"
                       "<b>{3}</b></figcaption></figure>",
                       name, picture, colour, below);
}

std::string row(const Measurement& report, const Exhibit& exhibit)
{
    const View view = viewOf(*report.grid, exhibit);
    const Shape& fit = exhibit.texel.lobes.front().shape;
    const double degrees = std::asin(std::min(1.0, std::hypot(double(fit.nx), double(fit.ny)))) * 57.29578;
    std::string html = fmt::format(
        "<div class='row' style='grid-template-columns:104px repeat({},minmax(0,1fr)) 276px'>"
        "<div class='who'><b>{}</b>texel {}, {}<br>power {:.0f}<br>tilt {:.1f}°<br>shown: {:.0f} %<br>of the "
        "width</div>",
        report.methods.size() + 1, exhibit.rank, exhibit.texel.x, exhibit.texel.y, scalarPower(fit), degrees,
        100.0 * std::min(1.0, view.half));
    html += figure(averagePicture(*report.grid, exhibit.average, view), "exact average", "#fff", "");
    for (size_t m = 0; m < report.methods.size(); ++m)
        html += figure(lobePicture(exhibit.texel.lobes[m], view), report.methods[m],
                       methodColour(report.methods[m]), formatError(exhibit.texel.lobes[m].error));
    html += "<figure>" + landscapeChart(exhibit.landscape, exhibit.texel.lobes[report.oneLobe]);
    if (!exhibit.landscape.path.empty())
        html += fmt::format("<figcaption>{} steps from {}</figcaption>", exhibit.landscape.path.size() - 1,
                            exhibit.landscape.start);
    return html + "</figure></div>";
}

std::string legend()
{
    std::string html =
        "<div class='scale'><div>" + fmt::format("<img alt='' src='{}'>", scalePicture()) +
        "</div>reflectance, relative to the peak of the exact average</div><div class='ticks'>";
    for (const double value : {0.0, 0.01, 0.05, 0.2, 0.5, 1.0, kScaleEnd})
        html += fmt::format("<span style='left:{:.1f}%'>{:g}</span>",
                            100.0 * scalePosition(value) / scalePosition(kScaleEnd), value);
    return html + "</div>";
}

// The largest difference between the means that the baker states and the measured ones, on levels where
// both are of all texels.
double statedDifference(const Report& report)
{
    double most = 0.0;
    for (size_t l = 0; l < report.levels.size(); ++l) {
        const MeasuredLevel& measured = report.measured.levels[l];
        if (measured.sample.size() == size_t(measured.width) * size_t(measured.height))
            most = std::max(most, std::abs(report.levels[l].methods[0].mean - measured.figures[0].mean));
    }
    return most;
}

std::string explanation(const Measurement& report)
{
    return fmt::format(
        "E is the integral of (G − F)² over the disc of half vectors divided by that of G²: G the exact "
        "average of the level-0 lobes under a texel, F the lobe that a method stores for it; closed forms "
        "are "
        "given the Ks of least error, by projection of G on their lobe. It is measured by brute "
        "force: all lobes under a texel are summed on a grid of {} × {} points over the disc, {:.2f} "
        "standard deviations of the narrowest lobes apart; on every texel of levels with at most {}, else on "
        "{} at fixed pseudo-random places.",
        report.gridSide, report.gridSide, 2.0 / report.gridSide / report.narrowestDeviation, kReportTexels,
        kReportTexels);
}

} // namespace

std::string reportHtml(const Report& report)
{
    std::string html = fmt::format("<!doctype html><html lang='en'><meta charset='utf-8'>"
                                   "<meta name='viewport' content='width=device-width'>"
                                   "<title>{0}: bake report</title><style>{1}</style><main><h1>{0}</h1>",
                                   escaped(report.name), kStyle);
    html += cards(report);
    html += "<h2>Mean error by level</h2><p>" + explanation(report.measured) + "</p>";
    html += "<div class='panel'>" + errorChart(report.measured) + "</div>";
    html += "<h2>Figures</h2><p>Mean E; below it the 95th percentile and the worst.";
    if (report.measured.box)
        html += " What the baker itself states of what it baked differs from these means by at most " +
                formatError(statedDifference(report)) + " where every texel is measured.";
    html += "</p>" + table(report.measured, &MeasuredLevel::figures);
    html +=
        "<h2>Diffuse</h2><p>The same figures of the diffuse term, Kd (N·l)₊ of a stored texel against the "
        "average of the texels under it, squared and relative, over the hemisphere of lights. Normals that "
        "face away from a light cut their share off; one normal cannot.</p>" +
        table(report.measured, &MeasuredLevel::diffuse) + lookups(report);
    html += "<h2>Texels</h2><p>The best, the median and the worst measured texel of each level by the first "
            "method's error, on the disc of half vectors seen from above (rings at sin θ = ¼, ½, ¾, 1). The "
            "pictures of a row share one scale and one part of the disc. Last: log(1 + E) over power and Ks, "
            "with "
            "the normal and proportions of the fit of one lobe held, a contour at each twentieth; <span "
            "style='color:#ff4d6d'>✚</span> is the fit, the white line the baker's own BFGS search projected "
            "onto this plane, from the ring on: of the first guesses that end at the fit, the worst.</p>" +
            legend();
    for (const MeasuredLevel& level : report.measured.levels) {
        html += fmt::format("<div class='panel level'><h3>Level {}<span>{} × {}</span></h3>", level.above,
                            level.width, level.height);
        for (const Exhibit& exhibit : level.exhibits)
            html += row(report.measured, exhibit);
        html += "</div>";
    }
    return html + fmt::format("<footer>source {}</footer></main></html>\n", escaped(report.source));
}

} // namespace lumel::baker
