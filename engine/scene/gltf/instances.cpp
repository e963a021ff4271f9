// EXT_mesh_gpu_instancing: one node, one mesh, many transforms.
#include "reader.h"

namespace lumel::scene {
namespace {

class InstanceReader {
public:
    InstanceReader(const Reader& reader, const tinygltf::Value& attributes, int node)
        : reader_(reader), attributes_(attributes), node_(node)
    {
    }

    std::vector<glm::mat4> read()
    {
        // The specification allows floats, and normalised signed integers for rotations.
        const auto translations = values("TRANSLATION", 3, Storage::floatOnly);
        const auto rotations = values("ROTATION", 4, Storage::floatOrNormalized);
        const auto scales = values("SCALE", 3, Storage::floatOnly);
        std::vector<glm::mat4> transforms(count_, glm::mat4(1.0f));
        for (size_t i = 0; i < count_; ++i) {
            glm::mat4& m = transforms[i];
            if (!translations.empty())
                m = glm::translate(
                    m, glm::vec3(translations[3 * i], translations[3 * i + 1], translations[3 * i + 2]));
            if (!rotations.empty())
                m *= rotation(&rotations[4 * i]);
            if (!scales.empty())
                m = glm::scale(m, glm::vec3(scales[3 * i], scales[3 * i + 1], scales[3 * i + 2]));
        }
        return transforms;
    }

private:
    std::vector<float> values(const char* name, int components, Storage storage)
    {
        if (!attributes_.Has(name))
            return {};
        if (!attributes_.Get(name).IsInt())
            reader_.fail(
                fmt::format("the instances of node {} have a {} that is not an accessor", node_, name));
        const int accessor = attributes_.Get(name).GetNumberAsInt();
        const size_t count = accessorCount(reader_, accessor);
        if (count > kMaxObjects)
            reader_.fail(fmt::format("more than {} objects", kMaxObjects), "split the model");
        if (count_ != 0 && count != count_)
            reader_.fail(fmt::format("the instances of node {} have attributes of {} and {} elements", node_,
                                     count_, count));
        count_ = count;
        return readFloats(reader_, accessor, components, storage, name);
    }

    glm::mat4 rotation(const float* xyzw) const
    {
        const glm::quat q(xyzw[3], xyzw[0], xyzw[1], xyzw[2]);
        if (!(glm::length(q) > 0.0f))
            reader_.fail(fmt::format("an instance of node {} has a wrong rotation", node_));
        return glm::mat4_cast(glm::normalize(q));
    }

    const Reader& reader_;
    const tinygltf::Value& attributes_;
    int node_;
    size_t count_ = 0;
};

} // namespace

std::vector<glm::mat4> readInstances(const Reader& reader, int index)
{
    const tinygltf::Node& node = reader.model.nodes[size_t(index)];
    const auto extension = node.extensions.find("EXT_mesh_gpu_instancing");
    if (extension == node.extensions.end())
        return {glm::mat4(1.0f)};
    if (!extension->second.Has("attributes") || !extension->second.Get("attributes").IsObject())
        reader.fail(fmt::format("the instances of node {} have no attributes", index));
    auto transforms = InstanceReader(reader, extension->second.Get("attributes"), index).read();
    if (transforms.empty())
        reader.fail(fmt::format("node {} has no instances", index));
    return transforms;
}

} // namespace lumel::scene
