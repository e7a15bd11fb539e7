// A component's triangles, whole or divided, written as charts: vertices are shared wherever point, chart and input
// vertices agree.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/texture/divide.h"
#include "core/texture/flat_charts.h"

namespace orbis::texture {

// Charts whose places are still to be set: all of FlatPlace but the chart.
struct WrittenCharts {
  FlatCharts charts;
  std::vector<std::uint32_t> vertex; // place -> its first vertex
  std::vector<Face> face;            // place -> what its chart is called
};

class CutWriter {
public:
  // points: the component's and those that divisions add; divided: how many triangles come in pieces. The component
  // must outlive the writer.
  CutWriter(const AtlasComponent& component, std::size_t points, std::size_t divided);

  // Triangles in their order, as they are or in pieces. One chart for each face that is used, numbered as they come.
  void whole(std::uint32_t triangle, Face face);
  void pieces(std::uint32_t triangle, const Division& division);

  [[nodiscard]] WrittenCharts take();

private:
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  // The vertices of one input vertex, or of one added point, form a chain: it has one link per face as a rule.
  struct Copy {
    std::uint32_t next;
    mesh::Index a, b;
    Face face;
  };

  const AtlasComponent& component_;
  std::vector<mesh::Triangle> corners_;
  CutMesh mesh_;
  std::array<std::uint32_t, face_count> chart_of_{none, none, none, none, none, none};
  std::vector<std::uint32_t> at_input_, at_added_;
  std::vector<Copy> copies_;

  [[nodiscard]] std::pair<mesh::Index, mesh::Index> input_edge(std::uint32_t t, Site site) const;
  mesh::Index vertex(const CutVertex& v, Face face, mesh::Index a, mesh::Index b);
  void append(const mesh::Triangle& vertices, std::uint32_t parent, Face face);
};

} // namespace orbis::texture
