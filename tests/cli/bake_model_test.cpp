// lumel bake MODEL: what is written, what stays as it is, and that the result looks the same.
#include "core/compare.h"
#include "core/image.h"
#include "inputs.h"
#include "program.h"
#include <cstring>
#include <set>

namespace lumel::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class BakeModel : public Program {
protected:
    // A square with a normal and a roughness map, and things that Lumel does not know.
    json unevenSquare()
    {
        json scene = squareScene(folder_ / "square.gltf");
        Image normal(32, 32, 3), rough(32, 32, 3);
        for (int y = 0; y < 32; ++y)
            for (int x = 0; x < 32; ++x) {
                const float values[] = {0.5f + 0.2f * std::sin(0.8f * float(x)),
                                        0.5f + 0.2f * std::cos(0.5f * float(y)), 0.95f};
                std::copy_n(values, 3, normal.at(x, y));
                const float packed[] = {0.25f, 0.3f + 0.6f * float((x * 5 + y * 3) % 32) / 32.0f,
                                        x > 16 ? 1.0f : 0.0f};
                std::copy_n(packed, 3, rough.at(x, y));
            }
        writeImage(folder_ / "normal.png", normal);
        writeImage(folder_ / "rough.png", rough);
        scene["images"] = {{{"uri", "normal.png"}, {"name", "first"}}, {{"uri", "rough.png"}}};
        scene["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33071}}};
        scene["textures"] = {{{"source", 0}, {"sampler", 0}}, {{"source", 1}, {"sampler", 0}}};
        scene["materials"][0] = {
            {"name", "uneven"},
            {"pbrMetallicRoughness",
             {{"baseColorFactor", {0.8, 0.6, 0.4, 1.0}},
              {"metallicRoughnessTexture", {{"index", 1}}},
              {"roughnessFactor", 0.9},
              {"metallicFactor", 0.7}}},
            {"normalTexture", {{"index", 0}, {"scale", 0.5}}},
            {"extensions", {{"VENDOR_moss", {{"density", 0.125}, {"mossTexture", {{"index", 1}}}}}}},
            {"extras", {{"shelf", 7}, {"lumel", {{"note", "kept"}}}}}};
        scene["extensionsUsed"] = {"VENDOR_moss"};
        scene["extensions"] = {{"VENDOR_moss", {{"seeds", {1, 2.5, 1e-7, 12345678901}}}}};
        scene["nodes"][0]["extras"] = {{"tag", "a \"quoted\" name"}};
        writeScene(folder_ / "square.gltf", scene);
        return scene;
    }

    json jsonOf(const fs::path& file) const
    {
        const std::string bytes = readText(folder_ / file);
        if (bytes.substr(0, 4) != "glTF")
            return json::parse(bytes);
        uint32_t length = 0;
        std::memcpy(&length, &bytes[12], 4);
        return json::parse(bytes.substr(20, length));
    }

    double psnrOf(const std::string& a, const std::string& b)
    {
        for (const std::string& model : {a, b}) {
            const Outcome outcome = run({"shot", model, "-o", model + ".png", "--size", "128x128", "--eye",
                                         "0.3,0.2,1.5", "--target", "0,0,0"});
            EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        }
        return compareImages(readImage(folder_ / (a + ".png")), readImage(folder_ / (b + ".png"))).psnr;
    }
};

// The same document but for what the bake adds to it and to the material.
void expectKept(const json& before, json after)
{
    const json material = after.at("materials")[0];
    EXPECT_EQ(material.at("extras").at("shelf"), 7);
    EXPECT_EQ(material.at("extras").at("lumel").at("note"), "kept");
    EXPECT_EQ(material.at("extensions"), before.at("materials")[0].at("extensions"));
    for (const char* key : {"baseColorFactor", "metallicFactor"})
        EXPECT_EQ(material.at("pbrMetallicRoughness").at(key),
                  before.at("materials")[0].at("pbrMetallicRoughness").at(key));
    for (const char* key : {"asset", "accessors", "meshes", "nodes", "scenes", "scene", "samplers",
                            "extensionsUsed", "extensions"})
        EXPECT_EQ(after.at(key), before.at(key)) << key;
    for (const char* key : {"bufferViews", "textures"})
        for (size_t i = 0; i < before.at(key).size(); ++i)
            EXPECT_EQ(after.at(key)[i], before.at(key)[i]) << key << i;
}

TEST_F(BakeModel, WhatIsNotKnownStaysAsItIs)
{
    const json before = unevenSquare();
    for (const std::string output : {"baked.glb", "baked.gltf"}) {
        const Outcome outcome = run({"bake", "square.gltf", "-o", output});
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_NE(outcome.out.find("1 of 1 materials"), std::string::npos);
        const json after = jsonOf(output);
        expectKept(before, after);
        const json& material = after.at("materials")[0];
        EXPECT_EQ(material.at("extras").at("lumel").at("baked"), "baked_0.exr");
        const size_t normal = material.at("normalTexture").at("index");
        EXPECT_EQ(after.at("textures")[normal].at("sampler"), 0);
        EXPECT_FALSE(material.at("normalTexture").contains("scale")); // in the map now
        EXPECT_FALSE(material.at("pbrMetallicRoughness").contains("roughnessFactor"));
        EXPECT_TRUE(fs::exists(folder_ / "baked_0.exr"));
    }
}

TEST_F(BakeModel, LooksTheSameWithItsBakeAndByItsMaps)
{
    unevenSquare();
    ASSERT_EQ(run({"bake", "square.gltf", "-o", "baked.glb"}).exitCode, 0);
    EXPECT_GT(psnrOf("square.gltf", "baked.glb"), 60.0);
    fs::remove(folder_ / "baked_0.exr");
    EXPECT_GT(psnrOf("square.gltf", "baked.glb"), 40.0);
}

// One line says where a model's own chain is not what is asked for, or no longer fits its maps.
TEST_F(BakeModel, ItsChainYieldsToOptionsAndToChangedMaps)
{
    unevenSquare();
    for (const std::string model : {"baked.gltf", "baked.glb"}) {
        ASSERT_EQ(run({"bake", "square.gltf", "-o", model}).exitCode, 0);
        const auto shot = [&](std::vector<std::string> options) {
            std::vector<std::string> words{"shot", model, "-o", "a.png", "--size", "32x32"};
            words.insert(words.end(), options.begin(), options.end());
            const Outcome outcome = run(words);
            EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
            return outcome.err;
        };
        const auto lines = [](const std::string& text) { return std::ranges::count(text, '\n'); };
        const std::string usual = shot({});
        EXPECT_EQ(usual.find("own chain"), std::string::npos) << usual;
        EXPECT_EQ(shot({"--filter", "fit", "--lobes", "auto"}), usual);
        EXPECT_EQ(shot({"--filter", "average", "--material", "uneven=baked_0.exr"}), usual);
        const std::string averaged = shot({"--filter", "average", "--no-cache"});
        EXPECT_NE(averaged.find("'uneven': method average in place of fit"), std::string::npos) << averaged;
        EXPECT_NE(shot({"--lobes", "1"}).find("lobes 1 in place of auto"), std::string::npos);
        EXPECT_GT(lines(averaged), lines(usual));
    }
    Image rough = readImage(folder_ / "baked_0_metallic_roughness.png");
    rough.pixels[1] = 1.0f - rough.pixels[1];
    writeImage(folder_ / "baked_0_metallic_roughness.png", rough);
    const Outcome changed = run({"shot", "baked.gltf", "-o", "a.png", "--size", "32x32"});
    EXPECT_EQ(changed.exitCode, 0);
    EXPECT_NE(changed.err.find("'uneven': textures or factors have changed"), std::string::npos)
        << changed.err;
}

TEST_F(BakeModel, ABakeForgetsTheOneBefore)
{
    json scene = unevenSquare();
    scene["materials"][0]["extras"] = "any text";
    writeScene(folder_ / "square.gltf", scene);
    ASSERT_EQ(run({"bake", "square.gltf", "-o", "first.gltf", "--textures", "ktx2"}).exitCode, 0);
    const json extras = jsonOf("first.gltf").at("materials")[0].at("extras");
    EXPECT_EQ(extras.at("extras"), "any text");
    EXPECT_TRUE(extras.at("lumel").contains("textures"));
    ASSERT_EQ(run({"bake", "first.gltf", "-o", "second.gltf"}).exitCode, 0);
    const json ours = jsonOf("second.gltf").at("materials")[0].at("extras").at("lumel");
    EXPECT_EQ(ours.at("baked"), "second_0.exr");
    EXPECT_NE(ours.at("maps"), extras.at("lumel").at("maps"));
    EXPECT_FALSE(ours.contains("textures"));
}

TEST_F(BakeModel, MapsOfLevelZeroAreThoseOfTheModel)
{
    unevenSquare();
    ASSERT_EQ(run({"bake", "square.gltf", "-o", "baked.gltf"}).exitCode, 0);
    const Image before = readImage(folder_ / "rough.png");
    const Image after = readImage(folder_ / "baked_0_metallic_roughness.png");
    for (size_t i = 0; i < before.pixels.size(); i += 3) {
        EXPECT_NEAR(after.pixels[i + 1], 0.9f * before.pixels[i + 1], 3e-3f); // the factor is in the map
        EXPECT_EQ(after.pixels[i + 2], before.pixels[i + 2]);
    }
}

TEST_F(BakeModel, Ktx2FilesHoldAllLevelsBesideIt)
{
    unevenSquare();
    ASSERT_EQ(run({"bake", "square.gltf", "-o", "baked.glb", "--textures", "ktx2"}).exitCode, 0);
    const json textures = jsonOf("baked.glb").at("materials")[0].at("extras").at("lumel").at("textures");
    for (const char* map : {"normal", "metallic_roughness"}) {
        const std::string bytes = readText(folder_ / textures.at(map).get<std::string>());
        ASSERT_GT(bytes.size(), 80u);
        EXPECT_EQ(bytes.substr(1, 6), "KTX 20");
        EXPECT_EQ(bytes[40], 6); // levels of 32 x 32
    }
}

TEST_F(BakeModel, FilesOfTheModelComeAlong)
{
    unevenSquare();
    fs::create_directory(folder_ / "out");
    ASSERT_EQ(run({"bake", "square.gltf", "-o", "out/baked.gltf"}).exitCode, 0);
    EXPECT_EQ(readText(folder_ / "out/square.bin"), readText(folder_ / "square.bin"));
    EXPECT_EQ(readText(folder_ / "out/rough.png"), readText(folder_ / "rough.png"));
    EXPECT_EQ(run({"shot", "out/baked.gltf", "-o", "a.png", "--size", "32x32"}).exitCode, 0);
    // Again, from what was written.
    ASSERT_EQ(run({"bake", "out/baked.gltf", "-o", "again.glb"}).exitCode, 0);
    EXPECT_EQ(run({"shot", "again.glb", "-o", "b.png", "--size", "32x32"}).exitCode, 0);
}

TEST_F(BakeModel, BadInputLeavesNothingBehind)
{
    unevenSquare();
    std::set<std::string> before;
    const auto files = [&] {
        std::set<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder_))
            names.insert(entry.path().filename().string());
        return names;
    };
    writeText(folder_ / "notes.glb", "no model");
    writeText(folder_ / "rough.png", "no picture");
    before = files();
    expectOneLine(run({"bake", "square.gltf", "-o", "baked.glb"}), 1, "rough.png");
    expectOneLine(run({"bake", "notes.glb", "-o", "baked.glb"}), 1, "notes.glb");
    expectOneLine(run({"bake", "nowhere.glb", "-o", "baked.glb"}), 1, "nowhere.glb");
    expectOneLine(run({"bake", "square.gltf", "-o", "none/baked.glb"}), 1, "none");
    expectOneLine(run({"bake", "square.gltf", "-o", "square.gltf"}), 1, "the model itself");
    expectOneLine(run({"bake", "square.gltf", "-o", "baked.exr"}), 2, "--output");
    expectOneLine(run({"bake", "square.gltf", "--power", "3", "-o", "baked.glb"}), 2, "--power");
    EXPECT_EQ(files(), before);
}

// A library of materials: no meshes, so no buffers.
TEST_F(BakeModel, ModelsWithoutBuffersAreBaked)
{
    json library = unevenSquare();
    for (const char* key : {"buffers", "bufferViews", "accessors", "meshes", "nodes", "scenes", "scene"})
        library.erase(key);
    writeText(folder_ / "library.gltf", library.dump());
    for (const std::string output : {"baked.glb", "baked.gltf"}) {
        const Outcome outcome = run({"bake", "library.gltf", "-o", output});
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        const json after = jsonOf(output);
        EXPECT_EQ(after.at("materials")[0].at("extras").at("lumel").at("baked"), "baked_0.exr");
        for (const json& image : after.at("images"))
            EXPECT_EQ(image.contains("bufferView"), output == "baked.glb");
    }
    library["materials"] = json::array();
    writeText(folder_ / "library.gltf", library.dump());
    EXPECT_EQ(run({"bake", "library.gltf", "-o", "none.glb"}).exitCode, 0);
}

TEST_F(BakeModel, FilesThatTheModelReadsAreNotReplaced)
{
    json scene = unevenSquare();
    fs::rename(folder_ / "normal.png", folder_ / "out_0_normal.png");
    scene["images"][0]["uri"] = "out_0_normal.png";
    writeScene(folder_ / "square.gltf", scene);
    const std::string before = readText(folder_ / "out_0_normal.png");
    fs::create_directory(folder_ / "there");
    for (const std::string output : {"out.gltf", "there/out.gltf"})
        expectOneLine(run({"bake", "square.gltf", "-o", output}), 1, "out_0_normal.png");
    EXPECT_EQ(readText(folder_ / "out_0_normal.png"), before);
    EXPECT_FALSE(fs::exists(folder_ / "out_0.exr"));
    EXPECT_TRUE(fs::is_empty(folder_ / "there"));
    EXPECT_EQ(run({"bake", "square.gltf", "-o", "out.glb"}).exitCode, 0) << "which holds its images";
}

TEST_F(BakeModel, BakesOfMapsAreExportedToo)
{
    writeHeightMap(folder_ / "h.png", 24, 16);
    const Outcome outcome = run({"bake", "--height", "h.png", "--height-scale", "0.02", "-o", "rock.exr",
                                 "--export", "out", "--to", "dds"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_TRUE(fs::exists(folder_ / "out/rock_normal.dds"));
    expectOneLine(run({"bake", "--height", "h.png", "-o", "rock.exr", "--to", "dds"}), 2, "--to");
}

} // namespace
} // namespace lumel::cli
