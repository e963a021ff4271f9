#include "cell.h"
#include "fit_kernel.h"

namespace lumel::baker {
namespace {

constexpr float kNegligible = 1e-5f; // of the largest sum of a patch

bool same(const Shape& a, const Shape& b)
{
    return a.nx == b.nx && a.ny == b.ny && a.sxx == b.sxx && a.sxy == b.sxy && a.syy == b.syy;
}

// Of sums, which are not negative.
float largestOf(const float* sums, size_t count)
{
    constexpr size_t kLanes = 8; // side by side, for the compiler to vectorise
    float lanes[kLanes] = {}, largest = 0.0f;
    const size_t whole = count / kLanes * kLanes;
    for (size_t k = 0; k < whole; k += kLanes)
        for (size_t i = 0; i < kLanes; ++i)
            lanes[i] = sums[k + i] > lanes[i] ? sums[k + i] : lanes[i];
    for (size_t k = whole; k < count; ++k)
        largest = std::max(largest, sums[k]);
    return std::max(largest, *std::max_element(lanes, lanes + kLanes));
}

} // namespace

void Patch::reset(const Nodes& newNodes, glm::ivec2 from, glm::ivec2 to, int channels)
{
    nodes = newNodes;
    sublattice = {};
    if (nodes.rule) {
        from = {0, 0};
        to = {int(nodes.rule->size()), 1};
    }
    x0 = from.x;
    y0 = from.y;
    width = to.x - from.x;
    height = to.y - from.y;
    g.assign(size() * size_t(channels), 0.0f);
}

void Patch::add(const Patch& other, float factor, int channels)
{
    if (other.size() == 0)
        return;
    const glm::ivec2 otherEnd(other.x0 + other.width, other.y0 + other.height);
    if (size() == 0)
        reset(other.nodes, {other.x0, other.y0}, otherEnd, channels);
    const glm::ivec2 from = glm::min(glm::ivec2(x0, y0), glm::ivec2(other.x0, other.y0));
    const glm::ivec2 to = glm::max(glm::ivec2(x0 + width, y0 + height), otherEnd);
    if (from.x < x0 || from.y < y0 || to.x > x0 + width || to.y > y0 + height) {
        Patch grown;
        grown.reset(nodes, from, to, channels);
        grown.add(*this, 1.0f, channels);
        *this = std::move(grown);
    }
    for (int c = 0; c < channels; ++c)
        for (int j = 0; j < other.height; ++j) {
            const float* source = &other.g[size_t(c) * other.size() + size_t(j) * size_t(other.width)];
            float* row =
                &g[size_t(c) * size() + size_t(other.y0 - y0 + j) * size_t(width) + size_t(other.x0 - x0)];
            for (int i = 0; i < other.width; ++i)
                row[i] += factor * source[i];
        }
}

void Patch::appendTo(NodeSet& to, std::vector<float>* sums, float factor, int channels) const
{
    constexpr size_t kFew = 300; // points that are not worth merging
    const size_t first = to.size(), count = size();
    const float peak = largestOf(g.data(), count);
    to.resize(first + count);
    for (int c = 0; c < channels; ++c)
        sums[c].resize(first + count);
    const bool merges = !nodes.rule && count > kFew;
    const size_t end = merges ? appendMerged(to, sums, first, peak, channels)
                              : appendBlock(to, sums, first, peak, {0, 0, width, height}, channels);
    to.resize(end);
    to.pad();
    if (nodes.rule)
        for (size_t i = first; i < end; ++i) {
            const size_t k = size_t(to.x[i]);
            to.x[i] = nodes.rule->x[k];
            to.y[i] = nodes.rule->y[k];
            to.z[i] = nodes.rule->z[k];
            to.area[i] = nodes.rule->area[k];
        }
    else
        kernels().toHalfVectors(&to.x[first], &to.y[first], &to.z[first], &to.area[first],
                                int(to.size() - first), nodes.spacing);
    for (int c = 0; c < channels; ++c) {
        sums[c].resize(end);
        sums[c].resize(to.size(), 0.0f);
        for (size_t k = first; k < end; ++k)
            sums[c][k] *= factor;
    }
}

// The visible points of a block, from `end` on; returns the new end. A sublattice's stand for `step` points
// each.
size_t Patch::appendBlock(NodeSet& to, std::vector<float>* sums, size_t end, float peak, const Block& block,
                          int channels) const
{
    const float least = kNegligible * peak;
    if (channels == 1 && sublattice.step == 1) { // most maps: one test per point
        float *x = to.x.data(), *y = to.y.data(), *area = to.area.data(), *sum = sums[0].data();
        for (int j = block.y0; j < block.y1; ++j) {
            const float* row = g.data() + size_t(j) * size_t(width);
            for (int i = block.x0; i < block.x1; ++i) {
                x[end] = float(x0 + i);
                y[end] = float(y0 + j);
                area[end] = 1.0f;
                sum[end] = row[i];
                end += row[i] > least;
            }
        }
        return end;
    }
    for (int j = block.y0; j < block.y1; ++j) {
        const Sublattice::Row& row = sublattice.row(y0 + j);
        for (int i = row.from(x0 + block.x0) - x0; row.stride > 0 && i < block.x1; i += row.stride) {
            to.x[end] = float(x0 + i);
            to.y[end] = float(y0 + j);
            to.area[end] = float(sublattice.step);
            float largest = 0.0f;
            for (int c = 0; c < channels; ++c) {
                sums[c][end] = g[size_t(c) * size() + size_t(j) * size_t(width) + size_t(i)];
                largest = std::max(largest, sums[c][end]);
            }
            end += largest > least; // kept, or overwritten by the next
        }
    }
    return end;
}

// Where the sums are faint beside their peak, as under a broad lobe beside a sharp one, a block of lattice
// points stands as one node in their weighted middle: nothing varies there as fast as the lattice resolves.
size_t Patch::appendMerged(NodeSet& to, std::vector<float>* sums, size_t end, float peak, int channels) const
{
    constexpr float kFaint = 1e-2f; // of the largest sum
    constexpr int kSide = 4;
    for (int j0 = 0; j0 < height; j0 += kSide)
        for (int i0 = 0; i0 < width; i0 += kSide) {
            const Block block{i0, j0, std::min(i0 + kSide, width), std::min(j0 + kSide, height)};
            float largest = 0.0f, total[3] = {}, x = 0.0f, y = 0.0f;
            int points = 0;
            for (int c = 0; c < channels; ++c)
                for (int j = block.y0; j < block.y1; ++j) {
                    const Sublattice::Row& row = sublattice.row(y0 + j);
                    for (int i = row.from(x0 + i0) - x0; row.stride > 0 && i < block.x1; i += row.stride) {
                        points += c == 0;
                        const float v = g[size_t(c) * size() + size_t(j) * size_t(width) + size_t(i)];
                        largest = std::max(largest, v);
                        total[c] += v;
                        x += v * float(i);
                        y += v * float(j);
                    }
                }
            if (largest <= kNegligible * peak)
                continue;
            if (largest > kFaint * peak) {
                end = appendBlock(to, sums, end, peak, block, channels);
                continue;
            }
            const float sum = total[0] + total[1] + total[2];
            to.x[end] = float(x0) + x / sum;
            to.y[end] = float(y0) + y / sum;
            to.area[end] = float((block.x1 - i0) * (block.y1 - j0));
            for (int c = 0; c < channels; ++c)
                sums[c][end] = total[c] / float(points);
            ++end;
        }
    return end;
}

void Cell::clear()
{
    sum = {};
    uniform = true;
    patch.width = patch.height = 0;
    list.clear();
}

void Cell::add(const Lobes& lobes, size_t m, double area)
{
    const Shape lobe{lobes.nx[m], lobes.ny[m], lobes.sxx[m], lobes.sxy[m], lobes.syy[m]};
    uniform = uniform && (sum.weight == 0.0 || same(shape, lobe));
    shape = lobe;
    sum.add(lobes, m, area);
}

void Cell::merge(const Cell& other, double factor, int channels)
{
    uniform = other.uniform && (sum.weight == 0.0 || (uniform && same(shape, other.shape)));
    shape = other.shape;
    sum.add(other.sum, factor);
    patch.add(other.patch, float(factor), channels);
    list.append(other.list, float(factor));
}

void Cell::shortenList()
{
    if (list.empty())
        return;
    if (uniform)
        list.merge(shape);
    else
        list.reduce();
}

} // namespace lumel::baker
