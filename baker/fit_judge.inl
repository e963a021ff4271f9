// The error of lobes as they are: <G, f> over the nodes of one lobe, a vector at a time, <f, f> for as many
// lobes as there are lanes.

LUMEL_INLINE float overlapWith(const Trial& t)
{
    const float nz2 = 1.0f - t.nx * t.nx - t.ny * t.ny;
    const LobeTerm term{
        t.nx, t.ny, __builtin_sqrtf(nz2 > 1e-4f ? nz2 : 1e-4f), t.pxx, t.pxy, t.pyy, 1.0f};
    const Frame frame = frameOf(term);
    const NodeList& nodes = t.nodes;
    const bool isotropic = t.pxy == 0.0f && t.pxx == t.pyy;
    V sum{};
    for (int k = 0; k < nodes.count; k += W) {
        const V hx = load(nodes.x + k), hy = load(nodes.y + k), hz = load(nodes.z + k);
        const V f = isotropic ? isotropicShape(term, hx, hy, hz) : anisotropicShape(frame, term, hx, hy, hz);
        sum += load(nodes.weight + k) * f;
    }
    float total = 0.0f;
    for (int i = 0; i < W; ++i)
        total += sum[i];
    return total;
}

void judge(Trial* trials, int count)
{
    const FlushToZero flush;
    for (int first = 0; first < count; first += W) {
        const int lanes = count - first < W ? count - first : W;
        Trial* const t = trials + first;
        V nx{}, ny{}, energy = splat(1.0f), maxLog = splat(10.0f);
        Sums sum{};
        I busy{};
        Lobe lobe = makeLobe(maxLog, nx, ny, V{}, V{}, V{}); // idle lanes
        lobe.pxy = V{};
        lobe.pxx = lobe.pyy = splat(1.0f);
        for (int i = 0; i < lanes; ++i) {
            nx[i] = t[i].nx;
            ny[i] = t[i].ny;
            energy[i] = t[i].energy;
            lobe.pxx[i] = t[i].pxx;
            lobe.pxy[i] = t[i].pxy;
            lobe.pyy[i] = t[i].pyy;
            sum.one[i] = overlapWith(t[i]);
            busy[i] = -1;
        }
        lobe.frame = makeFrame(nx, ny);
        lobe.det = lobe.pxx * lobe.pyy - lobe.pxy * lobe.pxy;
        lobe.detPlus = lobe.det + lobe.pxx + lobe.pyy + 1.0f;
        const Overlap o = overlapOf(lobe, sum, busy);
        const V error = 1.0f - o.gf * o.gf / (energy * o.ff);
        for (int i = 0; i < lanes; ++i) {
            t[i].error = error[i];
            t[i].norm = o.ff[i];
        }
    }
}
