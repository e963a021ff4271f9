// Vectors of LUMEL_LANES floats and the few functions of them that the fit needs. Only GCC's and
// Clang's vector extensions, no intrinsics; and nothing from other headers, because an inline function
// compiled for AVX-512 could be the one the linker keeps for the whole program.

constexpr int W = LUMEL_LANES;
typedef float V __attribute__((vector_size(4 * LUMEL_LANES)));
typedef int I __attribute__((vector_size(4 * LUMEL_LANES)));

#define LUMEL_INLINE inline __attribute__((always_inline))

// While it lives, numbers too small to be normal count as 0. Products of the ends of lobes are such numbers,
// and many processors take over a hundred cycles for an operation with one of them.
class FlushToZero {
#if defined(__x86_64__)
public:
    LUMEL_INLINE FlushToZero() : before_(__builtin_ia32_stmxcsr())
    {
        constexpr unsigned kResults = 0x8000, kOperands = 0x40;
        __builtin_ia32_ldmxcsr(before_ | kResults | kOperands);
    }
    LUMEL_INLINE ~FlushToZero() { __builtin_ia32_ldmxcsr(before_); }
    FlushToZero(const FlushToZero&) = delete;
    FlushToZero& operator=(const FlushToZero&) = delete;

private:
    unsigned before_;
#else
public:
    FlushToZero() {} // most others do not mind
#endif
};

LUMEL_INLINE V splat(float v)
{
    return V{} + v;
}
LUMEL_INLINE V load(const float* p)
{
    V v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
}
LUMEL_INLINE void store(float* p, V v)
{
    __builtin_memcpy(p, &v, sizeof v);
}
LUMEL_INLINE V minimum(V a, V b)
{
    return a < b ? a : b;
}
LUMEL_INLINE V maximum(V a, V b)
{
    return a > b ? a : b;
}
LUMEL_INLINE V magnitude(V a)
{
    return (V)((I)a & 0x7fffffff);
}
LUMEL_INLINE V squareRoot(V a)
{
#if LUMEL_LANES == 1
    return V{__builtin_sqrtf(a[0])};
#else
    V r;
    for (int i = 0; i < W; ++i) // compiles to one instruction
        r[i] = __builtin_sqrtf(a[i]);
    return r;
#endif
}
LUMEL_INLINE bool any(I mask)
{
    int all = 0;
    for (int i = 0; i < W; ++i)
        all |= mask[i];
    return all != 0;
}

typedef float V4 __attribute__((vector_size(16)));
LUMEL_INLINE V4 load4(const float* p)
{
    V4 v;
    __builtin_memcpy(&v, p, sizeof v);
    return v;
}

// Of all lanes.
LUMEL_INLINE float total(V v)
{
    float lanes[W];
    store(lanes, v);
#if LUMEL_LANES == 16
    V4 four = (load4(lanes) + load4(lanes + 8)) + (load4(lanes + 4) + load4(lanes + 12));
#elif LUMEL_LANES == 8
    V4 four = load4(lanes) + load4(lanes + 4);
#elif LUMEL_LANES == 4
    V4 four = v;
#else
    return lanes[0];
#endif
#if LUMEL_LANES > 1
    return (four[0] + four[1]) + (four[2] + four[3]);
#endif
}

// e^x by 2^n times a minimax polynomial of 2^f, |f| <= 1/2; relative error 2e-7 for x in [-80, 80].
LUMEL_INLINE V exponential(V x)
{
    x = minimum(maximum(x, splat(-80.0f)), splat(80.0f));
    const V t = x * 1.44269504f;
    const V shifted = t + 12582912.0f; // 1.5 * 2^23: rounds to an integer kept in the low bits
    const V f = t - (shifted - 12582912.0f);
    V p = splat(1.33908634e-3f);
    p = p * f + 9.67603192e-3f;
    p = p * f + 5.55035671e-2f;
    p = p * f + 2.40221075e-1f;
    p = p * f + 6.93147188e-1f;
    p = p * f + 1.0f;
    return (V)((I)p + ((I)shifted << 23));
}

// T(v) = atanh(sqrt v) / sqrt v by a Chebyshev fit on [0, 1/2] (relative error 7e-7), and its slope.
constexpr float kT[] = {1.0f,         0.333247831f,  0.202671315f, 0.112291695f,
                        0.271921616f, -0.316484862f, 0.513029191f};
LUMEL_INLINE V areaTangent(V v)
{
    V p = splat(kT[6]);
    for (int j = 5; j >= 0; --j)
        p = p * v + kT[j];
    return p;
}
LUMEL_INLINE V areaTangentSlope(V v)
{
    V p = splat(6.0f * kT[6]);
    for (int j = 5; j >= 1; --j)
        p = p * v + float(j) * kT[j];
    return p;
}
