#include "options.h"
#include "shared/structs.h"
#include <charconv>

namespace lumel {
namespace {

// The parts of "a,b,c"; CLI11's own lists would also eat the arguments that follow.
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

bool parseNumber(const std::string& text, int least, int most, int& number)
{
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size() && number >= least && number <= most;
}

BenchShading parseShading(const std::string& text)
{
    const auto wrong = [&] {
        throw CLI::ValidationError("--shading " + text,
                                   "write tsl, forward or reference, then -FILTER, -SAMPLES or both");
    };
    const std::map<std::string, Shading> names = {
        {"tsl", Shading::tsl}, {"forward", Shading::forward}, {"reference", Shading::reference}};
    BenchShading shading;
    shading.name = text;
    std::vector<std::string> parts = partsOf(text, '-');
    if (const auto name = names.find(parts.front()); name != names.end())
        shading.shading = name->second;
    else
        wrong();
    parts.erase(parts.begin());
    if (!parts.empty())
        if (const auto method = kMethods.find(parts.front()); method != kMethods.end()) {
            shading.filter = method->second;
            parts.erase(parts.begin());
        }
    if (parts.empty())
        return shading;
    if (parts.size() > 1 || shading.shading == Shading::tsl ||
        !parseNumber(parts[0], 1, 65536, shading.samples))
        wrong();
    shading.shading = Shading::reference;
    return shading;
}

LoadStep parseLoadStep(const std::string& text)
{
    LoadStep step;
    const size_t at = text.find('@');
    if (at == std::string::npos ||
        !parseNumber(text.substr(0, at), 1, int(shared::kMaxLights), step.lights) ||
        !parseNumber(text.substr(at + 1), 0, 1000000, step.frame))
        throw CLI::ValidationError("--load-lights " + text,
                                   "write LIGHTS@FRAME, from frame 0 on: 16@0,64@200");
    return step;
}

// An option whose value is a list of what `parse` makes of the parts between commas.
template<class Value, class Parse>
CLI::Option* addList(CLI::App* command, const char* name, std::vector<Value>& values, const Parse& parse,
                     const char* what)
{
    return command->add_option_function<std::string>(
        name,
        [&values, parse](const std::string& text) {
            values.clear();
            for (const std::string& part : partsOf(text, ','))
                values.push_back(parse(part));
        },
        what);
}

void addLists(CLI::App* command, BenchArguments& a)
{
    // Lists in place of one value each; --view would show what is not to be measured.
    for (const char* name : {"--size", "--lights", "--shading", "--view"})
        command->remove_option(command->get_option(name));
    addList(command, "--shading", a.shadings, parseShading,
            "list: tsl, forward or reference, with a filter and a number of samples (forward-average, "
            "forward-16)")
        ->default_str("tsl");
    const auto size = [](const std::string& text) {
        glm::uvec2 size;
        if (const auto error = parseSize(text, size); !error.empty())
            throw CLI::ValidationError(error);
        return size;
    };
    addList(command, "--size", a.sizes, size, "list of picture sizes")->default_str("960x540");
    const auto count = [](const char* name, int most) {
        return [=](const std::string& text) {
            int number = 0;
            if (!parseNumber(text, 0, most, number))
                throw CLI::ValidationError(std::string(name) + " " + text,
                                           "write numbers from 0 to " + std::to_string(most));
            return number;
        };
    };
    auto* lights = addList(command, "--lights", a.lightCounts, count("--lights", int(shared::kMaxLights)),
                           "list: light by N point and spot lights around the scene; 0: its own")
                       ->default_str("0");
    addList(command, "--objects", a.objectCounts, count("--objects", 1 << 20),
            "list: show N of the scene's objects, spread over the file; 0: all")
        ->default_str("0");
    addList(command, "--load-lights", a.load, parseLoadStep,
            "load that changes on the way: 16@0,64@200,16@400")
        ->excludes(lights);
}

void check(const BenchArguments& a, const CLI::App* command)
{
    checkPath(a.path);
    for (size_t i = 0; i < a.load.size(); ++i)
        if (i == 0 ? a.load[i].frame != 0 : a.load[i].frame <= a.load[i - 1].frame)
            throw CLI::ValidationError("--load-lights", "name rising frames, the first 0");
    if (a.compare.empty())
        return;
    for (const CLI::Option* option : command->get_options())
        if (option->count() > 0 && option->get_name() != "--compare" && option->get_name() != "--limit")
            throw CLI::ExcludesError("--compare", option->get_name());
}

} // namespace

void addBench(CLI::App& app, BenchArguments& a)
{
    CLI::App* command =
        app.add_subcommand("bench", "Measure frame times, error and flicker; compare measurements");
    command->add_option("scenes", a.scenes, "glTF 2.0 files (the stress scene)");
    addSceneOptions(command, a);
    addLists(command, a);
    a.path.seconds = 0.0; // what the scene animates, moves
    addPathOptions(command, a.path);
    CLI::Option* path = command->get_option("--path");
    path->default_str("animation if the camera is animated, else orbit");
    command->add_option("--frames", a.frames, "frames of each run")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command->add_option("--warmup", a.warmup, "frames before the path's start that are not counted")
        ->check(CLI::Range(0, 100000))
        ->capture_default_str();
    command->add_option("--round", a.round, "frames until the next run's turn")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    command
        ->add_option("--error-every", a.errorEvery, "compare every Nth frame with the reference of --samples")
        ->check(CLI::Range(1, 100000));
    command->add_flag("--flicker", a.flicker, "compare how each frame changes with how the reference does");
    command->add_option("--json", a.json, "write all measurements");
    command->add_option("--csv", a.csv, "write a line a frame");
    command->add_option("--plot", a.plot, "draw time, render scale and lumels over the frames (.png)");
    command->add_option("--compare", a.compare, "ratios of the frame times of two files of --json")
        ->expected(2);
    command->add_option("--limit", a.limit, "with --compare: exit 1 when a ratio is larger")
        ->check(CLI::PositiveNumber);
    command->callback([&a, command, path] {
        a.defaultPath = path->count() == 0;
        check(a, command);
    });
}

} // namespace lumel
