// The average reflectance G of a texel's lobes at its quadrature nodes.

void averageIsotropic(const LobeBatch& batch, const NodeBlock& nodes, float* g)
{
    for (int k = 0; k < nodes.count; ++k) {
        const V hx = load(nodes.x + k * W), hy = load(nodes.y + k * W), hz = load(nodes.z + k * W);
        V sum = load(g + k * W);
        for (int i = 0; i < batch.count; ++i) {
            // |h - N|^2 / 2 = 1 - N.h without cancellation; log c = -2 atanh((1 - c) / (1 + c)).
            const V dx = hx - load(batch.nx + i * W);
            const V dy = hy - load(batch.ny + i * W);
            const V dz = hz - load(batch.nz + i * W);
            const V t = 0.5f * (dx * dx + dy * dy + dz * dz);
            const V u = t / (2.0f - minimum(t, splat(1.0f)));
            const V logC = -2.0f * u * areaTangent(u * u);
            const V f = exponential(load(batch.pxx + i * W) * logC);
            sum += t < 1.0f ? load(batch.amplitude + i * W) * f : V{};
        }
        store(g + k * W, sum);
    }
}

void averageAnisotropic(const LobeBatch& batch, const NodeBlock& nodes, float* g)
{
    for (int i = 0; i < batch.count; ++i) {
        Frame f = makeFrame(load(batch.nx + i * W), load(batch.ny + i * W));
        f.nz = load(batch.nz + i * W);
        const V pxx = load(batch.pxx + i * W), pxy = load(batch.pxy + i * W), pyy = load(batch.pyy + i * W);
        const V amplitude = load(batch.amplitude + i * W);
        for (int k = 0; k < nodes.count; ++k) {
            const Point p = locate(f, load(nodes.x + k * W), load(nodes.y + k * W), load(nodes.z + k * W));
            const V q = pxx * p.a * p.a + 2.0f * pxy * p.a * p.b + pyy * p.b * p.b;
            const V value = p.c > 0.0f ? amplitude * exponential(-q * p.k) : V{};
            store(g + k * W, load(g + k * W) + value);
        }
    }
}

void average(const LobeBatch& batch, const NodeBlock& nodes, float* g)
{
    if (batch.isotropic)
        averageIsotropic(batch, nodes, g);
    else
        averageAnisotropic(batch, nodes, g);
}
