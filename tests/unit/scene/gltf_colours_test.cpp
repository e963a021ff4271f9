// Vertex colours (COLOR_0) in every type that glTF allows.
#include "gltf_builder.h"

namespace lumel::scene {
namespace {

struct ColouredGltf : testing::Test {
    TemporaryFolder folder;
    GltfBuilder gltf;
    ColouredGltf() { gltf.quad(); }
    Scene load() { return loadGltf(gltf.writeGlb(folder)); }
};

TEST_F(ColouredGltf, EveryTypeOfColourIsRead)
{
    const auto expectColour = [&](size_t accessor, bool normalized, const char* mode, glm::vec4 expected) {
        gltf.root["accessors"][accessor]["normalized"] = normalized;
        gltf.primitive()["attributes"]["COLOR_0"] = accessor;
        gltf.root["materials"] = {{{"alphaMode", mode}}};
        gltf.primitive()["material"] = 0;
        const Scene scene = load();
        ASSERT_EQ(scene.meshes[0].colours.size(), scene.meshes[0].vertices.size());
        for (const glm::vec4& colour : scene.meshes[0].colours)
            EXPECT_LT(glm::distance(colour, expected), 1e-5f) << colour.r << ' ' << colour.a;
    };
    const auto four = [](auto value) {
        std::vector<typename decltype(value)::value_type> all;
        for (int i = 0; i < 4; ++i)
            all.insert(all.end(), value.begin(), value.end());
        return all;
    };
    using F = std::vector<float>;
    using B = std::vector<uint8_t>;
    using S = std::vector<uint16_t>;
    expectColour(gltf.floats(four(F{0.25f, 0.5f, 1}), "VEC3", 3), false, "BLEND", {0.25f, 0.5f, 1, 1});
    expectColour(gltf.floats(four(F{0.25f, -1, 9, 0.5f}), "VEC4", 4), false, "BLEND", {0.25f, 0, 9, 0.5f});
    expectColour(gltf.floats(four(F{0.25f, 0.5f, 1, 0.5f}), "VEC4", 4), false, "OPAQUE", {0.25f, 0.5f, 1, 1});
    expectColour(gltf.accessor(four(B{51, 102, 255, 0}), "VEC4", 5121, 4), true, "MASK", {0.2f, 0.4f, 1, 0});
    expectColour(gltf.accessor(four(S{13107, 0, 65535}), "VEC3", 5123, 3), true, "OPAQUE", {0.2f, 0, 1, 1});
}

TEST_F(ColouredGltf, DamagedColoursAreRefused)
{
    gltf.primitive()["attributes"]["COLOR_0"] = gltf.floats({1, 1, 1}, "VEC3", 3);
    expectRefused(gltf.writeGltf(folder), "1 elements for 4 vertices");
    gltf.primitive()["attributes"]["COLOR_0"] = gltf.primitive()["attributes"]["TEXCOORD_0"];
    expectRefused(gltf.writeGltf(folder), "wrong type");
}

} // namespace
} // namespace lumel::scene
