// Accessors, buffer views and indices that lie about what is there: nothing is read past its end. Run under
// the sanitizers (./run test --sanitize) this is also the proof.
#include "gltf_builder.h"
#include <cmath>

namespace lumel::scene {
namespace {

using nlohmann::json;

struct HostileAccessors : testing::Test {
    TemporaryFolder folder;
    GltfBuilder gltf;

    HostileAccessors() { gltf.quad(); }
    void expectGltfRefused(const std::string& part) { expectRefused(gltf.writeGltf(folder), part); }
};

TEST_F(HostileAccessors, AccessorsPastTheirEnd)
{
    json& position = gltf.root["accessors"][0];
    for (uint64_t count : {uint64_t(5), uint64_t(1) << 32, (uint64_t(1) << 60) + 1, ~uint64_t(0)}) {
        position["count"] = count;
        gltf.root["accessors"][1]["count"] = count; // the others agree with it
        gltf.root["accessors"][2]["count"] = count;
        expectGltfRefused("");
    }
}

TEST_F(HostileAccessors, OffsetsThatWrap)
{
    json& accessor = gltf.root["accessors"][0];
    for (uint64_t offset : {uint64_t(4), uint64_t(49), ~uint64_t(0), ~uint64_t(0) - 47}) {
        accessor["byteOffset"] = offset;
        expectGltfRefused("past the end of its buffer view");
    }
    accessor["byteOffset"] = 0;
    json& view = gltf.root["bufferViews"][0];
    for (uint64_t offset : {uint64_t(1) << 20, ~uint64_t(0), ~uint64_t(0) - 47}) {
        view["byteOffset"] = offset;
        expectGltfRefused("past the end of its buffer");
    }
}

TEST_F(HostileAccessors, ViewLongerThanItsBuffer)
{
    gltf.root["bufferViews"][0]["byteLength"] = ~uint64_t(0);
    expectGltfRefused("past the end of its buffer");
}

TEST_F(HostileAccessors, StrideSmallerThanTheElement)
{
    gltf.root["bufferViews"][0]["byteStride"] = 4;
    expectGltfRefused("stride");
}

TEST_F(HostileAccessors, StrideThatReachesPastTheEnd)
{
    gltf.root["bufferViews"][0]["byteStride"] = 252;
    expectGltfRefused("past the end");
}

TEST_F(HostileAccessors, CountOfZero)
{
    for (size_t i : {0u, 3u}) { // positions, indices
        GltfBuilder fresh;
        gltf = fresh.quad();
        gltf.root["accessors"][i]["count"] = 0;
        expectGltfRefused("no elements");
    }
}

TEST_F(HostileAccessors, CountsThatDisagree)
{
    gltf.root["accessors"][1]["count"] = 3;
    expectGltfRefused("NORMAL (accessor 1) has 3 elements for 4 vertices");
}

TEST_F(HostileAccessors, IndexBeyondTheVertices)
{
    gltf.primitive()["indices"] = gltf.accessor<uint16_t>({0, 1, 4}, "SCALAR", 5123, 1);
    expectGltfRefused("name vertex 4 of 4");
}

TEST_F(HostileAccessors, IndexCountThatIsNoMultipleOfThree)
{
    gltf.primitive()["indices"] = gltf.accessor<uint16_t>({0, 1, 2, 3}, "SCALAR", 5123, 1);
    expectGltfRefused("multiple of 3");
}

TEST_F(HostileAccessors, WrongComponentTypes)
{
    gltf.root["accessors"][0]["componentType"] = 5124; // INT: not glTF
    expectGltfRefused("accessor 0");
    gltf.root["accessors"][0]["componentType"] = 5130; // DOUBLE
    expectGltfRefused("accessor 0");
    gltf.root["accessors"][0]["componentType"] = 77;
    expectGltfRefused("");
    gltf.root["accessors"][0]["componentType"] = 5123; // allowed for UVs only
    expectGltfRefused("does not allow");
    gltf.root["accessors"][0]["componentType"] = 5126;
    gltf.root["accessors"][3]["componentType"] = 5122; // signed indices
    expectGltfRefused("does not allow");
}

TEST_F(HostileAccessors, WrongElementType)
{
    gltf.root["accessors"][0]["type"] = "VEC2";
    expectGltfRefused("wrong type");
    gltf.root["accessors"][0]["type"] = "VEC9";
    expectGltfRefused("");
}

TEST_F(HostileAccessors, ReferencesToNothing)
{
    gltf.primitive()["attributes"]["POSITION"] = 77;
    expectGltfRefused("accessor 77");
    gltf.primitive()["attributes"]["POSITION"] = -5;
    expectGltfRefused("");
    gltf.primitive()["attributes"]["POSITION"] = 0;
    gltf.root["accessors"][0]["bufferView"] = 77;
    expectGltfRefused("buffer view 77");
    gltf.root["accessors"][0]["bufferView"] = 0;
    gltf.root["bufferViews"][0]["buffer"] = 77;
    expectGltfRefused("buffer 77");
}

TEST_F(HostileAccessors, MeshWithoutPosition)
{
    gltf.primitive()["attributes"].erase("POSITION");
    expectGltfRefused("POSITION");
}

TEST_F(HostileAccessors, ValuesThatAreNotFinite)
{
    for (float bad : {NAN, INFINITY}) {
        for (const char* name : {"POSITION", "NORMAL"}) {
            GltfBuilder fresh;
            gltf = fresh.quad();
            gltf.primitive()["attributes"][name] =
                gltf.floats({0, 0, 0, 1, 0, 0, 1, 1, bad, 0, 1, 0}, "VEC3", 3);
            expectGltfRefused(name);
        }
    }
}

TEST_F(HostileAccessors, SparseValuesOutOfRange)
{
    const uint16_t index = 3;
    const float value[3] = {0, 1, 0};
    const size_t indices = gltf.view(&index, 2), values = gltf.view(value, 12);
    const json good = {{"count", 1},
                       {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                       {"values", {{"bufferView", values}}}};
    json& sparse = gltf.root["accessors"][0]["sparse"];
    sparse = good;
    EXPECT_EQ(errorOf([&] { loadGltf(gltf.writeGltf(folder)); }), "");
    for (int count : {0, -1, 5, 1 << 30}) {
        sparse = good;
        sparse["count"] = count;
        expectGltfRefused("sparse");
    }
    sparse = good;
    sparse["count"] = 2;
    expectGltfRefused("past the end");
    sparse = good;
    sparse["values"]["byteOffset"] = -4;
    expectGltfRefused("sparse");
    sparse = good;
    sparse["indices"]["componentType"] = 5126;
    expectGltfRefused("sparse");
    sparse = good;
    sparse["indices"]["bufferView"] = 0; // the zeros and ones of the positions as 16-bit numbers: up to 16256
    sparse["indices"]["byteOffset"] = 14;
    expectGltfRefused("sparse index out of range");
}

TEST_F(HostileAccessors, ManyElementsWithoutData)
{
    gltf.root["accessors"][0].erase("bufferView");
    for (size_t i : {0u, 1u, 2u})
        gltf.root["accessors"][i]["count"] = uint64_t(1) << 40;
    expectGltfRefused("");
}

} // namespace
} // namespace lumel::scene
