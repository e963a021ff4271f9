// The average reflectance G of a texel's lobes at its quadrature nodes, a vector of nodes at a time.

void averageIsotropic(const LobeTerm* lobes, int count, const NodeList& nodes, float* g)
{
    for (int k = 0; k < nodes.count; k += W) {
        const V hx = load(nodes.x + k), hy = load(nodes.y + k), hz = load(nodes.z + k);
        V sum = load(g + k);
        for (int i = 0; i < count; ++i) {
            const LobeTerm& l = lobes[i];
            // |h - N|^2 / 2 = 1 - N.h without cancellation; log c = -2 atanh((1 - c) / (1 + c)).
            const V dx = hx - l.nx, dy = hy - l.ny, dz = hz - l.nz;
            const V t = 0.5f * (dx * dx + dy * dy + dz * dz);
            const V u = t / (2.0f - minimum(t, splat(1.0f)));
            const V f = exponential((-2.0f * l.pxx) * u * areaTangent(u * u));
            sum += t < 1.0f ? l.amplitude * f : V{};
        }
        store(g + k, sum);
    }
}

void averageAnisotropic(const LobeTerm* lobes, int count, const NodeList& nodes, float* g)
{
    for (int i = 0; i < count; ++i) {
        const LobeTerm& l = lobes[i];
        Frame f = makeFrame(splat(l.nx), splat(l.ny));
        f.nz = splat(l.nz);
        for (int k = 0; k < nodes.count; k += W) {
            const Point p = locate(f, load(nodes.x + k), load(nodes.y + k), load(nodes.z + k));
            const V q = l.pxx * p.a * p.a + (2.0f * l.pxy) * p.a * p.b + l.pyy * p.b * p.b;
            store(g + k, load(g + k) + (p.c > 0.0f ? l.amplitude * exponential(-q * p.k) : V{}));
        }
    }
}

void average(const LobeTerm* lobes, int count, bool isotropic, const NodeList& nodes, float* g)
{
    if (isotropic)
        averageIsotropic(lobes, count, nodes, g);
    else
        averageAnisotropic(lobes, count, nodes, g);
}
