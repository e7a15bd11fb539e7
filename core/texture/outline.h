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

// Four places of an outline, ascending: indices into Disk::outline.
using Corners = std::array<std::size_t, 4>;

// Where the corners of a rectangle may well lie on an outline of four vertices or more, best guess first: where the
// outline turns, and so that opposite sides have about one length. At most `most` sets, at least one; they differ by a
// forty-eighth of the outline or more.
[[nodiscard]] std::vector<Corners> corners_of(const Disk& disk, const AtlasComponent& component, std::size_t most);

} // namespace orbis::texture
