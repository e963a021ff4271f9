#include "pipeline.h"
#include "host_work.h"
#include <stdexcept>

#include "table.inc"

namespace lumel::gpu {
namespace {

std::map<std::string, std::span<const uint32_t>>& shaderTable()
{
    static std::map<std::string, std::span<const uint32_t>> table = {
#include "entries.inc"
    };
    return table;
}

// Code that came later than the program.
std::map<std::string, std::vector<uint32_t>>& replacedCode()
{
    static std::map<std::string, std::vector<uint32_t>> codes;
    return codes;
}

vk::raii::ShaderModule makeModule(const Device& device, const std::string& shader)
{
    const auto code = shaderCode(shader);
    return {device.handle(), {.codeSize = code.size_bytes(), .pCode = code.data()}};
}

// Specialisation constants by their numbers; shaders without one of them do not mind. Not to be copied:
// Vulkan's struct points into it.
struct Constants {
    Constants(uint32_t features, uint32_t filter, uint32_t anisotropy, uint32_t lanes)
        : values{features, filter, anisotropy, lanes}
    {
        for (uint32_t i = 0; i < values.size(); ++i)
            entries[i] = vk::SpecializationMapEntry{
                .constantID = i, .offset = i * uint32_t(sizeof(uint32_t)), .size = sizeof(uint32_t)};
        info.setMapEntries(entries).setData<uint32_t>(values);
    }
    Constants(const Constants&) = delete;
    Constants& operator=(const Constants&) = delete;
    std::array<uint32_t, 4> values;
    std::array<vk::SpecializationMapEntry, 4> entries;
    vk::SpecializationInfo info;
};

template<class Make>
CompiledPipeline compile(const Device& device, Make make)
{
    ++hostWork().pipelinesCreated;
    const auto compilation = std::make_shared<Compilation>(std::move(make));
    device.compiler().add(compilation);
    return CompiledPipeline(compilation);
}

vk::raii::PipelineLayout makeLayout(const Device& device, const std::vector<vk::DescriptorSetLayout>& sets,
                                    uint32_t pushBytes)
{
    const vk::PushConstantRange range{.stageFlags = vk::ShaderStageFlagBits::eAll, .size = pushBytes};
    return {device.handle(), vk::PipelineLayoutCreateInfo{.pushConstantRangeCount = pushBytes ? 1u : 0u,
                                                          .pPushConstantRanges = &range}
                                 .setSetLayouts(sets)};
}

} // namespace

std::span<const uint32_t> shaderCode(const std::string& name)
{
    const auto found = shaderTable().find(name);
    if (found == shaderTable().end())
        throw std::logic_error("no shader named " + name);
    return found->second;
}

void replaceShaderCode(std::map<std::string, std::vector<uint32_t>> codes)
{
    replacedCode() = std::move(codes);
    for (const auto& [name, code] : replacedCode())
        shaderTable()[name] = code;
}

std::vector<std::string> shaderNames()
{
    std::vector<std::string> names;
    for (const auto& [name, code] : shaderTable())
        names.push_back(name);
    return names;
}

SetLayout makeSetLayout(const Device& device, const std::vector<vk::DescriptorType>& bindings)
{
    std::vector<vk::DescriptorSetLayoutBinding> list;
    for (uint32_t i = 0; i < bindings.size(); ++i)
        list.push_back({.binding = i,
                        .descriptorType = bindings[i],
                        .descriptorCount = 1,
                        .stageFlags = vk::ShaderStageFlagBits::eAll});
    return {device.handle(), vk::DescriptorSetLayoutCreateInfo{}.setBindings(list)};
}

vk::raii::DescriptorSet makeSet(const Device& device, const SetLayout& layout)
{
    return makeSet(device, device.descriptorPool(), layout);
}

vk::raii::DescriptorPool makePool(const Device& device, vk::DescriptorType type, size_t sets,
                                  size_t descriptorsASet)
{
    const size_t count = std::max<size_t>(sets, 1);
    const vk::DescriptorPoolSize size{type, uint32_t(count * descriptorsASet)};
    return {device.handle(),
            vk::DescriptorPoolCreateInfo{.flags = vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet,
                                         .maxSets = uint32_t(count)}
                .setPoolSizes(size)};
}

vk::raii::DescriptorSet makeSet(const Device& device, const vk::raii::DescriptorPool& pool,
                                const SetLayout& layout)
{
    vk::raii::DescriptorSets sets(
        device.handle(), {.descriptorPool = *pool, .descriptorSetCount = 1, .pSetLayouts = &*layout});
    return std::move(sets.front());
}

void writeSampled(const Device& device, vk::DescriptorSet set, uint32_t binding, vk::Sampler sampler,
                  vk::ImageView view, vk::ImageLayout layout)
{
    const vk::DescriptorImageInfo image{.sampler = sampler, .imageView = view, .imageLayout = layout};
    device.handle().updateDescriptorSets(
        vk::WriteDescriptorSet{.dstSet = set,
                               .dstBinding = binding,
                               .descriptorCount = 1,
                               .descriptorType = vk::DescriptorType::eCombinedImageSampler,
                               .pImageInfo = &image},
        nullptr);
}

void writeUniform(const Device& device, vk::DescriptorSet set, uint32_t binding, vk::Buffer buffer)
{
    const vk::DescriptorBufferInfo info{.buffer = buffer, .offset = 0, .range = VK_WHOLE_SIZE};
    device.handle().updateDescriptorSets(
        vk::WriteDescriptorSet{.dstSet = set,
                               .dstBinding = binding,
                               .descriptorCount = 1,
                               .descriptorType = vk::DescriptorType::eUniformBuffer,
                               .pBufferInfo = &info},
        nullptr);
}

void writeStorage(const Device& device, vk::DescriptorSet set, uint32_t binding, vk::ImageView view)
{
    const vk::DescriptorImageInfo image{.imageView = view, .imageLayout = vk::ImageLayout::eGeneral};
    device.handle().updateDescriptorSets(
        vk::WriteDescriptorSet{.dstSet = set,
                               .dstBinding = binding,
                               .descriptorCount = 1,
                               .descriptorType = vk::DescriptorType::eStorageImage,
                               .pImageInfo = &image},
        nullptr);
}

void writeTexels(const Device& device, vk::DescriptorSet set, uint32_t binding, vk::BufferView view)
{
    device.handle().updateDescriptorSets(
        vk::WriteDescriptorSet{.dstSet = set,
                               .dstBinding = binding,
                               .descriptorCount = 1,
                               .descriptorType = vk::DescriptorType::eUniformTexelBuffer,
                               .pTexelBufferView = &view},
        nullptr);
}

Pipeline makeComputePipeline(const Device& device, const std::string& shader,
                             const std::vector<vk::DescriptorSetLayout>& sets, uint32_t pushBytes,
                             uint32_t features)
{
    // Devices that run 8 invocations at a time or fewer go over a tile two quads at a time
    // (lib/light_tiles.glsl).
    const uint32_t lanes = device.limits().subgroupSize <= 8 ? 8 : 64;
    Pipeline pipeline;
    pipeline.layout = makeLayout(device, sets, pushBytes);
    pipeline.handle = compile(device, [&device, shader, features, lanes, layout = *pipeline.layout,
                                       module = makeModule(device, shader)] {
        const Constants constants(features, 0, 1, lanes);
        vk::raii::Pipeline made(
            device.handle(), device.pipelineCache(),
            vk::ComputePipelineCreateInfo{.stage = {.stage = vk::ShaderStageFlagBits::eCompute,
                                                    .module = *module,
                                                    .pName = "main",
                                                    .pSpecializationInfo = &constants.info},
                                          .layout = layout});
        device.name(made, shader);
        return made;
    });
    return pipeline;
}

static vk::PipelineDepthStencilStateCreateInfo depthOf(const GraphicsInfo& info)
{
    const bool over = info.blend || info.background; // what is there already
    return {.depthTestEnable = VK_TRUE,
            .depthWriteEnable = !over,
            .depthCompareOp = over ? vk::CompareOp::eGreaterOrEqual : vk::CompareOp::eGreater};
}

static vk::PipelineColorBlendAttachmentState blendOf(const GraphicsInfo& info)
{
    using Factor = vk::BlendFactor;
    using Component = vk::ColorComponentFlagBits;
    return {.blendEnable = info.blend,
            .srcColorBlendFactor = Factor::eSrcAlpha,
            .dstColorBlendFactor = Factor::eOneMinusSrcAlpha,
            .srcAlphaBlendFactor = Factor::eOne,
            .dstAlphaBlendFactor = Factor::eOne,
            .alphaBlendOp = vk::BlendOp::eMax, // the objects' numbers stay
            .colorWriteMask = Component::eR | Component::eG | Component::eB | Component::eA};
}

// Of vertices, then of fragments where there are such.
using Modules = std::vector<vk::raii::ShaderModule>;

static vk::raii::Pipeline compileGraphics(const Device& device, const GraphicsInfo& info,
                                          const Modules& modules, vk::PipelineLayout layout)
{
    const Constants constants(info.features, info.filter, info.anisotropy, 0);
    std::vector<vk::PipelineShaderStageCreateInfo> stages;
    for (const auto stage : {vk::ShaderStageFlagBits::eVertex, vk::ShaderStageFlagBits::eFragment})
        if (stages.size() < modules.size())
            stages.push_back({.stage = stage,
                              .module = *modules[stages.size()],
                              .pName = "main",
                              .pSpecializationInfo = &constants.info});
    const auto input = vk::PipelineVertexInputStateCreateInfo{}
                           .setVertexBindingDescriptions(info.bindings)
                           .setVertexAttributeDescriptions(info.attributes);
    const vk::PipelineInputAssemblyStateCreateInfo triangles{.topology =
                                                                 vk::PrimitiveTopology::eTriangleList};
    const vk::PipelineViewportStateCreateInfo viewport{.viewportCount = 1, .scissorCount = 1};
    const vk::PipelineRasterizationStateCreateInfo raster{.polygonMode = vk::PolygonMode::eFill,
                                                          .lineWidth = 1.0f};
    const vk::PipelineMultisampleStateCreateInfo multisample{.rasterizationSamples = info.samples};
    const vk::PipelineDepthStencilStateCreateInfo depth = depthOf(info);
    const vk::PipelineColorBlendAttachmentState attachment = blendOf(info);
    const uint32_t colours = info.color == vk::Format::eUndefined ? 0 : 1;
    const vk::PipelineColorBlendStateCreateInfo blend{.attachmentCount = colours,
                                                      .pAttachments = &attachment};
    const vk::DynamicState dynamicStates[] = {vk::DynamicState::eViewport, vk::DynamicState::eScissor,
                                              vk::DynamicState::eCullMode, vk::DynamicState::eFrontFace};
    const auto dynamic = vk::PipelineDynamicStateCreateInfo{}.setDynamicStates(dynamicStates);
    const vk::PipelineRenderingCreateInfo rendering{.colorAttachmentCount = colours,
                                                    .pColorAttachmentFormats = &info.color,
                                                    .depthAttachmentFormat = vk::Format::eD32Sfloat};
    const auto create = vk::GraphicsPipelineCreateInfo{.pNext = &rendering,
                                                       .pVertexInputState = &input,
                                                       .pInputAssemblyState = &triangles,
                                                       .pViewportState = &viewport,
                                                       .pRasterizationState = &raster,
                                                       .pMultisampleState = &multisample,
                                                       .pDepthStencilState = &depth,
                                                       .pColorBlendState = &blend,
                                                       .pDynamicState = &dynamic,
                                                       .layout = layout}
                            .setStages(stages);
    vk::raii::Pipeline made(device.handle(), device.pipelineCache(), create);
    device.name(made, info.fragment.empty() ? info.vertex : info.fragment);
    return made;
}

Pipeline makeGraphicsPipeline(const Device& device, const GraphicsInfo& info)
{
    Pipeline pipeline;
    pipeline.layout = makeLayout(device, info.sets, info.pushBytes);
    Modules modules;
    modules.push_back(makeModule(device, info.vertex));
    if (!info.fragment.empty())
        modules.push_back(makeModule(device, info.fragment));
    pipeline.handle =
        compile(device, [&device, info, layout = *pipeline.layout, modules = std::move(modules)] {
            return compileGraphics(device, info, modules, layout);
        });
    return pipeline;
}

} // namespace lumel::gpu
