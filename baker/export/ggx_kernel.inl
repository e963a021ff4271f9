// Included by the ggx_*.cpp files, which define LUMEL_LANES and LUMEL_GGX.
#include "ggx_kernel.h"

namespace lumel::baker {
namespace {
#include "baker/fit_simd.inl"

constexpr float kInversePi = 0.318309886f;
// Radiance is about this times F0 D: 1 / (4 n.v) of a view that is not grazing, under a light of
// irradiance 1.
constexpr float kSpecularShare = 0.3f;

LUMEL_INLINE V positive(V a)
{
    return maximum(a, V{});
}

// Like tone mapping and the sRGB curve: near a square root, and ever less of a difference above white.
LUMEL_INLINE V shownOf(V radiance)
{
    return squareRoot(radiance / (radiance + 1.0f));
}

LUMEL_INLINE V lit(const GgxNodeArrays& nodes, const float* diffuse, int i)
{
    const V d = diffuse[0] * load(nodes.light[0] + i) + diffuse[1] * load(nodes.light[1] + i) +
                diffuse[2] * load(nodes.light[2] + i);
    return positive(d * kInversePi);
}

void place(const GgxDraws& d, GgxNodeArrays& nodes)
{
    for (int i = 0; i < 2 * kGgxPart; i += W) {
        const V nx = load(d.normal[0] + i), ny = load(d.normal[1] + i), nz = load(d.normal[2] + i);
        const V tx = load(d.tangent[0] + i), ty = load(d.tangent[1] + i), tz = load(d.tangent[2] + i);
        const V t = load(d.alphaT + i) * load(d.slopeT + i), b = load(d.alphaB + i) * load(d.slopeB + i);
        V x = nx + t * tx + b * (ny * tz - nz * ty);
        V y = ny + t * ty + b * (nz * tx - nx * tz);
        V z = nz + t * tz + b * (nx * ty - ny * tx);
        const V scale = 1.0f / squareRoot(x * x + y * y + z * z);
        x *= scale;
        y *= scale;
        z *= scale;
        const V products[] = {x * x, y * y, z * z, x * y, x * z, y * z};
        for (int p = 0; p < 6; ++p)
            store(nodes.products[p] + i, products[p]);
        store(nodes.h[0] + i, x);
        store(nodes.h[1] + i, y);
        store(nodes.h[2] + i, z);
        store(nodes.inverseZ + i, 1.0f / maximum(z, splat(1e-3f)));
    }
}

struct Node {
    V products[6], h[3];
};

LUMEL_INLINE Node nodeAt(const GgxNodeArrays& nodes, int i)
{
    Node n;
    for (int p = 0; p < 6; ++p)
        n.products[p] = load(nodes.products[p] + i);
    for (int c = 0; c < 3; ++c)
        n.h[c] = load(nodes.h[c] + i);
    return n;
}

// D(h); `cosine` gets n.h.
LUMEL_INLINE V density(const Node& n, const GgxTerm& t, V& cosine)
{
    const V q = t.form[0] * n.products[0] + t.form[1] * n.products[1] + t.form[2] * n.products[2] +
                t.form[3] * n.products[3] + t.form[4] * n.products[4] + t.form[5] * n.products[5];
    cosine = t.normal[0] * n.h[0] + t.normal[1] * n.h[1] + t.normal[2] * n.h[2];
    const V value = t.scale / (q * q);
    return cosine > 0.0f ? value : V{};
}

void add(const GgxNodeArrays& nodes, const GgxTerm* terms, int count, float* values, float* densities)
{
    for (int i = 0; i < kGgxNodes; i += W) {
        const Node n = nodeAt(nodes, i);
        V sum{}, across{};
        for (int t = 0; t < count; ++t) {
            V cosine;
            const V value = density(n, terms[t], cosine);
            sum += value;
            across += value * cosine;
        }
        store(values + i, load(values + i) + sum);
        store(densities + i, load(densities + i) + across * load(nodes.inverseZ + i));
    }
}

void display(const GgxNodeArrays& nodes, const float* specular, const float* diffuse, float* shown)
{
    for (int i = 0; i < kGgxNodes; i += W)
        store(shown + i, shownOf(kSpecularShare * load(specular + i) + lit(nodes, diffuse, i)));
}

// Sums of sixteen lanes whatever the vectors' width.
struct Sum {
    static constexpr int kVectors = 16 / W;
    V lanes[kVectors]{};

    LUMEL_INLINE void add(int i, V value) { lanes[i / W % kVectors] += value; }
    LUMEL_INLINE float total() const
    {
        float all[16], sum = 0.0f;
        for (int v = 0; v < kVectors; ++v)
            store(all + v * W, lanes[v]);
        for (const float lane : all)
            sum += lane;
        return sum;
    }
};

float weigh(const GgxNodeArrays& nodes, const float* densities, const float* shown, float* weights)
{
    Sum square;
    for (int i = 0; i < kGgxNodes; i += W) {
        // About as often as lights and views that are spread by their cosines; never below the horizon.
        const V z = positive(load(nodes.h[2] + i)), z2 = z * z;
        const V weight = z2 * z2 / load(densities + i), c = load(shown + i);
        store(weights + i, weight);
        square.add(i, weight * c * c);
    }
    return square.total();
}

float error(const GgxNodeArrays& nodes, const GgxTerm& term, const float* diffuse, const float* shown,
            const float* weights)
{
    Sum sum;
    for (int i = 0; i < kGgxNodes; i += W) {
        V cosine;
        const V specular = density(nodeAt(nodes, i), term, cosine);
        const V difference = load(shown + i) - shownOf(kSpecularShare * specular + lit(nodes, diffuse, i));
        sum.add(i, load(weights + i) * difference * difference);
    }
    return sum.total();
}

} // namespace

extern const GgxKernels LUMEL_GGX;
const GgxKernels LUMEL_GGX = {place, add, display, weigh, error};

} // namespace lumel::baker
