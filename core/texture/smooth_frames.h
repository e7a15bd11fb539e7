// Tangent frames so smooth that every level of detail can follow them: what one normal map for all levels is written
// in.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/texture/atlas.h"
#include "core/texture/bake_maps.h"

namespace orbis::texture {

// A unit normal, and a unit tangent perpendicular to it.
struct VertexFrame {
  Vec3f normal;
  Tangent tangent;
};

// On each chart a uniform bicubic B-spline (de Boor 1978) over a few cells, for the normals and for the tangents, whose
// control points are the means of the surface's frames under their basis functions. A level interpolates the field
// linearly in its triangles, and is then off by at most h^2 / 8 times the second derivative, which the cells bound.
class SmoothFrames {
public:
  // charts: those of a page, ascending. field: the frames of the full surface there. Keeps references to the mesh and
  // to the list of charts.
  SmoothFrames(const CutMesh& cut, std::span<const std::uint32_t> charts, const FrameField& field);

  // At a place in one of the charts.
  [[nodiscard]] VertexFrame at(std::uint32_t chart, const Vec2f& uv) const;

private:
  // cells: along each side; 0 for a field that is the same all over.
  struct Spline {
    std::uint32_t cells = 0;
    std::vector<Vec3d> normals, tangents; // (cells + 3)^2 control points each, row by row; 1 where cells is 0
    double handedness = 1;
  };
  struct Sample;
  [[nodiscard]] static std::vector<Sample> samples_of(const Chart& chart, const FrameField& field);
  static Spline fitted(const std::vector<Sample>& samples, std::uint32_t cells);
  [[nodiscard]] static bool is_regular(const Spline& spline);

  const CutMesh& cut_;
  std::span<const std::uint32_t> charts_;
  std::vector<Spline> splines_; // of the charts
};

} // namespace orbis::texture
