// The file's animations as tracks of nodes. All play together: exporters write one for each object. Where
// two move one property of a node, the first does.
#include "reader.h"

namespace lumel::scene {
namespace {

constexpr size_t kMaxKeys = size_t(1) << 24; // of all tracks together, 20 bytes each: 320 MiB

Interpolation interpolationOf(const Reader& reader, const std::string& name)
{
    if (name.empty() || name == "LINEAR")
        return Interpolation::linear;
    if (name == "STEP")
        return Interpolation::step;
    if (name == "CUBICSPLINE")
        return Interpolation::cubicSpline;
    reader.fail(fmt::format("an animation has the unknown interpolation {:.64}", name));
}

// `values` of `components` floats each belong to a key.
Track readTrack(const Reader& reader, const tinygltf::AnimationSampler& sampler, int components,
                Storage storage, size_t values, size_t& keys)
{
    Track track;
    track.interpolation = interpolationOf(reader, sampler.interpolation);
    keys += accessorCount(reader, sampler.input) + accessorCount(reader, sampler.output);
    if (keys > kMaxKeys)
        reader.fail(fmt::format("animations of more than {} keys", kMaxKeys));
    track.seconds = readFloats(reader, sampler.input, 1, Storage::floatOnly, "an animation's times");
    for (size_t i = 1; i < track.seconds.size(); ++i)
        if (!(track.seconds[i] > track.seconds[i - 1]))
            reader.fail("an animation's times do not increase");
    const std::vector<float> read =
        readFloats(reader, sampler.output, components, storage, "an animation's values");
    const size_t each = track.interpolation == Interpolation::cubicSpline ? 3 : 1;
    if (read.size() != track.seconds.size() * each * values * size_t(components))
        reader.fail("an animation has a different number of values and times");
    track.values.resize(read.size() / size_t(components), glm::vec4(0.0f));
    for (size_t i = 0; i < read.size(); ++i)
        track.values[i / size_t(components)][int(i % size_t(components))] = read[i];
    return track;
}

// Of the node's mesh; 0 where nothing morphs.
size_t morphTargetsOf(const tinygltf::Model& model, int node)
{
    const int mesh = model.nodes[size_t(node)].mesh;
    if (mesh < 0 || size_t(mesh) >= model.meshes.size() || model.meshes[size_t(mesh)].primitives.empty())
        return 0;
    return model.meshes[size_t(mesh)].primitives.front().targets.size();
}

WeightTrack readWeights(const Reader& reader, const tinygltf::AnimationSampler& sampler, size_t targets,
                        size_t& keys)
{
    Track all = readTrack(reader, sampler, 1, Storage::floatOrNormalized, targets, keys);
    WeightTrack track{all.interpolation, std::move(all.seconds), {}, targets};
    for (const glm::vec4& value : all.values)
        track.values.push_back(value.x);
    return track;
}

} // namespace

Tracks readTracks(Reader& reader)
{
    Tracks found;
    std::map<int, NodeTracks>& nodes = found.nodes;
    size_t keys = 0;
    for (const tinygltf::Animation& animation : reader.model.animations)
        for (const tinygltf::AnimationChannel& channel : animation.channels) {
            if (channel.target_node < 0 || size_t(channel.target_node) >= reader.model.nodes.size())
                reader.fail(
                    fmt::format("an animation moves node {}, which does not exist", channel.target_node));
            if (channel.sampler < 0 || size_t(channel.sampler) >= animation.samplers.size())
                reader.fail(fmt::format("animation sampler {} does not exist", channel.sampler));
            const tinygltf::AnimationSampler& sampler = animation.samplers[size_t(channel.sampler)];
            const auto fill = [&](Track& track, int components, Storage storage) {
                if (track.empty())
                    track = readTrack(reader, sampler, components, storage, 1, keys);
            };
            if (channel.target_path == "weights") {
                const size_t targets = morphTargetsOf(reader.model, channel.target_node);
                if (targets > 0 && !found.weights.contains(channel.target_node))
                    found.weights[channel.target_node] = readWeights(reader, sampler, targets, keys);
                continue;
            }
            NodeTracks& tracks = nodes[channel.target_node];
            if (channel.target_path == "translation")
                fill(tracks.translation, 3, Storage::floatOnly);
            else if (channel.target_path == "rotation")
                fill(tracks.rotation, 4, Storage::floatOrNormalized);
            else if (channel.target_path == "scale")
                fill(tracks.scale, 3, Storage::floatOnly);
            else
                reader.document.ignored.insert("animated " + printable(channel.target_path));
        }
    std::erase_if(nodes, [](const auto& node) {
        const NodeTracks& t = node.second;
        return t.translation.empty() && t.rotation.empty() && t.scale.empty();
    });
    return found;
}

} // namespace lumel::scene
