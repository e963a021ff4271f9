#include "fit_kernel.h"
#include <cstdlib>
#include <string_view>

namespace lumel::baker {
namespace {

const Kernels& choose()
{
    const char* asked = std::getenv("LUMEL_SIMD");
    const std::string_view limit = asked ? asked : "";
    if (limit == "scalar")
        return kScalarKernels;
#ifdef LUMEL_X86_KERNELS
    const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
    if (avx512 && limit != "avx2" && limit != "baseline")
        return kAvx512Kernels;
    if (avx2 && limit != "baseline")
        return kAvx2Kernels;
#endif
    return kBaselineKernels;
}

} // namespace

const Kernels& kernels()
{
    static const Kernels& chosen = choose();
    return chosen;
}

} // namespace lumel::baker
