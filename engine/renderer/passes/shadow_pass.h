// Shadow maps: how far the strongest sun and spot lights reach, rendered when a light or an object changes.
#pragma once
#include "draw_list.h"
#include "renderer/resources/culling.h"

namespace lumel {

// Of `layers` square maps.
gpu::ImageInfo shadowMapInfo(uint32_t size, uint32_t layers);

class ShadowPass {
public:
    ShadowPass(const gpu::Device& device, SceneState& scene);
    // Chooses the lights, and finds which maps are out of date: their lights count as changed. Call before
    // the view is written. Where it needs more maps, it waits for the frames in flight.
    void prepare(Frame& frame);
    // How many lights that chooses.
    static size_t countMaps(const SceneState& scene, const Settings& settings);
    void preparePipelines(const Frame& frame); // begins to make all that the scene can need
    void record(Frame& frame);

private:
    struct Map {
        uint32_t light = 0;
        glm::mat4 clipFromWorld{0.0f};
        uint32_t rendered = 0; // frame
        bool current = false;
    };
    void allocate(const gpu::Device& device, SceneState& scene, uint32_t size, uint32_t layers);
    void drawMap(Frame& frame, const Map& map, vk::ImageView layer, std::span<const LightSet> reaching);
    void drawMasked(Frame& frame, const Map& map, size_t object);
    bool holds(uint32_t size, uint32_t layers) const
    {
        return maps_.info().width == size && maps_.info().layers == layers;
    }
    vk::DescriptorSet viewSet(const Frame& frame);
    const gpu::Pipeline& maskPipeline(const Frame& frame, bool coloured);

    // Set 0 of the casters' pipelines: the view alone. The frame's set holds the maps themselves, and
    // software Vulkan ends a picture before each draw that could read it.
    gpu::SetLayout viewLayout_;
    std::array<vk::raii::DescriptorSet, gpu::FrameRing::kMostFrames> viewSets_{nullptr, nullptr, nullptr};
    vk::raii::Sampler sampler_;
    gpu::Image maps_; // an array, a layer for each light
    std::vector<vk::raii::ImageView> layers_;
    std::vector<Map> known_;
    Bounds bounds_; // of all that casts, wherever they have been: maps that follow each move would shimmer
    gpu::Pipeline solid_;
    DrawList list_;                            // of what it draws
    std::map<uint32_t, gpu::Pipeline> masked_; // by features, made when first needed
};

} // namespace lumel
