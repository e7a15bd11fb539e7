// The charts of a component between the cut and the atlas: flat, not yet in a page.
#pragma once

#include <cstdint>
#include <vector>

#include "core/mesh/thread_pool.h"
#include "core/texture/atlas.h"

namespace orbis::texture {

struct FlatPoint {
  double x = 0, y = 0; // y down, as in the page
};

// A point of the surface in one chart: all vertices there, whatever input vertex they come from, share it.
struct FlatPlace {
  FlatPoint at; // [0, 1] in both directions
  // On the chart's left or right side, and on its upper or lower one: there x, or y, is 0 or 1 and stays so.
  bool fixed_x = false, fixed_y = false;
  std::uint32_t chart = 0;
};

struct FlatCharts {
  // Charts without a rectangle, vertices without uv; numbered within the component. Until lay_flat() is done there are
  // the triangles that only close holes, too.
  CutMesh mesh;
  std::vector<FlatPlace> places;
  std::vector<std::uint32_t> place_of;   // vertex -> place
  std::vector<mesh::Triangle> triangles; // mesh.triangles as places
  struct Size {
    double width = 1, height = 1; // of a chart, in the units of the surface
  };
  std::vector<Size> sizes;    // one per chart
  std::vector<bool> is_shown; // by chart: whether any of its triangles is delivered; others get no texels
};

// What charts a component may have: those of the cube's faces (cut.h), or also one without a cut, where it is open
// (disk_chart.h).
enum class ChartKinds : std::uint8_t { faces, all };

// Cuts a component into charts and lays them flat, these on the pool's threads; what only closes holes is gone then,
// and charts are the rectangles around what is left. An open component has one chart where that costs no more than a
// fifth more texels than six. Throws as cut() and flatten() do.
[[nodiscard]] FlatCharts lay_flat(const AtlasComponent& component, ChartKinds kinds, Progress& progress,
                                  mesh::ThreadPool& pool);

} // namespace orbis::texture
