#include "charts/charts.h"
#include "charts/lit_uvs.h"
#include "charts/unwrap.h"
#include "charts/uv_check.h"
#include "core/error.h"
#include "core/file.h"
#include "gltf_builder.h"
#include "shapes.h"

namespace lumel::scene {
namespace {

// Unwraps and checks what holds for every mesh.
Mesh unwrapped(const Mesh& mesh)
{
    Mesh result = mesh;
    apply(unwrap(mesh), result);
    EXPECT_EQ(findUvProblem(result), "");
    const UvOverlap overlap = findUvOverlap(result);
    EXPECT_TRUE(overlap.complete);
    EXPECT_LT(overlap.repeated, 1e-6);
    EXPECT_NEAR(overlap.covered, result.unwrapped->coveredShare, 1e-4); // nothing is covered twice
    // A chart's density is that of its surface: a triangle's is at most sqrt(cos 45 degrees) off either way.
    const float spread = float(std::sqrt(kMostStretch));
    EXPECT_LE(result.unwrapped->worstStretch, kMostStretch * 1.001);
    EXPECT_GE(result.unwrapped->leastDensity, 0.99f / spread);
    EXPECT_LE(result.unwrapped->greatestDensity, 1.01f * spread);
    // The surface is what it was, corner by corner.
    EXPECT_EQ(result.indices.size(), mesh.indices.size());
    for (size_t i = 0; i < mesh.indices.size(); ++i) {
        const Vertex &before = mesh.vertices[mesh.indices[i]], &after = result.vertices[result.indices[i]];
        EXPECT_EQ(after.position, before.position);
        EXPECT_EQ(after.materialUv, before.materialUv);
    }
    return result;
}

TEST(Unwrap, ACubeIsSixUnstretchedCharts)
{
    const Mesh mesh = unwrapped(cubeShape());
    EXPECT_EQ(mesh.unwrapped->charts, 6u);
    EXPECT_NEAR(mesh.unwrapped->worstStretch, 1.0f, 1e-3f);
    EXPECT_NEAR(mesh.unwrapped->leastDensity, 1.0f, 1e-3f);
    EXPECT_GT(mesh.unwrapped->coveredShare, 0.6f); // six squares in a square: 2/3 at best
    EXPECT_EQ(mesh.vertices.size(), 24u + 12u);    // 36 corners, of which none were shared
}

TEST(Unwrap, CurvedSurfacesAreAFewCharts)
{
    const Mesh sphere = unwrapped(sphereShape());
    EXPECT_GE(sphere.unwrapped->charts, 5u); // a cone of 45 degrees covers 15 % of a sphere
    EXPECT_LE(sphere.unwrapped->charts, 20u);
    EXPECT_GT(sphere.unwrapped->coveredShare, 0.4f);
    const Mesh torus = unwrapped(torusShape());
    EXPECT_LE(torus.unwrapped->charts, 60u);
    EXPECT_LT(torus.unwrapped->meanStretch, 1.25f);
}

TEST(Unwrap, WhatFoldsOverItselfIsCut)
{
    const Mesh ramp = unwrapped(rampShape());
    EXPECT_GE(ramp.unwrapped->charts, 3u);
    EXPECT_LE(ramp.unwrapped->charts, 12u);
    unwrapped(moebiusShape());
}

TEST(Unwrap, CopiesOnTopOfEachOtherGetLumelsOfTheirOwn)
{
    Mesh twice = sphereShape();
    append(twice, sphereShape());
    EXPECT_EQ(unwrapped(twice).unwrapped->charts, 2 * unwrapped(sphereShape()).unwrapped->charts);
    Mesh bothSides = gridShape(4, 4, [](float s, float t) { return glm::vec3(s, -t, 0.0f); });
    Mesh back = bothSides;
    for (size_t i = 0; i < back.indices.size(); i += 3)
        std::swap(back.indices[i], back.indices[i + 1]);
    append(bothSides, back);
    EXPECT_EQ(unwrapped(bothSides).unwrapped->charts, 2u);
}

TEST(Unwrap, TrianglesWithoutAreaAreKeptAndCoverNothing)
{
    Mesh mesh = cubeShape();
    addTriangle(mesh, {0, 0, 0}, {0, 0, 0}, {0, 0, 0});
    addTriangle(mesh, {0, 0, 0}, {1, 1, 1}, {2, 2, 2});
    addTriangle(mesh, {3, 0, 0}, {4, 0, 0}, {3, 1e-6f, 0}); // a sliver
    addTriangle(mesh, {3, 0, 0}, {3, 1e-7f, 0}, {4, 0, 1});
    EXPECT_EQ(unwrapped(mesh).indices.size(), 48u);

    Mesh none;
    addTriangle(none, {0, 0, 0}, {1, 1, 1}, {2, 2, 2});
    EXPECT_THROW(unwrap(none), Error);
}

TEST(Unwrap, AnySoupOfTrianglesIsUnique)
{
    for (unsigned seed = 1; seed <= 6; ++seed) {
        SCOPED_TRACE(seed);
        unwrapped(soupShape(seed, 40 * int(seed)));
    }
    // Of any size: metres are not assumed.
    for (const float scale : {1e-6f, 1e6f}) {
        Mesh mesh = torusShape(24, 12);
        for (Vertex& v : mesh.vertices)
            v.position *= scale;
        unwrapped(mesh);
    }
}

TEST(Unwrap, ThousandsOfLooseTrianglesStillFit)
{
    const Mesh mesh = unwrapped(soupShape(9, 4000));
    EXPECT_EQ(mesh.unwrapped->charts, 4000u);
    EXPECT_GE(mesh.unwrapped->gap, 4.0f / 4096.0f);
}

TEST(Unwrap, TheSameMeshGivesTheSameResult)
{
    const Unwrapping a = unwrap(torusShape()), b = unwrap(torusShape());
    EXPECT_EQ(a.sources, b.sources);
    EXPECT_EQ(a.uvs, b.uvs);
    EXPECT_EQ(a.indices, b.indices);
}

Scene sceneOf(const Mesh& mesh, AlphaMode mode = AlphaMode::opaque)
{
    Scene scene;
    scene.meshes = {mesh};
    scene.materials.emplace_back();
    scene.materials[0].alphaMode = mode;
    scene.objects.emplace_back();
    return scene;
}

TEST(LitUvs, OnlyWhatIsLitInTextureSpaceIsUnwrapped)
{
    Mesh unique = cubeShape(), overlapping = cubeShape();
    overlapping.uvProblem = "UVs overlap by 50 %";
    for (const Mesh& mesh : {unique, overlapping})
        for (const AlphaMode mode : {AlphaMode::opaque, AlphaMode::blend}) {
            Scene scene = sceneOf(mesh, mode);
            unwrapMeshes(scene);
            EXPECT_EQ(scene.meshes[0].unwrapped.has_value(),
                      !mesh.uvProblem.empty() && mode == AlphaMode::opaque);
        }
    Mesh flat;
    addTriangle(flat, {0, 0, 0}, {1, 1, 1}, {2, 2, 2});
    flat.uvProblem = "UVs cover no area";
    Scene scene = sceneOf(flat);
    unwrapMeshes(scene);
    EXPECT_EQ(scene.meshes[0].uvProblem, "UVs cover no area; no area to unwrap");
}

TEST(LitUvs, LargeMeshesComeFromTheCacheUnlessItIsDamaged)
{
    const TemporaryFolder folder;
    const char* before = getenv("XDG_CACHE_HOME");
    const std::string restored = before ? before : "";
    setenv("XDG_CACHE_HOME", folder.path().c_str(), 1);
    Mesh mesh = sphereShape();
    mesh.uvProblem = "no UVs";
    const auto load = [&] {
        Scene scene = sceneOf(mesh);
        unwrapMeshes(scene);
        EXPECT_EQ(scene.meshes[0].uvProblem, "");
        return scene.meshes[0];
    };
    const Mesh first = load();
    std::filesystem::path file;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
        if (entry.path().extension() == ".unwrap")
            file = entry.path();
    ASSERT_FALSE(file.empty());
    const std::string good = readText(file);
    const auto same = [&](const Mesh& other) {
        return other.indices == first.indices && other.vertices.size() == first.vertices.size() &&
               std::equal(
                   other.vertices.begin(), other.vertices.end(), first.vertices.begin(),
                   [](const Vertex& a, const Vertex& b) { return a.uv == b.uv && a.position == b.position; });
    };
    EXPECT_TRUE(same(load()));
    // A later run reads it: another number of charts in the file is accepted if its hash agrees.
    std::string changed = good.substr(0, good.size() - 32);
    changed[8] = 77;
    writeText(file, changed + ContentHash().add(changed.data(), changed.size()).hex());
    EXPECT_EQ(load().unwrapped->charts, 77u);
    for (const std::string& damaged : {std::string(), good.substr(0, good.size() / 2), good.substr(1),
                                       good + "x", std::string(100, '\xff')}) {
        writeText(file, damaged);
        EXPECT_TRUE(same(load()));
    }
    std::string flipped = good;
    flipped[good.size() / 2] = char(flipped[good.size() / 2] ^ 1);
    writeText(file, flipped);
    EXPECT_TRUE(same(load()));
    EXPECT_EQ(readText(file), good);
    if (before)
        setenv("XDG_CACHE_HOME", restored.c_str(), 1);
    else
        unsetenv("XDG_CACHE_HOME");
}

} // namespace
} // namespace lumel::scene
