#include "commands.h"
#include "core/compare.h"
#include "core/error.h"
#include <fmt/format.h>

namespace lumel {

bool runCompare(const CompareArguments& arguments)
{
    const Image a = readDisplayImage(arguments.a);
    const Image b = readDisplayImage(arguments.b);
    if (a.width != b.width || a.height != b.height)
        throw Error(fmt::format("{}: {} x {} pixels, but {} has {} x {}; render both with the same --size",
                                arguments.a.string(), a.width, a.height, arguments.b.string(), b.width,
                                b.height));
    const Comparison result = compareImages(a, b);
    fmt::print("rmse {:.6f}  psnr {:.2f} dB  max {:.4f}  yee {} of {} pixels\n", result.rmse, result.psnr,
               result.maxDifference, result.yeeFailures, size_t(a.width) * a.height);
    if (!arguments.output.empty())
        writeImage(arguments.output, differenceImage(a, b));
    return !arguments.psnrMin || result.psnr >= *arguments.psnrMin;
}

} // namespace lumel
