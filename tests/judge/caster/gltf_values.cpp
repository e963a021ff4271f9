#include "gltf_values.h"
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace lumel::judge {
namespace {

// glTF 2.0, section 3.6.2.2: an integer type's fraction is the integer over its greatest value, -1 at the
// least.
template<class T>
double number(const unsigned char* from, bool normalized)
{
    T value;
    std::memcpy(&value, from, sizeof(T));
    if (!normalized)
        return double(value);
    return std::max(double(value) / double(std::numeric_limits<T>::max()), -1.0);
}

double number(const unsigned char* from, int type, bool normalized)
{
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return number<int8_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return number<uint8_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return number<int16_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return number<uint16_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return number<uint32_t>(from, normalized);
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return number<float>(from, false);
    default:
        throw std::runtime_error("the judge does not know this component type");
    }
}

std::vector<double> slerp(std::vector<double> a, const std::vector<double>& b, double t)
{
    double cosine = 0.0;
    for (size_t i = 0; i < 4; ++i)
        cosine += a[i] * b[i];
    const double sign = cosine < 0.0 ? -1.0 : 1.0; // the shorter way round
    const double angle = std::acos(std::min(std::abs(cosine), 1.0)), sine = std::sin(angle);
    const double wa = sine > 1e-9 ? std::sin((1.0 - t) * angle) / sine : 1.0 - t;
    const double wb = sine > 1e-9 ? std::sin(t * angle) / sine : t;
    for (size_t i = 0; i < 4; ++i)
        a[i] = wa * a[i] + sign * wb * b[i];
    return a;
}

} // namespace

glm::dmat4 Values::mat4(size_t i) const
{
    glm::dmat4 m;
    for (int k = 0; k < 16; ++k)
        m[k / 4][k % 4] = at(i)[k];
    return m;
}

Values readAccessor(const tinygltf::Model& model, int index)
{
    Values values;
    if (index < 0)
        return values;
    const tinygltf::Accessor& accessor = model.accessors.at(size_t(index));
    if (accessor.sparse.isSparse)
        throw std::runtime_error("the judge does not read sparse accessors");
    const tinygltf::BufferView& view = model.bufferViews.at(size_t(accessor.bufferView));
    const auto& bytes = model.buffers.at(size_t(view.buffer)).data;
    values.components = size_t(tinygltf::GetNumComponentsInType(uint32_t(accessor.type)));
    const auto size = size_t(tinygltf::GetComponentSizeInBytes(uint32_t(accessor.componentType)));
    const auto stride = size_t(accessor.ByteStride(view));
    for (size_t i = 0; i < accessor.count; ++i)
        for (size_t c = 0; c < values.components; ++c)
            values.numbers.push_back(
                number(&bytes.at(view.byteOffset + accessor.byteOffset + i * stride + c * size),
                       accessor.componentType, accessor.normalized));
    return values;
}

std::vector<double> sampleAnimation(const tinygltf::Model& model, const tinygltf::AnimationSampler& sampler,
                                    size_t components, bool rotation, double seconds)
{
    const std::vector<double> keys = readAccessor(model, sampler.input).numbers;
    const std::vector<double> outputs = readAccessor(model, sampler.output).numbers;
    const bool cubic = sampler.interpolation == "CUBICSPLINE";
    const auto valueAt = [&](size_t element) {
        const auto from = outputs.begin() + std::ptrdiff_t(element * components);
        return std::vector<double>(from, from + std::ptrdiff_t(components));
    };
    const auto keyed = [&](size_t key) { return valueAt(cubic ? 3 * key + 1 : key); };
    if (seconds <= keys.front())
        return keyed(0);
    if (seconds >= keys.back())
        return keyed(keys.size() - 1);
    const auto next = size_t(std::upper_bound(keys.begin(), keys.end(), seconds) - keys.begin());
    const double length = keys[next] - keys[next - 1], t = (seconds - keys[next - 1]) / length;
    std::vector<double> value = keyed(next - 1);
    const std::vector<double> after = keyed(next);
    if (sampler.interpolation == "STEP")
        return value;
    if (!cubic && rotation)
        return slerp(value, after, t);
    if (!cubic) {
        for (size_t c = 0; c < components; ++c)
            value[c] += t * (after[c] - value[c]);
        return value;
    }
    // Appendix C.5: in-tangent, value, out-tangent of each key.
    const std::vector<double> leaving = valueAt(3 * (next - 1) + 2), arriving = valueAt(3 * next);
    const double t2 = t * t, t3 = t2 * t;
    for (size_t c = 0; c < components; ++c)
        value[c] = (2 * t3 - 3 * t2 + 1) * value[c] + length * (t3 - 2 * t2 + t) * leaving[c] +
                   (3 * t2 - 2 * t3) * after[c] + length * (t3 - t2) * arriving[c];
    return value;
}

} // namespace lumel::judge
