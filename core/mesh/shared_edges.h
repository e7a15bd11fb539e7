// Edges with three triangles or more: which of them are one surface.
#pragma once

#include <cstdint>
#include <span>

#include "core/mesh/gluing.h"

namespace orbis::mesh {

// Glues the sides of shared edges two by two, one up and one down each: first those whose triangles share the input's
// vertices there, then the flattest continuation, so that a wall that meets a floor does not tear the floor apart; of
// equally flat ones the pair that encloses less, so that two cubes with a common edge are two cubes. The two sides of
// one sheet are not glued to each other. What finds no partner stays open. Edges of more than 64 sides stay open
// altogether.
//   positions  of the points
//   corners    for each triangle its three vertices in the input, in the order of the gluing's points
// Requires an oriented gluing.
void glue_shared_edges(std::span<const Vec3f> positions, std::span<const Triangle> corners, const SharedEdges& shared,
                       Gluing& gluing);

// Makes the glued surface simple: no two edges join the same two vertices, no loop has two edges, and no piece is two
// triangles back to back. Where two edges do, their four sides are glued the other way round, which pinches the surface
// off there; two triangles back to back come apart. Returns how many edges were changed.
[[nodiscard]] std::uint64_t separate_double_edges(const SharedEdges& shared, Gluing& gluing);

} // namespace orbis::mesh
