// Pipelines from embedded SPIR-V, and the layouts of their descriptor sets.
#pragma once
#include "device.h"
#include "pipeline_compiler.h"
#include <map>
#include <span>

namespace lumel::gpu {

// SPIR-V of a shader file by its name, "light.comp". Throws std::logic_error for an unknown name.
std::span<const uint32_t> shaderCode(const std::string& name);
std::vector<std::string> shaderNames();
// From now on; spans of earlier replacements end.
void replaceShaderCode(std::map<std::string, std::vector<uint32_t>> codes);

using SetLayout = vk::raii::DescriptorSetLayout;
// `count` bindings of one type, for every stage.
SetLayout makeSetLayout(const Device& device, const std::vector<vk::DescriptorType>& bindings);
vk::raii::DescriptorSet makeSet(const Device& device, const SetLayout& layout);
// The same from a pool of one's own: pools serve one thread at a time, the device's the one that renders.
vk::raii::DescriptorPool makePool(const Device& device, vk::DescriptorType type, size_t sets,
                                  size_t descriptorsASet);
vk::raii::DescriptorSet makeSet(const Device& device, const vk::raii::DescriptorPool& pool,
                                const SetLayout& layout);
void writeSampled(const Device& device, vk::DescriptorSet set, uint32_t binding, vk::Sampler sampler,
                  vk::ImageView view, vk::ImageLayout layout = vk::ImageLayout::eShaderReadOnlyOptimal);
void writeUniform(const Device& device, vk::DescriptorSet set, uint32_t binding, vk::Buffer buffer);
void writeStorage(const Device& device, vk::DescriptorSet set, uint32_t binding, vk::ImageView view);
void writeTexels(const Device& device, vk::DescriptorSet set, uint32_t binding, vk::BufferView view);

// Compiled in the background, or by whom uses it first.
class CompiledPipeline {
public:
    CompiledPipeline() = default;
    explicit CompiledPipeline(std::shared_ptr<Compilation> compiling) : compiling_(std::move(compiling)) {}
    CompiledPipeline(CompiledPipeline&&) noexcept = default;
    CompiledPipeline& operator=(CompiledPipeline&& other) noexcept
    {
        std::swap(compiling_, other.compiling_);
        std::swap(done_, other.done_);
        return *this;
    }
    ~CompiledPipeline()
    {
        if (compiling_)
            compiling_->drop();
    }
    bool begun() const { return compiling_ || *done_; }
    // Throws what went wrong. Null: none.
    vk::Pipeline operator*() const
    {
        if (compiling_)
            done_ = std::exchange(compiling_, nullptr)->take();
        return *done_;
    }

private:
    mutable std::shared_ptr<Compilation> compiling_;
    mutable vk::raii::Pipeline done_ = nullptr;
};

struct Pipeline {
    vk::raii::PipelineLayout layout = nullptr;
    CompiledPipeline handle;
};

Pipeline makeComputePipeline(const Device& device, const std::string& shader,
                             const std::vector<vk::DescriptorSetLayout>& sets, uint32_t pushBytes,
                             uint32_t features = 0);

struct GraphicsInfo {
    std::string vertex, fragment{}; // without a fragment shader: depth alone
    std::vector<vk::VertexInputBindingDescription> bindings{};
    std::vector<vk::VertexInputAttributeDescription> attributes{};
    std::vector<vk::DescriptorSetLayout> sets{};
    uint32_t pushBytes = 0;
    vk::Format color = vk::Format::eR16G16B16A16Sfloat; // eUndefined: none
    vk::SampleCountFlagBits samples = vk::SampleCountFlagBits::e1;
    // Specialisation constants of both shaders, where they have them.
    uint32_t features = 0;   // kFeature...
    uint32_t filter = 0;     // kFilter...
    uint32_t anisotropy = 1; // of forward shading's material lookups
    bool blend = false;      // over, straight alpha; equal depth passes, none is written
    bool background = false; // at infinity, where nothing else is drawn
};
// Triangle list, reversed depth in D32, dynamic viewport, scissor, cull mode and front face.
Pipeline makeGraphicsPipeline(const Device& device, const GraphicsInfo& info);

} // namespace lumel::gpu
