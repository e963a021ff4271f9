#include "cell.h"
#include "fit_kernel.h"

namespace lumel::baker {
namespace {

bool same(const Shape& a, const Shape& b)
{
    return a.nx == b.nx && a.ny == b.ny && a.sxx == b.sxx && a.sxy == b.sxy && a.syy == b.syy;
}

} // namespace

void Patch::reset(const Nodes& newNodes, glm::ivec2 from, glm::ivec2 to, int channels)
{
    nodes = newNodes;
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
    constexpr float kNegligible = 1e-5f; // of the largest sum
    const size_t first = to.size(), count = size();
    float peak = 0.0f;
    for (const float v : g)
        peak = std::max(peak, v);
    to.resize(first + count);
    for (int c = 0; c < channels; ++c)
        sums[c].resize(first + count);
    const auto visible = [&](size_t k) {
        float largest = g[k];
        for (int c = 1; c < channels; ++c)
            largest = std::max(largest, g[size_t(c) * count + k]);
        return largest > kNegligible * peak;
    };
    size_t end = first, k = 0;
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i, ++k) {
            to.x[end] = nodes.rule ? nodes.rule->x[k] : float(x0 + i);
            to.y[end] = nodes.rule ? nodes.rule->y[k] : float(y0 + j);
            if (nodes.rule) {
                to.z[end] = nodes.rule->z[k];
                to.area[end] = nodes.rule->area[k];
            }
            for (int c = 0; c < channels; ++c)
                sums[c][end] = factor * g[size_t(c) * count + k];
            end += visible(k); // kept, or overwritten by the next
        }
    to.resize(end);
    to.pad();
    if (!nodes.rule)
        kernels().toHalfVectors(&to.x[first], &to.y[first], &to.z[first], &to.area[first],
                                int(to.size() - first), nodes.spacing);
    std::fill(to.area.begin() + ptrdiff_t(end), to.area.end(), 0.0f);
    for (int c = 0; c < channels; ++c) {
        sums[c].resize(end);
        sums[c].resize(to.size(), 0.0f);
    }
}

void Cell::clear()
{
    sum = {};
    uniform = true;
    patch.width = patch.height = 0;
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
}

} // namespace lumel::baker
