// Normals and tangents for meshes that come without them.
#pragma once
#include "scene.h"

namespace lumel::scene {

// Flat normals (glTF 2.0, section 3.7.2.1: required where NORMAL is missing): each triangle gets vertices
// of its own.
void makeFlatNormals(Mesh& mesh);

// Replaces normals of length zero by the area-weighted normal of their triangles and normalises the rest.
void repairNormals(Mesh& mesh);

// Normalises the file's tangents; w becomes 1 or -1; tangents along the normal are replaced.
void repairTangents(Mesh& mesh);

// Tangents by MikkTSpace's rules, in glTF's convention. See the .cpp.
void makeTangents(Mesh& mesh);

// Any tangent across the normal, for meshes without UVs.
void makeArbitraryTangents(Mesh& mesh);

} // namespace lumel::scene
