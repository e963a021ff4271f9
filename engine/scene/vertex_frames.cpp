// Tangents follow Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited", and its reference code
// mikktspace.c, which glTF 2.0 names as the default:
//   - a triangle's tangent is dP/du (first-order, from its UV gradients), normalised, negated on
//     mirrored triangles so that it always points along +u;
//   - corners share a tangent when position, normal and UV are equal bit for bit and their triangles have
//     the same UV orientation; it does not matter how the index buffer was split;
//   - the shared tangent is the sum over these corners of the triangle's tangent, projected on the normal
//     plane and normalised, times the corner's angle measured in that plane;
//   - triangles whose UVs span no area are ignored and borrow a neighbour's tangent;
//   - a vertex whose triangles are of both orientations is split.
// Deviation: mikktspace.c also separates corners that share a vertex but no chain of edges (a bow tie).
// Here they share a tangent.
//
// Signs. MikkTSpace wants v upwards; in glTF v grows downwards. So the orientation is that of (u, -v):
// w = +1 where the triangle is not mirrored, and w cross(N, T) points to the image's upper edge, which
// is where green points in glTF's normal maps.
#include "vertex_frames.h"
#include <array>
#include <cstring>
#include <unordered_map>

namespace lumel::scene {
namespace {

// Where no direction is given, any across `normal` does (Duff et al. 2017, "Building an Orthonormal
// Basis, Revisited").
glm::vec3 anyTangent(glm::vec3 normal)
{
    const float sign = std::copysign(1.0f, normal.z);
    const float a = -1.0f / (sign + normal.z);
    return {1.0f + sign * normal.x * normal.x * a, sign * normal.x * normal.y * a, -sign * normal.x};
}

// Zero stays zero. In double, so that tiny triangles do not underflow.
glm::dvec3 safeNormalize(glm::dvec3 v)
{
    const double length = glm::length(v);
    return length > 0.0 ? v / length : glm::dvec3(0.0);
}

glm::dvec3 across(glm::dvec3 v, glm::dvec3 normal)
{
    return safeNormalize(v - normal * glm::dot(normal, v));
}

using WeldKey = std::array<float, 8>;
struct WeldHash {
    size_t operator()(const WeldKey& key) const
    {
        uint64_t hash = 0xcbf29ce484222325ull;
        for (float value : key) {
            uint32_t bits;
            std::memcpy(&bits, &value, 4);
            hash = (hash ^ bits) * 0x9e3779b97f4a7c15ull;
            hash ^= hash >> 29;
        }
        return size_t(hash);
    }
};

// One number for each distinct (position, normal, UV).
std::vector<uint32_t> weld(const std::vector<Vertex>& vertices)
{
    std::unordered_map<WeldKey, uint32_t, WeldHash> seen(vertices.size());
    std::vector<uint32_t> ids;
    ids.reserve(vertices.size());
    for (const Vertex& v : vertices) {
        WeldKey key = {v.position.x, v.position.y, v.position.z,   v.normal.x,
                       v.normal.y,   v.normal.z,   v.materialUv.x, v.materialUv.y};
        for (float& value : key)
            value += 0.0f; // -0 becomes +0
        ids.push_back(seen.try_emplace(key, uint32_t(seen.size())).first->second);
    }
    return ids;
}

// A triangle's unit tangent and its orientation: 0 where the UVs span no area.
struct TriangleTangent {
    glm::dvec3 tangent{0.0};
    int orientation = 0;
};

TriangleTangent triangleTangent(const Vertex& a, const Vertex& b, const Vertex& c)
{
    const glm::dvec3 d1 = glm::dvec3(b.position) - glm::dvec3(a.position);
    const glm::dvec3 d2 = glm::dvec3(c.position) - glm::dvec3(a.position);
    const double u1 = double(b.materialUv.x) - a.materialUv.x,
                 v1 = double(a.materialUv.y) - b.materialUv.y; // v upwards
    const double u2 = double(c.materialUv.x) - a.materialUv.x, v2 = double(a.materialUv.y) - c.materialUv.y;
    const double area = u1 * v2 - u2 * v1;
    const glm::dvec3 alongU = v2 * d1 - v1 * d2;
    TriangleTangent result;
    if (area == 0.0 || glm::length(alongU) == 0.0 || glm::length(glm::cross(d1, d2)) == 0.0)
        return result;
    result.orientation = area > 0.0 ? 1 : -1;
    result.tangent = safeNormalize(alongU) * double(result.orientation);
    return result;
}

// The corner's angle at `at`, between the edges to `p` and `q`, in the plane of `normal`.
double cornerAngle(const Vertex& at, const Vertex& p, const Vertex& q)
{
    const glm::dvec3 normal = at.normal;
    const glm::dvec3 e1 = across(glm::dvec3(p.position) - glm::dvec3(at.position), normal);
    const glm::dvec3 e2 = across(glm::dvec3(q.position) - glm::dvec3(at.position), normal);
    return std::acos(glm::clamp(glm::dot(e1, e2), -1.0, 1.0));
}

// Sums for both orientations of each welded vertex.
struct Group {
    glm::dvec3 sum{0.0};
    bool used = false;
};
using Groups = std::vector<std::array<Group, 2>>; // [welded vertex][orientation < 0]

void accumulate(const Mesh& mesh, const std::vector<uint32_t>& welded,
                const std::vector<TriangleTangent>& triangles, Groups& groups)
{
    for (size_t t = 0; t < triangles.size(); ++t) {
        if (triangles[t].orientation == 0)
            continue;
        for (size_t c = 0; c < 3; ++c) {
            const uint32_t index = mesh.indices[3 * t + c];
            const Vertex& at = mesh.vertices[index];
            Group& group = groups[welded[index]][triangles[t].orientation < 0];
            const double angle = cornerAngle(at, mesh.vertices[mesh.indices[3 * t + (c + 1) % 3]],
                                             mesh.vertices[mesh.indices[3 * t + (c + 2) % 3]]);
            group.sum += angle * across(triangles[t].tangent, at.normal);
            group.used = true;
        }
    }
}

glm::vec4 groupTangent(const Group& group, glm::vec3 normal, int side)
{
    const glm::dvec3 tangent = safeNormalize(group.sum);
    const glm::vec3 t = glm::length(tangent) > 0.5 ? glm::vec3(tangent) : anyTangent(normal);
    return glm::vec4(t, side == 0 ? 1.0f : -1.0f);
}

} // namespace

void makeFlatNormals(Mesh& mesh)
{
    std::vector<Vertex> vertices;
    std::vector<uint32_t> sources;
    vertices.reserve(mesh.indices.size());
    for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        Vertex corner[3];
        for (size_t c = 0; c < 3; ++c)
            corner[c] = mesh.vertices[mesh.indices[i + c]];
        const glm::dvec3 p(corner[0].position);
        const glm::dvec3 n =
            safeNormalize(glm::cross(glm::dvec3(corner[1].position) - p, glm::dvec3(corner[2].position) - p));
        for (Vertex& v : corner) {
            v.normal = glm::length(n) > 0.5 ? glm::vec3(n) : glm::vec3(0.0f, 0.0f, 1.0f);
            vertices.push_back(v);
        }
        for (size_t c = 0; c < 3 && !mesh.sources.empty(); ++c)
            sources.push_back(mesh.sources[mesh.indices[i + c]]);
    }
    mesh.vertices = std::move(vertices);
    mesh.sources = std::move(sources);
    for (size_t i = 0; i < mesh.indices.size(); ++i)
        mesh.indices[i] = uint32_t(i);
}

void repairNormals(Mesh& mesh)
{
    std::vector<glm::dvec3> sums;
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
        Vertex& v = mesh.vertices[i];
        glm::dvec3 n = safeNormalize(v.normal);
        if (n == glm::dvec3(0.0) && sums.empty()) {
            sums.assign(mesh.vertices.size(), glm::dvec3(0.0));
            for (size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
                const uint32_t* corner = &mesh.indices[t];
                const glm::dvec3 p(mesh.vertices[corner[0]].position);
                const glm::dvec3 area = glm::cross(glm::dvec3(mesh.vertices[corner[1]].position) - p,
                                                   glm::dvec3(mesh.vertices[corner[2]].position) - p);
                for (size_t c = 0; c < 3; ++c)
                    sums[corner[c]] += area;
            }
        }
        if (n == glm::dvec3(0.0))
            n = safeNormalize(sums[i]);
        v.normal = n == glm::dvec3(0.0) ? glm::vec3(0.0f, 0.0f, 1.0f) : glm::vec3(n);
    }
}

void repairTangents(Mesh& mesh)
{
    for (Vertex& v : mesh.vertices) {
        const glm::dvec3 tangent = safeNormalize(glm::vec3(v.tangent));
        // sin of the smallest usable angle to the normal; below, the frame is noise
        const bool usable = glm::length(glm::cross(tangent, glm::dvec3(v.normal))) > 1e-3;
        v.tangent =
            glm::vec4(usable ? glm::vec3(tangent) : anyTangent(v.normal), v.tangent.w < 0.0f ? -1.0f : 1.0f);
    }
}

void makeArbitraryTangents(Mesh& mesh)
{
    for (Vertex& v : mesh.vertices)
        v.tangent = glm::vec4(anyTangent(v.normal), 1.0f);
}

void makeTangents(Mesh& mesh)
{
    const std::vector<uint32_t> welded = weld(mesh.vertices);
    std::vector<TriangleTangent> triangles(mesh.indices.size() / 3);
    for (size_t t = 0; t < triangles.size(); ++t) {
        const uint32_t* corner = &mesh.indices[3 * t];
        triangles[t] =
            triangleTangent(mesh.vertices[corner[0]], mesh.vertices[corner[1]], mesh.vertices[corner[2]]);
    }
    Groups groups(mesh.vertices.size()); // at least as many as welded vertices
    accumulate(mesh, welded, triangles, groups);

    constexpr uint32_t kNone = ~0u;
    const size_t originalCount = mesh.vertices.size();
    std::vector<int> sideOf(originalCount, -1);       // the side that keeps the original vertex
    std::vector<uint32_t> twin(originalCount, kNone); // the vertex made for the other side
    for (size_t t = 0; t < triangles.size(); ++t) {
        for (size_t c = 0; c < 3; ++c) {
            uint32_t& index = mesh.indices[3 * t + c];
            const auto& group = groups[welded[index]];
            int side = triangles[t].orientation < 0 ? 1 : 0;
            if (triangles[t].orientation == 0)
                side = group[0].used || !group[1].used ? 0 : 1;
            if (sideOf[index] < 0) {
                sideOf[index] = side;
                mesh.vertices[index].tangent =
                    groupTangent(group[size_t(side)], mesh.vertices[index].normal, side);
            } else if (sideOf[index] != side) {
                if (twin[index] == kNone) {
                    twin[index] = uint32_t(mesh.vertices.size());
                    Vertex copy = mesh.vertices[index];
                    copy.tangent = groupTangent(group[size_t(side)], copy.normal, side);
                    mesh.vertices.push_back(copy);
                    if (!mesh.sources.empty())
                        mesh.sources.push_back(mesh.sources[index]);
                }
                index = twin[index];
            }
        }
    }
}

} // namespace lumel::scene
