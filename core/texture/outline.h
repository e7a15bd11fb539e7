// The loop at which an open component ends.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/texture/atlas.h"

namespace orbis::texture {

// A component as a disk: with its longest loop open, and its other holes closed.
struct Disk {
  std::vector<std::uint32_t> triangles; // of the component: the delivered ones, then those that close the other holes
  std::vector<mesh::Index> outline;     // vertices along the open loop, the surface to its left; three or more
  // Length^2 / (4 pi area of the delivered triangles): 1 for a round flat disk, more for other flat ones, less the
  // deeper a cup is.
  double openness = 0;
};

// Nothing where the component is closed, or is no disk even so.
[[nodiscard]] std::optional<Disk> as_disk(const AtlasComponent& component);

// Where the corners of a rectangle best lie on an outline of four vertices or more: at its own corners, where the
// surface turns, and so that opposite sides have about one length. Indices into the outline, ascending.
[[nodiscard]] std::array<std::size_t, 4> corners_of(const Disk& disk, const AtlasComponent& component);

} // namespace orbis::texture
