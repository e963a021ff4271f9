#include "targets.h"

namespace lumel {

namespace {

struct Target {
    gpu::Image Targets::*image;
    gpu::ImageInfo info;
    const char* name;
    bool operator==(const Target&) const = default;
};

std::vector<Target> targetsOf(const Settings& settings)
{
    using Usage = vk::ImageUsageFlagBits;
    const bool multisampling = settings.msaa > 1 && settings.shading != Shading::reference;
    const auto samples = multisampling ? vk::SampleCountFlagBits::e4 : vk::SampleCountFlagBits::e1;
    std::vector<Target> targets;
    const auto add = [&](gpu::Image Targets::*image, const char* name, vk::ImageUsageFlags usage,
                         vk::Format format = vk::Format::eR16G16B16A16Sfloat,
                         vk::SampleCountFlagBits count = vk::SampleCountFlagBits::e1) {
        targets.push_back({image,
                           {.format = format,
                            .width = settings.size.x,
                            .height = settings.size.y,
                            .usage = usage,
                            .samples = count,
                            .remedy = "use a smaller --size"},
                           name});
    };
    add(&Targets::hdr, "hdr",
        Usage::eColorAttachment | Usage::eSampled | Usage::eStorage | Usage::eTransferSrc);
    add(&Targets::depth, "depth", Usage::eDepthStencilAttachment, vk::Format::eD32Sfloat, samples);
    if (multisampling)
        add(&Targets::multisampled, "multisampled", Usage::eColorAttachment, vk::Format::eR16G16B16A16Sfloat,
            samples);
    if (settings.shading == Shading::reference)
        add(&Targets::sum, "reference sum",
            Usage::eStorage | Usage::eSampled | Usage::eTransferSrc | Usage::eTransferDst,
            vk::Format::eR32G32B32A32Sfloat);
    if (settings.budgetMs > 0.0) {
        add(&Targets::small, "small picture", Usage::eStorage | Usage::eSampled);
        add(&Targets::wide, "wide picture", Usage::eStorage | Usage::eSampled, vk::Format::eR32G32B32A32Uint);
        targets.back().info.width = (settings.size.x + 3) / 4;
    }
    add(&Targets::display, "display", Usage::eStorage | Usage::eTransferSrc, vk::Format::eR8G8B8A8Unorm);
    return targets;
}

} // namespace

Targets::Targets(const gpu::Device& device, const Settings& settings)
{
    for (const Target& target : targetsOf(settings))
        this->*target.image = gpu::Image(device, target.info, target.name);
}

void Targets::check(const gpu::Device& device, const Settings& settings)
{
    for (const Target& target : targetsOf(settings))
        gpu::checkImage(device, target.info);
}

bool Targets::same(const Settings& a, const Settings& b)
{
    return targetsOf(a) == targetsOf(b);
}

} // namespace lumel
