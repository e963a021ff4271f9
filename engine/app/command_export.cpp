#include "commands.h"
#include "core/error.h"
#include <chrono>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

namespace lumel {

baker::ExportOptions exportOptions(const ExportChoices& c, int threads)
{
    using baker::ExportFormat;
    using baker::Packing;
    using baker::TexelStorage;
    const bool isDds = c.format == ExportFormat::dds;
    baker::ExportOptions options;
    options.format = c.format;
    options.maps = {.packing = isDds ? Packing::unreal : Packing::gltf,
                    .normalGreenUp = c.normalGreenUp,
                    .anisotropic = c.anisotropic};
    if (c.packing != PackingChoice::automatic)
        options.maps.packing = Packing(int(c.packing) - 1);
    options.storage = isDds ? TexelStorage::blocks : TexelStorage::bytes;
    if (c.texels != TexelChoice::automatic)
        options.storage = TexelStorage(int(c.texels) - 1);
    options.ddsHeader = c.ddsHeader;
    options.zstandard = c.zstandard;
    options.ktx2Beside = c.ktx2Beside;
    options.threads = threads;
    return options;
}

void runExport(const ExportArguments& arguments)
{
    const auto start = std::chrono::steady_clock::now();
    const std::string name = arguments.name.empty() ? arguments.baked.stem().string() : arguments.name;
    // The folder first: what cannot be written need not be read.
    baker::StagedFiles files(arguments.folder);
    const baker::ReflectanceMips mips = baker::readExr(arguments.baked);
    Progress progress("export " + name, baker::ggxUnits(mips));
    const std::string remark =
        baker::exportMips({.name = name, .bakedFile = arguments.baked.filename().string(), .mips = mips},
                          exportOptions(arguments.choices, arguments.threads), files, &progress);
    files.publish();
    if (!remark.empty())
        progress.print(remark);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    progress.print(fmt::format("{}: {} files of {} x {}, {} levels, {:.2f} s", arguments.folder.string(),
                               files.names().size(), mips.levels.front().width, mips.levels.front().height,
                               mips.levels.size(), seconds.count()));
}

} // namespace lumel
