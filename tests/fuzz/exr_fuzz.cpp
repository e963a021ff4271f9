// libFuzzer target: any bytes as a baked EXR, which is read completely or throws Error.
#include "baker/bake.h"
#include "core/decoder_process.h"
#include "core/error.h"
#include "fuzz_file.h"

extern "C" int LLVMFuzzerInitialize(int*, char***)
{
    lumel::decodeInThisProcess();
    return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
{
    static lumel::FuzzFile file(".exr");
    try {
        lumel::baker::readExr(file.write(data, size));
    } catch (const lumel::Error&) { // refused
    }
    return 0;
}
