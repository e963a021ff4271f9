// Every test program's: images are decoded as in lumel itself, in processes of their own.
#include "core/decoder_process.h"
#include "decoder_hook.h"
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>

namespace {

// Tests run lumel with an empty cache folder each. Mesa's compiled shaders stay in the user's: compiling them
// is most of a small picture's time.
void shareCompiledShaders()
{
    const char* const cache = std::getenv("XDG_CACHE_HOME");
    const char* const home = std::getenv("HOME");
    if (cache || home)
        setenv("MESA_SHADER_CACHE_DIR", cache ? cache : (std::filesystem::path(home) / ".cache").c_str(), 0);
}

} // namespace

int main(int count, char** arguments)
{
    shareCompiledShaders();
    const lumel::DecoderProcess decoder(lumel::test::decoderHook);
    testing::InitGoogleTest(&count, arguments);
    return RUN_ALL_TESTS();
}
