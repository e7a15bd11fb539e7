// A cut mesh seen from the atlas: which triangle shows a given place?
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/texture/atlas.h"

namespace orbis::lod {

using Uv = std::array<double, 2>;

inline constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

// A point of a cut mesh.
struct Place {
  std::uint32_t triangle = 0;
  std::array<double, 3> weights{}; // on its corners, not negative, sum 1
};

class ChartMap {
public:
  // region: number of each triangle's region. Triangles are neighbours if they share an edge of the surface, belong to
  // one region and see the edge at one place in the atlas. Both outlive the map.
  ChartMap(const texture::CutMesh& mesh, std::span<const std::uint32_t> region);

  // The place of uv in the region of the triangle `from`: walks there from triangle to triangle. Nothing where the walk
  // ends at the region's border; a region that is not convex may still hold the place.
  [[nodiscard]] std::optional<Place> locate(const Uv& uv, std::uint32_t from) const;

private:
  const texture::CutMesh& mesh_;
  std::vector<std::array<std::uint32_t, 3>> neighbours_; // across the edge from corner k to k + 1, or `none`
};

} // namespace orbis::lod
