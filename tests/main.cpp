// Every test program's: images are decoded as in lumel itself, in processes of their own.
#include "core/decoder_process.h"
#include "decoder_hook.h"
#include <gtest/gtest.h>

int main(int count, char** arguments)
{
    const lumel::DecoderProcess decoder(lumel::test::decoderHook);
    testing::InitGoogleTest(&count, arguments);
    return RUN_ALL_TESTS();
}
