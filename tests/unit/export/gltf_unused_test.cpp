#include "export/gltf_unused.h"
#include <gtest/gtest.h>

namespace lumel::baker {
namespace {

// Two images in the binary chunk, then geometry; both textures are exchanged for one that was added.
GltfFile exchanged(size_t& before)
{
    GltfFile file;
    file.json = GltfJson::parse(R"({
        "buffers": [{"byteLength": 96}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 32},
                        {"buffer": 0, "byteOffset": 32, "byteLength": 32},
                        {"buffer": 0, "byteOffset": 64, "byteLength": 32}],
        "accessors": [{"bufferView": 2}],
        "images": [{"bufferView": 0}, {"bufferView": 1}],
        "textures": [{"source": 0}, {"source": 1}],
        "materials": [{"normalTexture": {"index": 2}, "emissiveTexture": {"index": 1}}]})");
    for (size_t i = 0; i < 96; ++i)
        file.binary.push_back(std::byte(i / 32));
    before = file.binary.size();
    return file;
}

void addTexture(GltfFile& file)
{
    const std::vector<unsigned char> png(32, 9);
    const size_t image = file.addPng("new", png);
    file.add("textures", {{"source", image}});
}

std::byte firstOf(const GltfFile& file, size_t view)
{
    return file.binary[file.json["bufferViews"][view].value("byteOffset", size_t(0))];
}

} // namespace

TEST(GltfUnused, WhatNothingRefersToGoesAndOtherIndicesStay)
{
    size_t before = 0;
    GltfFile file = exchanged(before);
    const GltfCounts counts(file.json);
    addTexture(file);
    dropUnused(file, counts, {0, 1});
    EXPECT_EQ(file.json["textures"].size(), 2u); // the second is still used
    EXPECT_EQ(file.json["images"].size(), 2u);
    EXPECT_EQ(file.binary.size(), before);
    const GltfJson& material = file.json["materials"][0];
    const auto viewOf = [&](const char* texture) -> size_t {
        const size_t source = file.json["textures"][material[texture]["index"].get<size_t>()]["source"];
        return file.json["images"][source]["bufferView"];
    };
    EXPECT_EQ(firstOf(file, viewOf("normalTexture")), std::byte(9));
    EXPECT_EQ(firstOf(file, viewOf("emissiveTexture")), std::byte(1));
    EXPECT_EQ(file.json["accessors"][0]["bufferView"], 2);
    EXPECT_EQ(firstOf(file, 2), std::byte(2));
    EXPECT_EQ(file.json["buffers"][0]["byteLength"], file.binary.size());
}

TEST(GltfUnused, WithoutAdditionsAllStays)
{
    size_t before = 0;
    GltfFile file = exchanged(before);
    const GltfJson was = file.json;
    dropUnused(file, GltfCounts(file.json), {0});
    EXPECT_EQ(file.json, was);
    EXPECT_EQ(file.binary.size(), before);
}

} // namespace lumel::baker
