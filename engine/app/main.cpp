// The commands: options in, then the steps in order. Exit code 0 done, 1 bad input or failure, 2 usage.
#include "core/decoder_process.h"
#include "core/error.h"
#include "core/log.h"
#include "core/progress.h"
#include "options.h"

namespace {

using namespace lumel;

int run(const std::vector<std::string>& words)
{
    CommandLine line("lumel", "Texture-space lighting with fitted reflectance MIP levels", LUMEL_VERSION);
    Arguments arguments;
    addCommands(line, arguments);
    const std::string command = line.parse(words);
    if (command == "help")
        std::fputs((arguments.help.markdown ? line.markdown() : line.help(arguments.help.command)).c_str(),
                   stdout);
    if (command == "bake")
        runBake(arguments.bake);
    if (command == "export")
        runExport(arguments.exported);
    if (command == "shot")
        runShot(arguments.shot);
    if (command == "view")
        runView(arguments.view);
    if (command == "bench")
        return runBench(arguments.bench) ? 0 : 1;
    if (command == "compare")
        return runCompare(arguments.compare) ? 0 : 1;
    return 0;
}

} // namespace

int main(int argc, char** argv)
{
    setUpLog("info");
    catchInterrupts();
    try {
        const DecoderProcess decoder; // before any thread
        return run({argv + 1, argv + argc});
    } catch (const UsageError& e) {
        std::fprintf(stderr, "lumel: %s; see lumel --help\n", e.what());
        return 2;
    } catch (const Interrupted&) {
        return sayInterrupted();
    } catch (const std::bad_alloc&) {
        std::fputs("lumel: out of memory; use smaller maps or a smaller --size\n", stderr);
        return 1;
    } catch (const std::exception& e) {
        std::fprintf(stderr, "lumel: %s\n", e.what());
        return 1;
    }
}
