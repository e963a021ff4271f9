// One function per scene.
#pragma once
#include <filesystem>

namespace lumel::assets {

void writeRecord(const std::filesystem::path& folder);
void writeBalls(const std::filesystem::path& folder);
void writeBricks(const std::filesystem::path& folder);
void writeCharts(const std::filesystem::path& folder);
void writeCrowd(const std::filesystem::path& folder);
void writeStress(const std::filesystem::path& folder);
void writeTentacles(const std::filesystem::path& folder);
void writeMorph(const std::filesystem::path& folder);
void writeDahlia(const std::filesystem::path& folder);
void writeGrooves(const std::filesystem::path& folder);

} // namespace lumel::assets
