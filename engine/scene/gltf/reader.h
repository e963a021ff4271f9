// The parts of the glTF loader share this: a parsed model, its bytes, and how to fail.
// The only file that includes tinygltf; gltf_*.cpp are the only ones that include this.
#pragma once
#include "core/error.h"
#include "document.h"
#include "limits.h"
#include "scene/scene.h"
#include <fmt/format.h>
#include <map>
#include <span>
#include <tiny_gltf.h>

namespace lumel::scene {

struct Reader {
    Document document;
    tinygltf::Model model;
    size_t sceneVertices = 0;
    size_t readElements = 0;
    size_t morphElements = 0; // vertices, for each morph target

    // "file: why; remedy"
    [[noreturn]] void fail(const std::string& why, const char* remedy = "export it again") const
    {
        throw Error(fmt::format("{}: {}; {}", document.file, printable(why), remedy));
    }
    // Bounds the time: accessors may be read again and again.
    void countElements(size_t count)
    {
        readElements += count;
        if (readElements > kMaxReadElements)
            fail(fmt::format("its meshes name more than {} vertices and indices", kMaxReadElements),
                 "split the model");
    }
};

// Bytes of a buffer view. Throws Error unless it lies inside its buffer.
std::span<const std::byte> bufferViewBytes(const Reader& reader, int view);

// Which storage glTF 2.0, section 3.7.2.1, allows an attribute. KHR_mesh_quantization widens the first two.
enum class Storage { floatOnly, floatOrUnorm, floatOrNormalized, unsignedInteger };

// All elements of an accessor, `components` floats each (16: a matrix by columns), normalised integers
// decoded, sparse values applied. Every range is checked before a byte is read. Throws Error also for NaN and
// infinity.
std::vector<float> readFloats(const Reader& reader, int accessor, int components, Storage storage,
                              const char* what);
// Vertex indices, each below vertexCount.
std::vector<uint32_t> readIndices(const Reader& reader, int accessor, size_t vertexCount);
// Number of elements; checks only the accessor's index.
size_t accessorCount(const Reader& reader, int accessor);
bool isVec3(const Reader& reader, int accessor); // checks only the index

// The mesh's drawable primitives as meshes of the scene, made once however often they are used.
struct Primitive {
    int mesh;
    int material; // -1: the default material
};
using PrimitiveCache =
    std::map<std::vector<int>, int>; // accessors and mode to Scene::meshes, -1 not drawable
std::vector<Primitive> readMesh(Reader& reader, int mesh, Scene& scene, PrimitiveCache& cache);

// Which vectors the loader made, since the file has none.
struct MadeFrames {
    bool normals = false, tangents = false;
};
bool deforms(const tinygltf::Primitive& primitive);
// Sets mesh.deformation, by mesh.sources. All else of the mesh is complete.
void readDeformation(Reader& reader, const tinygltf::Primitive& primitive, const MadeFrames& made,
                     Mesh& mesh);

// What moves, by glTF node.
struct Tracks {
    std::map<int, NodeTracks> nodes;
    std::map<int, WeightTrack> weights;
};
Tracks readTracks(Reader& reader);
// Transforms from each instance of a node's mesh to the node: one identity where the node has none of its own
// (EXT_mesh_gpu_instancing).
std::vector<glm::mat4> readInstances(const Reader& reader, int node);

void readMaterials(Reader& reader, Scene& scene);
void readImages(Reader& reader, Scene& scene);
// Objects, cameras and lights of the default scene, and the scene's bounds.
void readNodes(Reader& reader, Scene& scene);

} // namespace lumel::scene
