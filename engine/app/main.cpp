// The commands: options in, then the steps in order. Exit code 0 done, 1 bad input or failure, 2 usage.
#include "core/decoder_process.h"
#include "core/error.h"
#include "core/log.h"
#include "core/progress.h"
#include "options.h"

namespace {

using namespace lumel;

int run(int argc, char** argv)
{
    CLI::App app("lumel: texture-space lighting with fitted reflectance MIPs");
    app.name("lumel");
    app.require_subcommand(1);
    app.set_version_flag("--version", LUMEL_VERSION);
    BakeArguments bake;
    ShotArguments shot;
    ViewArguments view;
    CompareArguments compare;
    BenchArguments bench;
    addBake(app, bake);
    addShot(app, shot);
    addView(app, view);
    addCompare(app, compare);
    addBench(app, bench);
    app.add_subcommand("help", "Show this help");
    const std::string help = app.help(); // after parsing, CLI11 would print the subcommand's own
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0)
            return app.exit(e); // --help, --version
        std::fprintf(stderr, "lumel: %s; see lumel --help\n", e.what());
        return 2;
    }
    if (app.got_subcommand("help"))
        std::fputs(help.c_str(), stdout);
    if (app.got_subcommand("bake"))
        runBake(bake);
    if (app.got_subcommand("shot"))
        runShot(shot);
    if (app.got_subcommand("bench"))
        return runBench(bench) ? 0 : 1;
    if (app.got_subcommand("view"))
        runView(view);
    if (app.got_subcommand("compare"))
        return runCompare(compare) ? 0 : 1;
    return 0;
}

} // namespace

int main(int argc, char** argv)
{
    setUpLog("info");
    catchInterrupts();
    try {
        const DecoderProcess decoder; // before any thread
        return run(argc, argv);
    } catch (const Interrupted&) {
        std::fputs("lumel: interrupted; nothing unfinished was written\n", stderr);
        return 130;
    } catch (const std::bad_alloc&) {
        std::fputs("lumel: out of memory; use smaller maps or a smaller --size\n", stderr);
        return 1;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "lumel: %s\n", e.what());
        return 1;
    }
}
