// The average reflectance G of a texel's lobes at its quadrature nodes, a vector of nodes at a time.

LUMEL_INLINE V isotropicShape(const LobeTerm& l, V hx, V hy, V hz)
{
    // |h - N|^2 / 2 = 1 - N.h without cancellation; log c = -2 atanh((1 - c) / (1 + c)).
    const V dx = hx - l.nx, dy = hy - l.ny, dz = hz - l.nz;
    const V t = 0.5f * (dx * dx + dy * dy + dz * dz);
    const V u = t / (2.0f - minimum(t, splat(1.0f)));
    const V f = exponential((-2.0f * l.pxx) * u * areaTangent(u * u));
    return t < 1.0f ? f : V{};
}

LUMEL_INLINE V anisotropicShape(const Frame& frame, const LobeTerm& l, V hx, V hy, V hz)
{
    const Point p = locate(frame, hx, hy, hz);
    const V q = l.pxx * p.a * p.a + (2.0f * l.pxy) * p.a * p.b + l.pyy * p.b * p.b;
    return p.c > 0.0f ? exponential(-q * p.k) : V{};
}

LUMEL_INLINE Frame frameOf(const LobeTerm& l)
{
    Frame frame = makeFrame(splat(l.nx), splat(l.ny));
    frame.nz = splat(l.nz);
    return frame;
}

void average(const LobeTerm* lobes, int count, bool isotropic, const NodeList& nodes, float* g)
{
    const FlushToZero flush;
    for (int i = 0; i < count; ++i) {
        const LobeTerm& l = lobes[i];
        const Frame frame = frameOf(l);
        for (int k = 0; k < nodes.count; k += W) {
            const V hx = load(nodes.x + k), hy = load(nodes.y + k), hz = load(nodes.z + k);
            const V f = isotropic ? isotropicShape(l, hx, hy, hz) : anisotropicShape(frame, l, hx, hy, hz);
            store(g + k, load(g + k) + l.amplitude * f);
        }
    }
}

void shapeOnLattice(const LobeTerm& l, bool isotropic, const float* x, const float* y, int count, float cx,
                    float cy, float spacing, float* f)
{
    const FlushToZero flush;
    const Frame frame = frameOf(l);
    for (int k = 0; k < count; k += W) {
        const V lx = (cx + load(x + k)) * spacing, ly = (cy + load(y + k)) * spacing;
        const V r2 = lx * lx + ly * ly;
        const V scale = squareRoot(maximum(1.0f - 0.25f * r2, splat(0.0f))), hz = 1.0f - 0.5f * r2;
        const V value = isotropic ? isotropicShape(l, lx * scale, ly * scale, hz)
                                  : anisotropicShape(frame, l, lx * scale, ly * scale, hz);
        store(f + k, hz > 1e-3f ? value : V{});
    }
}

void toHalfVectors(float* x, float* y, float* z, float* area, int count, float spacing)
{
    for (int k = 0; k < count; k += W) {
        const V lx = load(x + k) * spacing, ly = load(y + k) * spacing;
        const V r2 = lx * lx + ly * ly;
        const V scale = squareRoot(maximum(1.0f - 0.25f * r2, splat(0.0f))), hz = 1.0f - 0.5f * r2;
        store(x + k, lx * scale);
        store(y + k, ly * scale);
        store(z + k, hz);
        store(area + k, load(area + k) * maximum(spacing * spacing * hz, splat(0.0f)));
    }
}
