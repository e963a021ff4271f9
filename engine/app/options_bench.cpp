#include "option_types.h"
#include "options.h"
#include "shared/structs.h"
#include <algorithm>

namespace lumel {
namespace {

// The parts of "a,b,c".
std::vector<std::string> partsOf(const std::string& text, char separator)
{
    std::vector<std::string> parts;
    for (size_t from = 0;;) {
        const size_t to = text.find(separator, from);
        parts.push_back(text.substr(from, to - from));
        if (to == std::string::npos)
            return parts;
        from = to + 1;
    }
}

template<class T>
std::optional<T> numberWithin(const std::string& text, T least, T most)
{
    const auto number = numberFrom<T>(text);
    return number && *number >= least && *number <= most ? number : std::nullopt;
}

// "forward-aniso-average": shading, then optionally aniso, a filter, a number of samples.
std::optional<BenchShading> shadingFrom(const std::string& text)
{
    std::vector<std::string> parts = partsOf(text, '-');
    const auto next = [&parts] { return parts.empty() ? std::string() : parts.front(); };
    const auto shading = valueNamed<Shading>(kShadingNames, next());
    if (!shading)
        return std::nullopt;
    BenchShading way{.name = text, .shading = *shading};
    parts.erase(parts.begin());
    if (way.shading == Shading::forward && next() == "aniso") {
        way.anisotropic = true;
        parts.erase(parts.begin());
    }
    way.filter = valueNamed<baker::Method>(kFilterNames, next());
    if (way.filter)
        parts.erase(parts.begin());
    if (parts.empty())
        return way;
    const auto samples = numberWithin(next(), 1, 65536);
    if (parts.size() > 1 || !samples || way.shading == Shading::tsl || way.anisotropic)
        return std::nullopt;
    way.samples = *samples;
    way.shading = Shading::reference;
    return way;
}

std::optional<LoadStep> loadStepFrom(const std::string& text)
{
    const size_t at = text.find('@');
    if (at == std::string::npos)
        return std::nullopt;
    const auto lights = numberWithin(text.substr(0, at), 1, int(shared::kMaxLights));
    const auto frame = numberWithin(text.substr(at + 1), 0, 1000000);
    return lights && frame ? std::optional(LoadStep{*lights, *frame}) : std::nullopt;
}

// An option whose value is a list of what `parse` makes of the parts between commas.
template<class Value, class Parse>
Option addList(Command& command, const char* name, const std::string& takes, const char* help,
               std::vector<Value>& values, const Parse& parse)
{
    return command.add(name, takes + ",...", help,
                       [&values, parse, takes](const std::string& text) -> std::string {
                           values.clear();
                           for (const std::string& part : partsOf(text, ',')) {
                               const auto value = parse(part);
                               if (!value)
                                   return "write " + takes + ",...";
                               values.push_back(*value);
                           }
                           return "";
                       });
}

void addLists(Command& command, BenchArguments& a)
{
    // Lists in place of one value each; --view would show what is not to be measured.
    for (const char* name : {"--size", "--lights", "--shading", "--view"})
        command.remove(name);
    addList(command, "--shading", "SHADING[-FILTER][-SAMPLES]",
            "ways of shading: tsl, forward, forward-aniso (see --forward-anisotropy) or reference, "
            "with a filter or a number of samples (forward-average, forward-16)",
            a.shadings, shadingFrom)
        .byDefault("tsl");
    addList(command, "--size", "WIDTHxHEIGHT", "sizes of the picture in pixels", a.sizes,
            [](const std::string& text) { return sizeFrom(text, 1, 8192); })
        .byDefault("960x540");
    const Option lights =
        addList(command, "--lights", fmt::format("0..{}", shared::kMaxLights),
                "light the scene by N point and spot lights around it; 0: by its own", a.lightCounts,
                [](const std::string& text) { return numberWithin(text, 0, int(shared::kMaxLights)); })
            .byDefault("0");
    addList(command, "--objects", "0..1048576", "show N of the scene's objects, spread over the file; 0: all",
            a.objectCounts, [](const std::string& text) { return numberWithin(text, 0, 1 << 20); })
        .byDefault("0");
    addList(command, "--load-lights", "LIGHTS@FRAME",
            "lights that change on the way, from frame 0 on: 16@0,64@200,16@400", a.load, loadStepFrom)
        .excludes(lights);
}

void addMeasurement(Command& command, BenchArguments& a)
{
    addNumber(command, "--frames", 1, 100000, "", "frames of each run", a.frames);
    addNumber(command, "--warmup", 0, 100000, "", "frames before the path's start that are not counted",
              a.warmup);
    addNumber(command, "--round", 1, 100000, "", "frames of a run before the next run's turn", a.round);
    command.add("--error-every", "1..100000", "compare every Nth frame with the reference of --samples",
                numberReader<int>(1, 100000, [&a](int count) { a.errorEvery = count; }));
    command.addFlag("--flicker", "compare the change from frame to frame with that of the reference",
                    a.flicker);
    command.addFlag("--floors",
                    "tsl, forward: run the least that each pass could do after every frame, and compare",
                    a.floors);
    addText(command, "--json", "FILE", "write all measurements", a.json);
    addText(command, "--csv", "FILE", "write one line per frame", a.csv);
    addText(command, "--plot", "FILE", "plot time, render scale and lumels over the frames, .png", a.plot);
    command.addSeveral("--compare", 2, "FILE FILE", "ratios of the frame times of two files of --json",
                       [&a](const std::string& file) {
                           a.compare.push_back(file);
                           return "";
                       });
    addNumber(command, "--limit", 1e-6, 1e6, "", "with --compare: exit with 1 when a ratio is larger",
              a.limit);
}

void check(const BenchArguments& a, const Command& command)
{
    checkPath(a.path);
    for (size_t i = 0; i < a.load.size(); ++i)
        if (i == 0 ? a.load[i].frame != 0 : a.load[i].frame <= a.load[i - 1].frame)
            throw UsageError("--load-lights: write rising frames, the first 0");
    if (a.compare.empty())
        return;
    for (const Option& option : command.given())
        if (option.name() != "--compare" && option.name() != "--limit")
            throw UsageError("--compare excludes " + option.name());
}

} // namespace

void addBench(CommandLine& line, BenchArguments& a)
{
    Command command = line.add("bench", "Measure frame times, error and flicker; compare measurements");
    command
        .addRepeated("scenes", "FILE", "glTF 2.0 files",
                     [&a](const std::string& file) {
                         a.scenes.push_back(file);
                         return "";
                     })
        .byDefault("the stress scene");
    a.settings.forwardAnisotropy = 8;
    addSceneOptions(command, a);
    addQuick(command, a);
    addLists(command, a);
    command.get("--forward-anisotropy")
        .describe("maximum anisotropy of forward-aniso's material lookups; the other ways are isotropic");
    a.path.seconds = 0.0; // what the scene animates, moves
    addPathOptions(command, a.path);
    const Option path = command.get("--path").byDefault("animation if the camera is animated, else orbit");
    addMeasurement(command, a);
    command.afterParsing([&a, command, path] {
        a.defaultPath = !path.given();
        check(a, command);
    });
}

} // namespace lumel
