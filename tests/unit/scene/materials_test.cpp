// The bake cache: hits, misses, and entries that are never trusted.
#include "core/file.h"
#include "gltf_builder.h"
#include "scene/bake_cache.h"
#include "scene/materials.h"
#include "scene/own_chains.h"
#include "shared/energy.h"
#include <chrono>
#include <csignal>
#include <set>

namespace lumel::scene {
namespace {

namespace fs = std::filesystem;

struct Materials : testing::Test {
    TemporaryFolder folder;
    Scene scene;
    MaterialOptions options;

    Materials()
    {
        setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
        options.method = baker::Method::lean; // closed form: fast
        scene.file = "test.gltf";
        Material material;
        material.name = "bumpy";
        material.normalImage =
            addImage([](int x, int y, int c) { return c == 2 ? 250 : 100 + (7 * x + 11 * y) % 60; });
        material.occlusionImage = addImage([](int x, int, int) { return 20 * x; });
        scene.materials = {material};
    }

    template<class Value>
    int addImage(const Value& value)
    {
        Image image(8, 8, 3);
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x)
                for (int c = 0; c < 3; ++c)
                    image.at(x, y)[c] = float(value(x, y, c)) / 255.0f;
        writeImage(folder / "image.png", image);
        SceneImage entry;
        entry.name = "image.png";
        entry.bytes = readFile(folder / "image.png");
        scene.images.push_back(entry);
        return int(scene.images.size()) - 1;
    }

    std::set<fs::path> cached() const
    {
        std::set<fs::path> files;
        if (fs::exists(folder / "lumel"))
            for (const auto& entry : fs::directory_iterator(folder / "lumel"))
                files.insert(entry.path());
        return files;
    }

    // Marks the files, so that writing them again is seen.
    void age() const
    {
        for (const fs::path& file : cached())
            fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::hours(24));
    }
    bool rewritten() const
    {
        for (const fs::path& file : cached())
            if (fs::last_write_time(file) > fs::file_time_type::clock::now() - std::chrono::hours(12))
                return true;
        return false;
    }
};

void expectEqual(const HalfChain& a, const HalfChain& b)
{
    EXPECT_EQ(a.size(), b.size());
    EXPECT_TRUE(std::ranges::equal(a.bytes(), b.bytes()));
}

void expectEqual(const BakedMaterial& a, const BakedMaterial& b)
{
    expectEqual(a.reflectance.normal, b.reflectance.normal);
    expectEqual(a.reflectance.specular, b.reflectance.specular);
    expectEqual(a.reflectance.diffuse, b.reflectance.diffuse);
    expectEqual(a.reflectance.base, b.reflectance.base);
    expectEqual(a.emissive, b.emissive);
}

TEST_F(Materials, ChainsHaveTheSizeOfTheirMaps)
{
    scene.materials.push_back(Material{});
    scene.materials[1].baseColor = {0.25f, 0.5f, 0.75f, 1.0f};
    scene.materials[1].metallic = 0.0f;
    scene.materials[1].emissive = {1, 2, 3};
    const auto baked = bakeMaterials(scene, options);
    ASSERT_EQ(baked.size(), 2u);
    ASSERT_EQ(baked[0].reflectance.levels(), 4u);
    EXPECT_EQ(baked[0].reflectance.size(), glm::ivec2(8));
    EXPECT_EQ(baked[0].emissive.levels(), 4u);
    ASSERT_EQ(baked[1].reflectance.levels(), 1u) << "constant";
    const auto texel = baked[1].reflectance.at(0, 0, 0);
    EXPECT_NEAR(texel[baker::kKdB], 0.75f * 0.96f, 1e-3f);
    EXPECT_NEAR(texel[baker::kKsG], shared::specularStrength(glm::vec3(0.04f), {1.0f, 0.0f, 1.0f}).x, 1e-4f);
    EXPECT_NEAR(texel[baker::kNx], 0.0f, 1e-6f);
    ASSERT_EQ(baked[1].emissive.levels(), 1u);
    EXPECT_EQ(baked[1].emissive.at(0, 0, 0), glm::vec4(1, 2, 3, 1));
}

TEST_F(Materials, SecondTimeComesFromTheCacheAndIsTheSame)
{
    const auto first = bakeMaterials(scene, options);
    EXPECT_EQ(cached().size(), 2u); // the maps, and the key of these inputs
    age();
    const auto second = bakeMaterials(scene, options);
    EXPECT_FALSE(rewritten());
    expectEqual(first[0], second[0]);
}

TEST_F(Materials, PlaceholdersAreReplacedOneByOneByWhatIsBaked)
{
    options.method = baker::Method::fit;
    scene.materials.push_back(scene.materials[0]);
    scene.materials.push_back(scene.materials[0]); // equal to the first
    scene.materials[1].roughness = 0.3f;
    MaterialBaker baker(scene, options);
    std::vector<BakedMaterial> shown = baker.placeholders();
    EXPECT_EQ(baker.pending(), (std::set<size_t>{0, 1, 2}));
    EXPECT_TRUE(cached().empty());
    std::vector<std::vector<size_t>> order;
    while (const auto bake = baker.next()) {
        for (const size_t material : bake->materials)
            shown[material].reflectance = bake->reflectance;
        order.push_back(bake->materials);
        EXPECT_EQ(cached().size(), 2 * order.size()) << "each is stored at once";
    }
    EXPECT_EQ(order, (std::vector<std::vector<size_t>>{{0, 2}, {1}}));
    options.useCache = false;
    const auto baked = bakeMaterials(scene, options);
    for (size_t i = 0; i < baked.size(); ++i)
        expectEqual(shown[i], baked[i]);
    options.useCache = true;
    MaterialBaker again(scene, options);
    again.placeholders();
    EXPECT_TRUE(again.pending().empty());
}

TEST_F(Materials, PlaceholdersHaveTheSizesAndTheFinestLevelOfWhatIsBaked)
{
    options.method = baker::Method::fit;
    MaterialBaker baker(scene, options);
    const BakedMaterial placeholder = baker.placeholders()[0];
    const BakedMaterial baked = bakeMaterials(scene, options)[0];
    expectEqual(placeholder.emissive, baked.emissive);
    expectEqual(placeholder.reflectance.base, baked.reflectance.base);
    ASSERT_EQ(placeholder.reflectance.levels(), baked.reflectance.levels());
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x)
            EXPECT_EQ(placeholder.reflectance.at(0, x, y), baked.reflectance.at(0, x, y));
}

TEST_F(Materials, QuickIsWhatThePlaceholdersAre)
{
    options.method = baker::Method::fit;
    options.quick = true;
    const auto quick = bakeMaterials(scene, options);
    EXPECT_TRUE(cached().empty());
    expectEqual(quick[0], MaterialBaker(scene, options).placeholders()[0]);
}

// A model's own chain, told from what is baked of its maps by a diffuse colour of its own.
struct OwnChains : Materials {
    OwnChains()
    {
        baker::Maps maps;
        maps.normal = Image(8, 8, 3);
        std::ranges::fill(maps.normal.pixels, 0.5f);
        maps.diffuseConstant = glm::vec3(0.125f);
        baker::writeExr(folder / "own.exr", baker::bake(maps, {.method = baker::Method::lean,
                                                               .model = baker::Model::blinnPhong}));
        maps.diffuseConstant = glm::vec3(0.25f);
        baker::writeExr(folder / "given.exr", baker::bake(maps, {.method = baker::Method::average}));
        scene.materials[0].ownChain = folder / "own.exr";
        options.method = baker::Method::fit; // a default
        options.useCache = false;
    }

    void setMaps() { scene.materials[0].ownMaps = mapsHash(scene.materials[0], hashes()); }
    std::vector<std::string> hashes() const
    {
        std::vector<std::string> hashes;
        for (const SceneImage& image : scene.images)
            hashes.push_back(imageHash(image.bytes));
        return hashes;
    }
    float diffuse() const { return bakeMaterials(scene, options)[0].reflectance.at(0, 0, 0)[baker::kKdR]; }
    bool isOwn() const { return diffuse() == 0.125f; }
};

TEST_F(OwnChains, CountUnlessSomethingElseIsAskedFor)
{
    EXPECT_TRUE(isOwn()) << "defaults ask for nothing";
    options.asked.method = true;
    EXPECT_FALSE(isOwn()) << "fit in place of lean";
    options.method = baker::Method::lean;
    EXPECT_TRUE(isOwn());
    options.asked.model = true;
    EXPECT_FALSE(isOwn());
    options.model = baker::Model::blinnPhong;
    EXPECT_TRUE(isOwn());
    options.asked.lobes = true;
    options.lobes = baker::LobeCount::two;
    EXPECT_TRUE(isOwn()) << "closed forms have one in any case";
}

TEST_F(OwnChains, OfTheFitTellTheirLobes)
{
    baker::Maps maps;
    maps.normal = Image(8, 8, 3);
    std::ranges::fill(maps.normal.pixels, 0.5f);
    maps.diffuseConstant = glm::vec3(0.125f);
    baker::writeExr(folder / "own.exr", baker::bake(maps, {.lobes = baker::LobeCount::two}));
    options.asked.lobes = true;
    for (const auto lobes : {baker::LobeCount::one, baker::LobeCount::two, baker::LobeCount::automatic}) {
        options.lobes = lobes;
        EXPECT_EQ(isOwn(), lobes == baker::LobeCount::two);
    }
}

TEST_F(OwnChains, DoNotCountOnceTheirMapsHaveChanged)
{
    setMaps();
    EXPECT_TRUE(isOwn());
    scene.materials[0].emissive = glm::vec3(2.0f);
    EXPECT_TRUE(isOwn()) << "no part of the chain";
    scene.materials[0].roughness = 0.25f;
    EXPECT_FALSE(isOwn());
    setMaps();
    EXPECT_TRUE(isOwn());
    scene.materials[0].normalImage = addImage([](int x, int y, int) { return 100 + x + y; });
    EXPECT_FALSE(isOwn());
}

TEST_F(OwnChains, YieldToAChainThatIsGiven)
{
    scene.materials[0].ownMaps = "of other maps";
    scene.materials[0].bakedFile = folder / "given.exr";
    options.asked = {.method = true, .model = true, .lobes = true};
    EXPECT_EQ(diffuse(), 0.25f);
}

TEST_F(OwnChains, ThatAreDamagedAreSaid)
{
    writeText(folder / "own.exr", "no chain");
    EXPECT_TRUE(contains(errorOf([&] { bakeMaterials(scene, options); }), "own.exr"));
}

TEST_F(Materials, HitsDecodeNothing)
{
    const BakeCache cache(scene, options);
    const auto first = bakeMaterials(scene, options);
    const std::string inputKey = cache.inputKey(scene.materials[0]);
    for (SceneImage& image : scene.images)
        image.bytes.clear(); // would throw
    const auto key = cache.recall(inputKey);
    ASSERT_TRUE(key);
    const auto found = cache.load(*key);
    ASSERT_TRUE(found);
    expectEqual(first[0], *found);
}

TEST_F(Materials, CacheCanBeSwitchedOff)
{
    options.useCache = false;
    bakeMaterials(scene, options);
    EXPECT_TRUE(cached().empty());
}

TEST_F(Materials, EqualMaterialsAreBakedOnce)
{
    scene.materials.push_back(scene.materials[0]);
    scene.materials[1].name = "another name";
    const auto baked = bakeMaterials(scene, options);
    EXPECT_EQ(cached().size(), 2u);
    expectEqual(baked[0], baked[1]);
}

TEST_F(Materials, DamagedEntriesAreBakedAgainAndReplaced)
{
    const auto good = bakeMaterials(scene, options);
    std::map<fs::path, std::string> contents;
    for (const fs::path& file : cached())
        contents[file] = readText(file);
    for (const auto& [file, text] : contents) {
        std::string flipped = text;
        flipped[flipped.size() / 2] ^= 0x10;
        for (const std::string& damage :
             {std::string(), text.substr(0, text.size() / 2), flipped, text + "more", std::string("hello")}) {
            writeText(file, damage);
            age();
            const auto again = bakeMaterials(scene, options);
            expectEqual(good[0], again[0]);
            EXPECT_TRUE(rewritten()) << file;
            EXPECT_NE(readText(file), damage) << file;
        }
        fs::remove(file);
        expectEqual(good[0], bakeMaterials(scene, options)[0]);
        age();
        expectEqual(good[0], bakeMaterials(scene, options)[0]);
        EXPECT_FALSE(rewritten()) << "found again after " << file;
    }
}

TEST_F(Materials, EntriesOfOtherMaterialsAreNotTrusted)
{
    const auto good = bakeMaterials(scene, options);
    Scene other = scene;
    other.materials[0].roughness = 0.3f;
    other.materials[0].normalImage = -1; // its chain has another size, too
    bakeMaterials(other, options);
    const auto keyOf = [&](const Scene& s) {
        const BakeCache cache(s, options);
        return cache.recall(cache.inputKey(s.materials[0])).value();
    };
    const std::string ours = keyOf(scene), theirs = keyOf(other);
    fs::copy_file(folder / ("lumel/" + theirs + ".maps"), folder / ("lumel/" + ours + ".maps"),
                  fs::copy_options::overwrite_existing); // whole, valid, and of something else
    expectEqual(good[0], bakeMaterials(scene, options)[0]);
}

TEST_F(Materials, UnusableCacheFolderIsNoError)
{
    writeText(folder / "lumel", "a file where the folder should be");
    EXPECT_EQ(bakeMaterials(scene, options).size(), 1u);
    setenv("XDG_CACHE_HOME", "/proc/nothing-can-be-made-here", 1);
    EXPECT_EQ(bakeMaterials(scene, options).size(), 1u);
}

TEST_F(Materials, UnreadableEntriesAreNoError)
{
    bakeMaterials(scene, options);
    for (const fs::path& file : cached()) {
        fs::remove(file);
        fs::create_directory(file); // neither readable nor replaceable
    }
    EXPECT_EQ(bakeMaterials(scene, options).size(), 1u);
}

TEST_F(Materials, ErrorsNameTheModelAndTheMaterial)
{
    scene.materials[0].heightImage = 0;
    scene.materials[0].heightScale = 0.0f; // the baker refuses
    const std::string message = errorOf([&] { bakeMaterials(scene, options); });
    EXPECT_TRUE(contains(message, "test.gltf")) << message;
    EXPECT_TRUE(contains(message, "bumpy")) << message;
}

TEST_F(Materials, InterruptLeavesNothingBehind)
{
    // In a process of its own, because the flag stays up.
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(
        {
            catchInterrupts();
            std::raise(SIGINT);
            try {
                bakeMaterials(scene, options);
                std::exit(1);
            } catch (const Interrupted&) {
                std::exit(cached().empty() ? 0 : 2);
            }
        },
        testing::ExitedWithCode(0), "");
}

} // namespace
} // namespace lumel::scene
