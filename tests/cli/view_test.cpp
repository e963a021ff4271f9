// The defaults of `shot`: camera, environment and ambient light, exposure.
#include "core/image.h"
#include "inputs.h"
#include "program.h"
#include <algorithm>

namespace lumel::cli {
namespace {

float largest(const Image& image)
{
    return *std::max_element(image.pixels.begin(), image.pixels.end());
}

class ShownView : public Program {
protected:
    // Of square.gltf, 64 x 48.
    Outcome shoot(const std::string& out, const std::vector<std::string>& more)
    {
        std::vector<std::string> arguments{"shot", "square.gltf", "--size", "64x48", "-o", out};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        return outcome;
    }
    Image picture(const std::string& out, const std::vector<std::string>& more)
    {
        shoot(out, more);
        return readImage(folder_ / out);
    }
};

using Ambient = ShownView;

TEST_F(Ambient, NoneIsNone)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    // A sun that shines on the square's back only.
    const std::vector<std::string> sun{"--light", "sun,0,0,1,1,1,1,3"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), sun.begin(), sun.end());
        return picture("out.exr", more);
    };
    EXPECT_EQ(largest(with({"--environment", "none"})), 0.0f);
    for (const char* shading : {"forward", "reference"})
        EXPECT_EQ(largest(with({"--environment", "none", "--shading", shading, "--samples", "2"})), 0.0f);
    // Without being asked for none, a sky of 4 % of the sun and a third of that below: its horizon is behind.
    const Image defaults = with({});
    EXPECT_NEAR(*defaults.at(0, 0), 0.04f * 3.0f * 2.0f / 3.0f, 1e-4f);
    EXPECT_GT(*defaults.at(32, 24), 0.02f);
    EXPECT_EQ(with({"--ambient", "0.12"}).pixels, defaults.pixels);
    EXPECT_EQ(with({"--ambient", "0.12", "--environment", "none"}).pixels, defaults.pixels);
    EXPECT_EQ(largest(with({"--ambient", "0"})), 0.0f);
    expectOneLine(run({"shot", "square.gltf", "-o", "a.png", "--ambient", "-1"}), 2, "--ambient");
}

TEST_F(Ambient, AddsToAnEnvironment)
{
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    Image grey(8, 4, 3);
    std::fill(grey.pixels.begin(), grey.pixels.end(), 0.25f);
    writeImage(folder_ / "grey.exr", grey);
    const std::vector<std::string> lights{"--environment", "grey.exr", "--light", "sun,0,0,1,1,1,1,3"};
    const Image without = picture("out.exr", lights);
    std::vector<std::string> more = lights;
    more.insert(more.end(), {"--ambient", "0.25"});
    const Image with = picture("out.exr", more);
    // A wall sees as much of the sky as of the ground: two thirds of 0.25 beside the 0.25 that are there.
    EXPECT_NEAR(*with.at(32, 24) / *without.at(32, 24), 1.0f + 2.0f / 3.0f, 0.05f);
    EXPECT_GT(*with.at(0, 0), *without.at(0, 0) + 0.1f);
}

// Adds a camera `distance` along z from the square that looks along -z, or turned by half a turn.
void addCamera(nlohmann::json& document, float distance, bool away)
{
    document["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 0.8}, {"znear", 0.01}}}}};
    document["nodes"].push_back({{"name", "front"}, {"camera", 0}, {"translation", {0, 0, distance}}});
    if (away)
        document["nodes"].back()["rotation"] = {0, 1, 0, 0};
    document["scenes"][0]["nodes"].push_back(document["nodes"].size() - 1);
}

using FirstCamera = ShownView;

TEST_F(FirstCamera, ThatSeesNothingIsNotTheDefault)
{
    nlohmann::json document = squareScene(folder_ / "square.gltf");
    writeScene(folder_ / "square.gltf", document);
    const Image framed = picture("framed.png", {});
    for (const float distance : {3.0f, -3.0f}) { // turned away; behind the square, whose back is not drawn
        nlohmann::json blind = document;
        addCamera(blind, distance, distance > 0.0f);
        if (distance < 0.0f)
            blind["nodes"].back()["rotation"] = {0, 1, 0, 0};
        writeScene(folder_ / "square.gltf", blind);
        const Outcome outcome = shoot("out.png", {});
        EXPECT_NE(outcome.err.find("square.gltf: its camera 'front' sees nothing"), std::string::npos)
            << outcome.err;
        EXPECT_EQ(readImage(folder_ / "out.png").pixels, framed.pixels);
        const Outcome insists = shoot("out.png", {"--camera", "front"});
        EXPECT_EQ(insists.err.find("sees nothing"), std::string::npos) << insists.err;
    }
    nlohmann::json fine = document;
    addCamera(fine, 3.0f, false);
    writeScene(folder_ / "square.gltf", fine);
    const Outcome outcome = shoot("out.png", {});
    EXPECT_EQ(outcome.err.find("sees nothing"), std::string::npos) << outcome.err;
    EXPECT_EQ(readText(folder_ / "out.png"),
              (shoot("0.png", {"--camera", "0"}), readText(folder_ / "0.png")));
}

TEST_F(FirstCamera, ThatIsFlownIntoViewIsKept)
{
    nlohmann::json document = squareScene(folder_ / "square.gltf");
    addCamera(document, 3.0f, false);
    document["nodes"][1]["translation"] = {50, 0, 3};
    addMotion(document, folder_ / "square.gltf", 1, {50, 0, 3}, {0, 0, 3});
    writeScene(folder_ / "square.gltf", document);
    EXPECT_EQ(shoot("out.png", {}).err.find("sees nothing"), std::string::npos);
}

class Exposure : public ShownView {
protected:
    void writeLit(const char* type, float intensity)
    {
        nlohmann::json document = squareScene(folder_ / "square.gltf");
        addLight(document, type, intensity);
        writeScene(folder_ / "square.gltf", document);
    }
    // The number in "exposure N (auto)"; empty: nothing of the kind is said.
    static std::string saidExposure(const Outcome& outcome)
    {
        const size_t from = outcome.err.find("exposure "), to = outcome.err.find(" (auto)");
        return from == std::string::npos || to == std::string::npos
                   ? ""
                   : outcome.err.substr(from + 9, to - from - 9);
    }
};

TEST_F(Exposure, RealWorldLightsComeOutNeitherWhiteNorBlack)
{
    const struct {
        const char* type;
        float intensity;
    } lights[] = {{"directional", 100000.0f}, {"point", 1500.0f}, {"directional", 0.01f}};
    for (const auto& light : lights) {
        writeLit(light.type, light.intensity);
        const Image plain = picture("one.png", {"--exposure", "1"});
        const float middle = *plain.at(32, 24);
        EXPECT_TRUE(middle > 0.95f || middle < 0.05f) << middle; // what it is about
        const Outcome outcome = shoot("auto.png", {"--stats", "s.json"});
        const std::string said = saidExposure(outcome);
        ASSERT_FALSE(said.empty()) << outcome.err;
        const Image seen = readImage(folder_ / "auto.png");
        EXPECT_GT(*seen.at(32, 24), 0.3f) << light.intensity;
        EXPECT_LT(*seen.at(32, 24), 0.75f) << light.intensity;
        // The printed number repeats the picture, and every way of shading says the same one.
        shoot("again.png", {"--exposure", said});
        EXPECT_EQ(readText(folder_ / "auto.png"), readText(folder_ / "again.png"));
        for (const char* shading : {"forward", "reference"})
            EXPECT_EQ(saidExposure(shoot("a.png", {"--shading", shading, "--samples", "4"})), said);
        const auto stats = nlohmann::json::parse(readText(folder_ / "s.json"));
        EXPECT_FLOAT_EQ(stats["frames"][0]["exposure"], std::stof(said));
        EXPECT_EQ(std::stof(stats["options"]["exposure"].get<std::string>()), std::stof(said));
    }
}

TEST_F(Exposure, StaysOneWhereThatSuffices)
{
    writeLit("directional", 3.0f);
    EXPECT_EQ(saidExposure(shoot("defaults.png", {})), "");
    shoot("one.png", {"--exposure", "1"});
    EXPECT_EQ(readText(folder_ / "defaults.png"), readText(folder_ / "one.png"));
    EXPECT_NE(saidExposure(shoot("auto.png", {"--exposure", "auto"})), ""); // asked for
    // Lights of the command line are its user's, and a scene without gets none of it.
    EXPECT_EQ(saidExposure(shoot("sun.png", {"--light", "sun,0,0,-1,1,1,1,100000"})), "");
    writeScene(folder_ / "square.gltf", squareScene(folder_ / "square.gltf"));
    EXPECT_EQ(saidExposure(shoot("sky.png", {"--environment-intensity", "1000"})), "");
    for (const char* wrong : {"0", "-1", "bright", "1x", "inf", "nan"})
        expectOneLine(run({"shot", "square.gltf", "-o", "a.png", "--exposure", wrong}), 2, "--exposure");
}

TEST_F(Exposure, OfAnAnimationIsThatOfItsFirstFrameAndRadianceIsRadiance)
{
    writeLit("directional", 100000.0f);
    const Outcome outcome =
        shoot("f_%d.png", {"--frames", "3", "--path", "orbit", "--step", "20", "--stats", "s.json"});
    const auto stats = nlohmann::json::parse(readText(folder_ / "s.json"));
    for (const auto& frame : stats["frames"])
        EXPECT_FLOAT_EQ(frame["exposure"], std::stof(saidExposure(outcome)));
    const Image automatic = picture("a.exr", {}), plain = picture("b.exr", {"--exposure", "1"});
    EXPECT_EQ(automatic.pixels, plain.pixels);
    EXPECT_GT(largest(automatic), 1000.0f);
}

TEST_F(Exposure, OfABenchIsOneForAllItsRuns)
{
    writeLit("directional", 100000.0f);
    const Outcome outcome =
        run({"bench",     "square.gltf", "--size", "64x48", "--shading", "tsl,forward", "--frames",      "2",
             "--warmup",  "2",           "--path", "orbit", "--step",    "20",          "--error-every", "1",
             "--samples", "16",          "--json", "b.json"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const auto runs = nlohmann::json::parse(readText(folder_ / "b.json"))["runs"];
    const float exposure = std::stof(saidExposure(outcome));
    for (const auto& run : runs)
        for (const auto& frame : run["frames"]) {
            EXPECT_FLOAT_EQ(frame["exposure"], exposure);
            EXPECT_LT(frame["error_rmse"], 0.05);
        }
}

} // namespace
} // namespace lumel::cli
