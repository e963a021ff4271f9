// Every malformed file is refused with one line that names it; none is read past its end. Run under the
// sanitizers (./run test --sanitize) this is also the proof of the latter.
#include "gltf_compress.h"

namespace lumel::scene {
namespace {

using nlohmann::json;

struct HostileGltf : testing::Test {
    TemporaryFolder folder;
    GltfBuilder gltf;

    HostileGltf() { gltf.quad(); }
    void expectGltfRefused(const std::string& part) { expectRefused(gltf.writeGltf(folder), part); }
    void expectTextRefused(const std::string& name, const std::string& text, const std::string& part)
    {
        writeText(folder / name, text);
        expectRefused(folder / name, part);
    }
};

TEST_F(HostileGltf, TheUndamagedModelLoads)
{
    EXPECT_EQ(loadGltf(gltf.writeGltf(folder)).objects.size(), 1u);
    EXPECT_EQ(loadGltf(gltf.writeGlb(folder)).objects.size(), 1u);
}

// --- The container

TEST_F(HostileGltf, MissingFile)
{
    expectRefused(folder / "nothing.gltf", "no such file");
}

TEST_F(HostileGltf, FolderInPlaceOfAFile)
{
    std::filesystem::create_directory(folder / "folder.gltf");
    expectRefused(folder / "folder.gltf", "not a regular file");
}

TEST_F(HostileGltf, EmptyFile)
{
    expectTextRefused("empty.gltf", "", "empty");
    expectTextRefused("empty.glb", "", "empty");
}

TEST_F(HostileGltf, TextRenamedGlb)
{
    expectTextRefused("text.glb", "This is a shopping list.\nMilk.\n", "not a binary glTF");
}

TEST_F(HostileGltf, TextRenamedGltf)
{
    expectTextRefused("text.gltf", "This is a shopping list.\nMilk.\n", "invalid JSON");
}

TEST_F(HostileGltf, JsonThatIsNoGltf)
{
    expectTextRefused("array.gltf", "[1, 2, 3]", "not an object");
    expectTextRefused("other.gltf", "{\"name\": \"package\"}", "asset.version");
}

TEST_F(HostileGltf, OldVersion)
{
    gltf.root["asset"]["version"] = "1.0";
    expectGltfRefused("version 1.0");
}

TEST_F(HostileGltf, GlbTruncatedAnywhere)
{
    const std::string whole = gltf.glb();
    for (size_t size = 4; size < whole.size(); size += 13)
        expectTextRefused("cut.glb", whole.substr(0, size), "copy the file again");
}

TEST_F(HostileGltf, GlbLengthsThatWrap)
{
    for (size_t at : {8u, 12u}) { // the file's length, the JSON chunk's length
        for (uint32_t length : {0xffffffffu, 0xfffffff8u, 0xffffffe8u, 0x80000000u}) {
            std::string glb = gltf.glb();
            std::memcpy(glb.data() + at, &length, 4);
            expectTextRefused("wrap.glb", glb, "copy the file again");
        }
    }
    std::string glb = gltf.glb();
    uint32_t json = 0;
    std::memcpy(&json, glb.data() + 12, 4);
    const uint32_t wrapping = 0xfffffff0u;
    std::memcpy(glb.data() + 20 + json, &wrapping, 4); // the BIN chunk's length
    expectTextRefused("wrap.glb", glb, "exceeds the file");
}

TEST_F(HostileGltf, GlbWithEmptyBinaryChunk)
{
    gltf.root["buffers"] = {{{"byteLength", 64}}};
    gltf.binary.clear();
    expectRefused(gltf.writeGlb(folder), "holds 0 of 64 bytes");
}

TEST_F(HostileGltf, DeepJson)
{
    expectTextRefused("deep.gltf", std::string(1000000, '['), "nested deeper");
    gltf.root["extras"] = "@";
    std::string text = gltf.root.dump();
    text.replace(text.find("\"@\""), 3, std::string(200, '[') + std::string(200, ']'));
    expectTextRefused("deep.gltf", text, "nested deeper");
}

TEST_F(HostileGltf, NumbersBeyondDouble)
{
    expectTextRefused("number.gltf", "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 1e999}", "out of range");
}

TEST_F(HostileGltf, ControlCharactersInNamesStayOutOfTheMessage)
{
    gltf.root["meshes"][0]["name"] = "two\nlines \x1b[31m";
    gltf.primitive()["attributes"].erase("POSITION");
    const std::string message = errorOf([&] { loadGltf(gltf.writeGltf(folder)); });
    EXPECT_TRUE(contains(message, "two?lines ?[31m")) << message;
}

// --- What the file asks for

TEST_F(HostileGltf, RequiredExtensionIsNamed)
{
    gltf.root["extensionsRequired"] = {"KHR_materials_unheard_of"};
    expectGltfRefused("KHR_materials_unheard_of");
}

TEST_F(HostileGltf, UnknownOptionalExtensionsDoNotMatter)
{
    gltf.root["extensionsUsed"] = {"KHR_materials_unheard_of", std::string(100000, 'x'), "two\nlines"};
    gltf.node()["extensions"]["KHR_materials_unheard_of"] = {{"deep", {{"er", 1}}}};
    EXPECT_EQ(loadGltf(gltf.writeGltf(folder)).objects.size(), 1u);
    gltf.root["extensionsUsed"] = {7};
    expectGltfRefused("extensionsUsed");
}

TEST_F(HostileGltf, VerticesWithoutDataAreLimited)
{
    const uint64_t limit = uint64_t(1) << 24;
    gltf.root["accessors"] = {{{"componentType", 5126}, {"type", "VEC3"}, {"count", limit + 1}}};
    gltf.primitive() = {{"attributes", {{"POSITION", 0}}}};
    expectGltfRefused("exceeds the limit of 16777216");
}

TEST_F(HostileGltf, UrisThatLeaveTheFolder)
{
    std::filesystem::create_directory(folder / "inner");
    for (const char* uri : {"/etc/hostname", "../data.bin", "inner/../../data.bin", "%2e%2e/data.bin",
                            "..%2Fdata.bin", "..\\data.bin", "%2Fetc%2Fhostname", "file:///etc/hostname",
                            "https://example.com/a.bin", "C:\\data.bin", "", "data.bin%00.png"}) {
        gltf.root["buffers"] = {{{"byteLength", 4}, {"uri", uri}}};
        writeText(folder / "inner/model.gltf", gltf.root.dump());
        writeText(folder / "data.bin", gltf.binary);
        expectRefused(folder / "inner/model.gltf", "copy the file into the model's folder");
    }
}

TEST_F(HostileGltf, ImageUrisAreCheckedToo)
{
    gltf.root["images"] = {{{"uri", "../secret.png"}}};
    expectGltfRefused("leaves the model's folder");
}

TEST_F(HostileGltf, LinksThatLeaveTheFolder)
{
    std::filesystem::create_directory(folder / "inner");
    writeText(folder / "data.bin", gltf.binary);
    std::filesystem::create_symlink("../data.bin", folder / "inner/data.bin");
    gltf.root["buffers"] = {{{"byteLength", gltf.binary.size()}, {"uri", "data.bin"}}};
    writeText(folder / "inner/model.gltf", gltf.root.dump());
    expectRefused(folder / "inner/model.gltf", "link");
}

TEST_F(HostileGltf, UrisAreNotForShells)
{
    for (const char* uri : {"$(touch pwned)", "`touch pwned`", "~/data.bin", "$HOME/data.bin", "*.bin"}) {
        gltf.root["buffers"] = {{{"byteLength", 4}, {"uri", uri}}};
        expectGltfRefused("no such file");
    }
    EXPECT_FALSE(std::filesystem::exists("pwned"));
}

TEST_F(HostileGltf, MissingAndShortBuffers)
{
    gltf.root["buffers"] = {{{"byteLength", 10}, {"uri", "absent.bin"}}};
    expectGltfRefused("absent.bin");
    gltf.root["buffers"] = {{{"byteLength", 1 << 20}, {"uri", "data.bin"}}};
    expectGltfRefused("data.bin holds");
    gltf.root["buffers"] = {{{"byteLength", 18446744073709551615ull}, {"uri", "data.bin"}}};
    expectGltfRefused("data.bin holds");
    gltf.root["buffers"] = {{{"byteLength", 0}, {"uri", "data.bin"}}};
    expectGltfRefused("byteLength");
    gltf.root["buffers"] = {{{"byteLength", -4}, {"uri", "data.bin"}}};
    expectGltfRefused("byteLength");
}

TEST_F(HostileGltf, BrokenDataUris)
{
    for (const char* uri :
         {"data:application/octet-stream;base64", "data:application/octet-stream;base64,!!!!"}) {
        gltf.root["buffers"] = {{{"byteLength", 4}, {"uri", uri}}};
        expectGltfRefused("data: URI");
    }
}

TEST_F(HostileGltf, MissingImage)
{
    gltf.root["images"] = {{{"uri", "absent.png"}}};
    expectGltfRefused("absent.png");
    gltf.root["images"] = {{{"name", "nothing"}}};
    expectGltfRefused("image 0");
}

TEST_F(HostileGltf, ImageOutsideOfItsBuffer)
{
    gltf.root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 8}, {"byteLength", 1 << 30}});
    gltf.root["images"] = {{{"bufferView", gltf.root["bufferViews"].size() - 1}, {"mimeType", "image/png"}}};
    expectGltfRefused("past the end");
    gltf.root["images"][0]["bufferView"] = 99;
    expectGltfRefused("buffer view 99");
}

// --- Nodes, scenes, materials

TEST_F(HostileGltf, NodeCycle)
{
    gltf.root["nodes"] = {{{"children", {1}}}, {{"mesh", 0}, {"children", {0}}}};
    expectGltfRefused("own ancestor");
    gltf.root["nodes"] = {{{"children", {0}}}};
    expectGltfRefused("own ancestor");
}

TEST_F(HostileGltf, NodeWithTwoParents)
{
    // Doubling at each level would make 2^20 objects of a few bytes.
    json nodes = json::array();
    for (int i = 0; i < 20; ++i)
        nodes.push_back({{"children", {i + 1, i + 1}}});
    nodes.push_back({{"mesh", 0}});
    gltf.root["nodes"] = nodes;
    expectGltfRefused("two parents");
}

TEST_F(HostileGltf, DeepNodes)
{
    json nodes = json::array();
    for (int i = 0; i < 100000; ++i)
        nodes.push_back({{"children", {i + 1}}});
    nodes.push_back({{"mesh", 0}});
    gltf.root["nodes"] = nodes;
    expectGltfRefused("nested deeper");
}

TEST_F(HostileGltf, IndicesOfNodesMeshesAndMaterials)
{
    gltf.root["scenes"][0]["nodes"] = {7};
    expectGltfRefused("node 7");
    gltf.root["scenes"][0]["nodes"] = {-1};
    expectGltfRefused("node -1");
    gltf.root["scenes"][0]["nodes"] = {0};
    gltf.root["scene"] = 4;
    expectGltfRefused("scene 4");
    gltf.root["scene"] = 0;
    gltf.node()["mesh"] = 9;
    expectGltfRefused("mesh 9");
    gltf.node()["mesh"] = 0;
    gltf.primitive()["material"] = 3;
    expectGltfRefused("material 3");
    gltf.primitive().erase("material");
    gltf.node()["camera"] = 2;
    expectGltfRefused("camera 2");
}

TEST_F(HostileGltf, UnusableTransforms)
{
    gltf.node()["matrix"] = {1, 2, 3};
    expectGltfRefused("matrix");
    gltf.node().erase("matrix");
    gltf.node()["rotation"] = {0, 0, 0, 0};
    expectGltfRefused("rotation");
    gltf.node().erase("rotation");
    gltf.node()["scale"] = {1e300, 1, 1};
    expectGltfRefused("not finite");
}

TEST_F(HostileGltf, TexturesThatNameNothing)
{
    gltf.material() = {{"normalTexture", {{"index", 5}}}};
    gltf.primitive()["material"] = 0;
    expectGltfRefused("texture 5");
    gltf.root["textures"] = {{{"source", 8}}};
    gltf.material()["normalTexture"]["index"] = 0;
    expectGltfRefused("image 8");
}

TEST_F(HostileGltf, LightsThatNameNothing)
{
    gltf.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    gltf.node()["extensions"]["KHR_lights_punctual"]["light"] = 3;
    expectGltfRefused("light 3");
    gltf.node()["extensions"]["KHR_lights_punctual"]["light"] = 0;
    gltf.root["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = -1;
    expectGltfRefused("light");
}

TEST_F(HostileGltf, NothingToDraw)
{
    gltf.primitive()["mode"] = 1; // lines
    expectGltfRefused("no triangles");
    gltf.root["nodes"] = {json::object()};
    expectGltfRefused("no triangles");
}

// Each value of the file in turn becomes one of another type: whatever happens, it is a load or an Error.
TEST_F(HostileGltf, NoValueOfAnyTypeCrashes)
{
    gltf.material() = {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 1}}}},
                       {"extras", {{"lumel", {{"power", 9}}}}}};
    gltf.primitive()["material"] = 0;
    gltf.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
    gltf.node()["camera"] = 0;
    gltf.material()["extensions"] = {
        {"KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {1, 1, 1}}}},
        {"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}}}};
    gltf.node()["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
        gltf.floats({0, 0, 0, 2, 0, 0}, "VEC3", 3);
    packQuadWithMeshopt(gltf);
    EXPECT_EQ(loadGltf(gltf.writeGltf(folder)).objects.size(), 2u);
    const json flat = gltf.root.flatten();
    const json values[] = {nullptr, -1, 1e30, "text", true, json::array(), json::object(), 4294967296};
    for (const auto& item : flat.items()) {
        for (const json& value : values) {
            json damaged = gltf.root;
            damaged[json::json_pointer(item.key())] = value;
            writeText(folder / "damaged.gltf", damaged.dump());
            const std::string message = errorOf([&] { loadGltf(folder / "damaged.gltf"); });
            EXPECT_TRUE(message.empty() || contains(message, "damaged.gltf")) << message;
        }
    }
}

} // namespace
} // namespace lumel::scene
