#include "commands.h"
#include "core/compare.h"
#include <fmt/format.h>

namespace lumel {

bool runCompare(const CompareArguments& arguments)
{
    const Image a = readDisplayImage(arguments.a);
    const Image b = readDisplayImage(arguments.b);
    const Comparison result = compareImages(a, b);
    fmt::print("rmse {:.6f}  psnr {:.2f} dB  max {:.4f}  yee {} of {} pixels\n", result.rmse, result.psnr,
               result.maxDifference, result.yeeFailures, size_t(a.width) * a.height);
    if (!arguments.output.empty())
        writeImage(arguments.output, differenceImage(a, b));
    return !arguments.psnrMin || result.psnr >= *arguments.psnrMin;
}

} // namespace lumel
