#include "quality.h"
#include <cassert>
#include <cmath>

namespace lumel::bench {

double rmseOf(const Image& a, const Image& b)
{
    assert(a.pixels.size() == b.pixels.size());
    double sum = 0.0;
    for (size_t i = 0; i < a.pixels.size(); ++i) {
        const double difference = double(a.pixels[i]) - double(b.pixels[i]);
        sum += difference * difference;
    }
    return std::sqrt(sum / double(a.pixels.size()));
}

double flickerOf(const Image& before, const Image& now, const Image& referenceBefore,
                 const Image& referenceNow)
{
    assert(before.pixels.size() == now.pixels.size());
    double sum = 0.0;
    for (size_t i = 0; i < now.pixels.size(); ++i) {
        const double change = double(now.pixels[i]) - double(before.pixels[i]);
        const double wanted = double(referenceNow.pixels[i]) - double(referenceBefore.pixels[i]);
        sum += (change - wanted) * (change - wanted);
    }
    return std::sqrt(sum / double(now.pixels.size()));
}

} // namespace lumel::bench
