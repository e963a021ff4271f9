#include "gltf_builder.h"
#include "scene/vertex_frames.h"

namespace lumel::scene {
namespace {

// Upright image on a square facing +z; `mirror` flips u.
Mesh square(bool mirror = false)
{
    Mesh mesh;
    const auto u = [&](float x) { return mirror ? 1.0f - x : x; };
    for (glm::vec2 p : {glm::vec2(0, 0), glm::vec2(1, 0), glm::vec2(1, 1), glm::vec2(0, 1)}) {
        Vertex v{};
        v.position = {p.x, p.y, 0};
        v.normal = {0, 0, 1};
        v.materialUv = {u(p.x), 1.0f - p.y}; // v grows downwards
        mesh.vertices.push_back(v);
    }
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

// What the shader does with a decoded normal map texel.
glm::vec3 worldNormal(const Vertex& v, glm::vec3 texel)
{
    const glm::vec3 tangent(v.tangent);
    const glm::vec3 bitangent = v.tangent.w * glm::cross(v.normal, tangent);
    return texel.x * tangent + texel.y * bitangent + texel.z * v.normal;
}

void expectNear(glm::vec3 a, glm::vec3 b)
{
    EXPECT_LT(glm::length(a - b), 1e-5f) << a.x << " " << a.y << " " << a.z;
}

TEST(Tangents, RedPointsAlongUAndGreenUpTheImage)
{
    Mesh mesh = square();
    makeTangents(mesh);
    EXPECT_EQ(mesh.vertices.size(), 4u);
    for (const Vertex& v : mesh.vertices) {
        expectNear(worldNormal(v, {1, 0, 0}), {1, 0, 0});
        expectNear(worldNormal(v, {0, 1, 0}), {0, 1, 0}); // the image's upper edge is at y = 1
        EXPECT_EQ(v.tangent.w, 1.0f);
    }
}

TEST(Tangents, MirroredUvsFlipTheHandedness)
{
    Mesh mesh = square(true);
    makeTangents(mesh);
    for (const Vertex& v : mesh.vertices) {
        EXPECT_EQ(v.tangent.w, -1.0f);
        expectNear(worldNormal(v, {1, 0, 0}), {-1, 0, 0}); // u grows towards -x
        expectNear(worldNormal(v, {0, 1, 0}), {0, 1, 0});  // up stays up
    }
}

TEST(Tangents, SharedVertexOfMirroredHalvesIsSplit)
{
    // Two squares side by side, the right one mirrored: a symmetric texture, the seam's vertices shared.
    Mesh mesh;
    for (glm::vec3 p : {glm::vec3(0, 0, 0), glm::vec3(1, 0, 1), glm::vec3(2, 0, 0)})
        for (float y : {0.0f, 1.0f}) {
            Vertex v{};
            v.position = {p.x, y, 0};
            v.normal = {0, 0, 1};
            v.materialUv = {p.z, 1.0f - y};
            mesh.vertices.push_back(v);
        }
    mesh.indices = {0, 2, 3, 0, 3, 1, 2, 4, 5, 2, 5, 3};
    makeTangents(mesh);
    EXPECT_EQ(mesh.vertices.size(), 8u); // the two of the seam, twice
    for (size_t i = 0; i < mesh.indices.size(); ++i) {
        const Vertex& v = mesh.vertices[mesh.indices[i]];
        const float side = i < 6 ? 1.0f : -1.0f;
        EXPECT_EQ(v.tangent.w, side);
        expectNear(glm::vec3(v.tangent), {side, 0, 0});
        expectNear(worldNormal(v, {0, 1, 0}), {0, 1, 0});
    }
}

TEST(Tangents, DoNotDependOnHowTheIndexBufferIsSplit)
{
    // A folded strip: the shared edge's corners average over both triangles, whether the vertices are
    // stored once or twice.
    Mesh shared = square();
    shared.vertices[3].position = {0.2f, 1.0f, 0.5f};
    for (Vertex& v : shared.vertices)
        v.normal = glm::normalize(glm::vec3(-0.1f, -0.2f, 1.0f));
    Mesh split = shared;
    split.vertices.clear();
    for (uint32_t index : shared.indices)
        split.vertices.push_back(shared.vertices[index]);
    split.indices = {0, 1, 2, 3, 4, 5};
    makeTangents(shared);
    makeTangents(split);
    for (size_t i = 0; i < 6; ++i)
        expectNear(glm::vec3(shared.vertices[shared.indices[i]].tangent),
                   glm::vec3(split.vertices[split.indices[i]].tangent));
}

TEST(Tangents, CornersWeighByTheirAngle)
{
    // At the origin meet a triangle of 90 degrees with dP/du = +x and one of 45 degrees with dP/du = +y.
    Mesh mesh;
    const auto add = [&](glm::vec3 p, glm::vec2 uv) {
        Vertex v{};
        v.position = p;
        v.normal = {0, 0, 1};
        v.materialUv = uv;
        mesh.vertices.push_back(v);
        mesh.indices.push_back(uint32_t(mesh.indices.size()));
    };
    add({0, 0, 0}, {0, 0});
    add({1, 0, 0}, {1, 0});
    add({0, 1, 0}, {0, -1});
    add({0, 0, 0}, {0, 0});
    add({-1, 0, 0}, {0, -1}); // u along +y, v up along -x
    add({-1, -1, 0}, {-1, -1});
    makeTangents(mesh);
    const glm::vec2 expected = glm::normalize(glm::vec2(90.0f, 45.0f));
    expectNear(glm::vec3(mesh.vertices[0].tangent), {expected.x, expected.y, 0.0f});
    expectNear(glm::vec3(mesh.vertices[3].tangent), {expected.x, expected.y, 0.0f});
    expectNear(glm::vec3(mesh.vertices[1].tangent), {1, 0, 0});
}

TEST(Tangents, TrianglesWithoutUvAreaBorrow)
{
    Mesh mesh = square();
    Vertex far = mesh.vertices[2];
    far.position = {5, 5, 0}; // same UV as vertex 2: the triangle below spans no UV area
    mesh.vertices.push_back(far);
    mesh.indices.insert(mesh.indices.end(), {1, 4, 2});
    makeTangents(mesh);
    for (const Vertex& v : mesh.vertices) {
        EXPECT_TRUE(std::isfinite(v.tangent.x));
        EXPECT_NEAR(glm::length(glm::vec3(v.tangent)), 1.0f, 1e-5f);
    }
    expectNear(glm::vec3(mesh.vertices[1].tangent), {1, 0, 0});
    expectNear(glm::vec3(mesh.vertices[2].tangent), {1, 0, 0});
}

TEST(Tangents, WithoutUvsAreUnitAndAcrossTheNormal)
{
    Mesh mesh;
    for (glm::vec3 n : {glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(1, 0, 0), glm::vec3(0, -1, 0),
                        glm::normalize(glm::vec3(1, 2, -3))}) {
        Vertex v{};
        v.normal = n;
        mesh.vertices.push_back(v);
    }
    makeArbitraryTangents(mesh);
    for (const Vertex& v : mesh.vertices) {
        EXPECT_NEAR(glm::length(glm::vec3(v.tangent)), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::dot(glm::vec3(v.tangent), v.normal), 0.0f, 1e-5f);
        EXPECT_EQ(v.tangent.w, 1.0f);
    }
}

TEST(Tangents, FromTheFileAreRepaired)
{
    Mesh mesh = square();
    mesh.vertices[0].tangent = {0, 3, 0, 1};     // not unit
    mesh.vertices[1].tangent = {0, 0, 0, 0};     // missing
    mesh.vertices[2].tangent = {0, 0, 1, -0.5f}; // along the normal
    mesh.vertices[3].tangent = {1, 0, 0, -1};
    repairTangents(mesh);
    expectNear(glm::vec3(mesh.vertices[0].tangent), {0, 1, 0});
    for (const Vertex& v : mesh.vertices) {
        EXPECT_NEAR(glm::length(glm::vec3(v.tangent)), 1.0f, 1e-5f);
        EXPECT_NEAR(glm::dot(glm::vec3(v.tangent), v.normal), 0.0f, 1e-5f);
        EXPECT_EQ(std::abs(v.tangent.w), 1.0f);
    }
    EXPECT_EQ(mesh.vertices[2].tangent.w, -1.0f);
}

TEST(Normals, FlatWhereTheFileHasNone)
{
    TemporaryFolder folder;
    GltfBuilder gltf;
    // Two triangles at a right angle that share an edge.
    auto& p = gltf.primitive();
    p["attributes"]["POSITION"] = gltf.floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, -1}, "VEC3", 3);
    p["attributes"]["TANGENT"] = gltf.floats({9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9}, "VEC4", 4);
    p["indices"] = gltf.accessor<uint16_t>({0, 1, 2, 0, 3, 1}, "SCALAR", 5123, 1);
    const Scene scene = loadGltf(gltf.writeGltf(folder));
    const Mesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.vertices.size(), 6u) << "each triangle has vertices of its own";
    for (size_t i = 0; i < 6; ++i) {
        const Vertex& v = mesh.vertices[mesh.indices[i]];
        expectNear(v.normal, i < 3 ? glm::vec3(0, 0, 1) : glm::vec3(0, -1, 0));
        EXPECT_NEAR(glm::length(glm::vec3(v.tangent)), 1.0f, 1e-5f) << "the file's tangents do not count";
    }
}

TEST(Normals, OfLengthZeroAreRebuiltAndOthersNormalised)
{
    Mesh mesh = square();
    mesh.vertices[1].normal = {0, 0, 0};
    mesh.vertices[2].normal = {0, 0, 40};
    repairNormals(mesh);
    for (const Vertex& v : mesh.vertices)
        expectNear(v.normal, {0, 0, 1});
}

} // namespace
} // namespace lumel::scene
