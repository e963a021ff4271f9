// The cache's keys: every field of a material in turn, against what is baked.
#include "core/file.h"
#include "gltf_builder.h"
#include "scene/bake_cache.h"
#include "scene/material_fields.h"
#include "scene/material_maps.h"
#include "scene/own_chains.h"
#include <map>
#include <random>

namespace lumel::scene {
namespace {

// Another value of any field. Integers are indices of images.
void changeField(std::string& name)
{
    name += "!";
}
void changeField(std::filesystem::path&)
{
    // A baked file takes the place of all that is tested here.
}
void changeField(bool& flag)
{
    flag = !flag;
}
void changeField(float& value)
{
    value = 0.5f * value + 0.125f;
}
void changeField(glm::vec2& v)
{
    v = v * 2.0f + 0.25f;
}
void changeField(glm::vec3& v)
{
    v.y = 0.5f * v.y + 0.125f;
}
void changeField(glm::vec4& v)
{
    v.z = 0.5f * v.z + 0.125f;
}
void changeField(int& image)
{
    image = image == 0 ? 1 : 0;
}
void changeField(AlphaMode& mode)
{
    mode = AlphaMode::blend;
}
void changeField(Wrap& wrap)
{
    wrap = wrap == Wrap::clamp ? Wrap::mirror : Wrap::clamp;
}

// `material` with one field changed, for each field in turn; of mappings, each of theirs.
std::vector<Material> variants(const Material& material)
{
    std::vector<Material> all;
    for (int n = 0;; ++n) {
        Material changed = material;
        int i = 0;
        const auto visit = [&](auto& field) {
            const auto one = [&](auto& value) {
                if (i++ == n)
                    changeField(value);
            };
            if constexpr (std::is_same_v<decltype(field), UvMapping&>)
                forEachUvMappingField(field, one);
            else
                one(field);
        };
        forEachMaterialField(changed, visit);
        if (n >= i)
            return all;
        all.push_back(changed);
    }
}

// All that a bake gives, as numbers.
std::vector<float> numbersOf(const baker::ReflectanceMips& reflectance, const Image& emissive)
{
    std::vector<float> numbers;
    for (const baker::Level& level : reflectance.levels) {
        numbers.insert(numbers.end(), {float(level.width), float(level.height)});
        numbers.insert(numbers.end(), level.texels.begin(), level.texels.end());
    }
    numbers.insert(numbers.end(), {float(emissive.width), float(emissive.height)});
    numbers.insert(numbers.end(), emissive.pixels.begin(), emissive.pixels.end());
    return numbers;
}

std::vector<uint16_t> numbersOf(const BakedMaterial& baked)
{
    std::vector<uint16_t> numbers;
    const Reflectance& r = baked.reflectance;
    for (const HalfChain* chain :
         {&r.normal, &r.specular, &r.diffuse, &r.base, &r.second, &r.secondSpecular, &baked.emissive}) {
        numbers.insert(numbers.end(), {uint16_t(chain->size().x), uint16_t(chain->size().y)});
        for (size_t level = 0; level < chain->levels(); ++level)
            numbers.insert(numbers.end(), chain->texels(level).begin(), chain->texels(level).end());
    }
    return numbers;
}

struct BakeKeys : testing::Test {
    TemporaryFolder folder;
    Scene scene;

    BakeKeys()
    {
        scene.file = "test.gltf";
        std::mt19937 random(3);
        for (const int size : {8, 8, 4}) {
            Image image(size, size, 4);
            for (float& value : image.pixels)
                value = 0.25f + 0.5f * float(random() % 256) / 255.0f;
            writeImage(folder / "image.png", image);
            scene.images.push_back({"image.png", readFile(folder / "image.png")});
        }
    }

    // Materials that between them read every field.
    static std::map<std::string, Material> materials()
    {
        Material plain;
        plain.normalImage = 0;
        plain.heightScale = 0.1f; // read once a height image is given
        plain.roughness = 0.6f;
        Material full = plain;
        full.baseColor = {0.8f, 0.6f, 0.9f, 1.0f};
        full.metallic = 0.7f;
        full.emissive = {0.5f, 0.25f, 1.0f};
        full.baseColorImage = full.occlusionImage = full.specularImage = full.anisotropyImage = 1;
        full.metallicRoughnessImage = full.emissiveImage = full.specularColorImage = 2;
        full.specularColor = {0.9f, 0.5f, 0.7f};
        full.anisotropy = 0.6f;
        full.anisotropyRotation = 0.4f;
        Material glossy = full;
        glossy.specularGlossiness = true;
        glossy.anisotropy = 0.0f;
        Material high = full;
        high.heightImage = 1;
        high.power = 50.0f;
        Material unlit = full;
        unlit.unlit = true;
        return {{"plain", plain}, {"full", full}, {"glossy", glossy}, {"high", high}, {"unlit", unlit}};
    }

    void cacheIn(const std::string& name) const { setenv("XDG_CACHE_HOME", (folder / name).c_str(), 1); }
    std::vector<uint16_t> bake(const Material& material, const std::string& cache)
    {
        cacheIn(cache);
        scene.materials = {material};
        return numbersOf(bakeMaterials(scene, {.method = baker::Method::lean}).front());
    }
};

TEST_F(BakeKeys, ChangeExactlyWhenTheResultDoes)
{
    cacheIn("cache");
    const BakeCache cache(scene, {});
    baker::Options options;
    options.method = baker::Method::lean; // fast
    const auto keyAndResult = [&](const Material& material) {
        const baker::Maps maps = reflectanceMaps(scene, material);
        const Image emissive = emissiveImage(scene, material);
        return std::pair(cache.key(maps, emissive), numbersOf(baker::bake(maps, options), emissive));
    };
    int changes = 0;
    for (const auto& [name, material] : materials()) {
        const auto [key, result] = keyAndResult(material);
        const std::vector<Material> all = variants(material);
        ASSERT_GT(all.size(), 70u);
        for (size_t i = 0; i < all.size(); ++i) {
            const auto [otherKey, otherResult] = keyAndResult(all[i]);
            EXPECT_EQ(otherKey != key, otherResult != result) << name << ", field " << i;
            if (otherResult != result) {
                EXPECT_NE(cache.inputKey(all[i]), cache.inputKey(material)) << name << ", field " << i;
            }
            changes += otherResult != result;
        }
    }
    EXPECT_GT(changes, 80); // the test tests something
}

TEST_F(BakeKeys, HashOfMapsChangesWhereverReflectanceDoes)
{
    const BakeCache cache(scene, {});
    const auto hash = [&](const Material& material) { return mapsHash(material, cache.imageHashes()); };
    const auto key = [&](const Material& material) {
        return cache.key(reflectanceMaps(scene, material), {});
    };
    int changes = 0;
    for (const auto& [name, material] : materials()) {
        const std::vector<Material> all = variants(material);
        for (size_t i = 0; i < all.size(); ++i)
            if (key(all[i]) != key(material)) {
                EXPECT_NE(hash(all[i]), hash(material)) << name << ", field " << i;
                ++changes;
            }
    }
    EXPECT_GT(changes, 60);
}

TEST_F(BakeKeys, HashOfMapsLeavesOutWhatAChainDoesNotHold)
{
    const BakeCache cache(scene, {});
    const auto hash = [&](const Material& material) { return mapsHash(material, cache.imageHashes()); };
    const Material full = materials().at("full");
    Material other = full;
    other.name = "another";
    other.baseColor.a = 0.5f;
    other.alphaMode = AlphaMode::blend;
    other.doubleSided = true;
    other.emissive = {1.0f, 2.0f, 3.0f};
    other.emissiveImage = other.occlusionImage = 0;
    for (UvMapping* uv : {&other.uv, &other.baseColorUv, &other.metallicRoughnessUv, &other.specularUv,
                          &other.specularColorUv, &other.anisotropyUv})
        uv->scale = glm::vec2(3.0f); // all tiled alike: the chain is, too
    EXPECT_EQ(hash(other), hash(full));
    other.baseColorUv.scale = glm::vec2(1.0f);
    EXPECT_NE(hash(other), hash(full));
    EXPECT_EQ(hash(Material{}), ContentHash().hex()) << "defaults add nothing: files outlive new fields";
}

// The same from outside: with a full cache, a changed material looks as it does with an empty one.
TEST_F(BakeKeys, AFullCacheGivesWhatAnEmptyOneDoes)
{
    const Material full = materials().at("full");
    const auto before = bake(full, "used");
    const std::vector<Material> all = variants(full);
    for (size_t i = 0; i < all.size(); ++i)
        EXPECT_EQ(bake(all[i], "used"), bake(all[i], "fresh" + std::to_string(i))) << "field " << i;
    EXPECT_EQ(bake(full, "used"), before);
}

TEST_F(BakeKeys, FollowImagesAndOptionsButNotThreadsAndNames)
{
    cacheIn("cache");
    const Material full = materials().at("full");
    const baker::Maps maps = reflectanceMaps(scene, full);
    const auto inputKey = [&](const MaterialOptions& options) {
        return BakeCache(scene, options).inputKey(full);
    };
    const auto key = [&](const MaterialOptions& options) { return BakeCache(scene, options).key(maps, {}); };
    const MaterialOptions defaults, threads{.threads = 3}, lean{.method = baker::Method::lean},
        two{.lobes = baker::LobeCount::two};
    EXPECT_EQ(inputKey(defaults), inputKey(threads));
    EXPECT_EQ(key(defaults), key(threads));
    EXPECT_NE(inputKey(defaults), inputKey(lean));
    EXPECT_NE(key(defaults), key(lean));
    EXPECT_NE(inputKey(defaults), inputKey(two));
    EXPECT_NE(key(defaults), key(two));
    Material renamed = full;
    renamed.name = "another";
    EXPECT_EQ(BakeCache(scene, defaults).inputKey(renamed), inputKey(defaults));
    const std::string before = inputKey(defaults);
    std::swap(scene.images[0], scene.images[1]);
    EXPECT_NE(inputKey(defaults), before);
    std::swap(scene.images[0], scene.images[1]);
    scene.images[2].bytes.back() ^= std::byte(1);
    EXPECT_NE(inputKey(defaults), before);
}

size_t entriesIn(const std::filesystem::path& cache)
{
    size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(cache / "lumel"))
        count += entry.path().extension() == ".maps";
    return count;
}

// Each material is stored as it is finished: what ends the bake of another loses none.
TEST_F(BakeKeys, AnInterruptedBakeKeepsWhatItFinished)
{
    cacheIn("cache");
    scene.images.push_back({"broken.png", std::vector<std::byte>(100)});
    Material broken = materials().at("plain");
    broken.normalImage = 3;
    scene.materials = {materials().at("plain"), broken, materials().at("full")};
    EXPECT_THROW(bakeMaterials(scene, {}), Error);
    EXPECT_EQ(entriesIn(folder / "cache"), 1u);
    scene.materials.erase(scene.materials.begin() + 1);
    const auto resumed = bakeMaterials(scene, {});
    EXPECT_EQ(entriesIn(folder / "cache"), 2u);
    cacheIn("fresh");
    const auto fresh = bakeMaterials(scene, {});
    for (size_t i = 0; i < fresh.size(); ++i)
        EXPECT_EQ(numbersOf(resumed[i]), numbersOf(fresh[i]));
}

TEST_F(BakeKeys, SecondLobesAreKept)
{
    cacheIn("cache");
    scene.materials = {materials().at("full")};
    const MaterialOptions two{.lobes = baker::LobeCount::two};
    const auto baked = bakeMaterials(scene, two), recalled = bakeMaterials(scene, two);
    EXPECT_EQ(entriesIn(folder / "cache"), 1u);
    EXPECT_TRUE(baked[0].reflectance.hasSecond());
    EXPECT_EQ(numbersOf(recalled[0]), numbersOf(baked[0]));
    const MaterialOptions one{.lobes = baker::LobeCount::one};
    EXPECT_FALSE(bakeMaterials(scene, one)[0].reflectance.hasSecond());
}

// Bakes into the folder that the test below names, in a process of its own.
TEST_F(BakeKeys, DISABLED_BakesBesideAnother)
{
    scene.materials = {materials().at("plain"), materials().at("full")};
    for (int i = 0; i < 5; ++i)
        bakeMaterials(scene, {});
}

TEST_F(BakeKeys, ProcessesThatBakeTheSameDoNoHarm)
{
    cacheIn("shared");
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    const std::string one = fmt::format(
        "'{}' --gtest_filter=BakeKeys.DISABLED_BakesBesideAnother --gtest_also_run_disabled_tests "
        "--gtest_brief=1 >/dev/null 2>&1 & ",
        program);
    ASSERT_EQ(std::system((one + "a=$!; " + one + "b=$!; wait $a && wait $b").c_str()), 0);
    EXPECT_EQ(entriesIn(folder / "shared"), 2u);
    for (const auto& entry : std::filesystem::directory_iterator(folder / "shared" / "lumel"))
        EXPECT_NE(entry.path().filename().string().front(), '.') << "a temporary file is left";
    scene.materials = {materials().at("plain"), materials().at("full")};
    const auto recalled = bakeMaterials(scene, {});
    cacheIn("fresh");
    const auto fresh = bakeMaterials(scene, {});
    for (size_t i = 0; i < fresh.size(); ++i)
        EXPECT_EQ(numbersOf(recalled[i]), numbersOf(fresh[i]));
}

} // namespace
} // namespace lumel::scene
