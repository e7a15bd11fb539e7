#include "core/texture/atlas.h"

#include "core/error.h"
#include "core/texture/flat_charts.h"
#include "core/texture/place.h"

namespace orbis::texture {

std::array<double, 3> weights_on(std::uint32_t triangle, std::span<const mesh::Triangle> triangles,
                                 const CutVertex& v) {
  if (v.triangle == triangle) return v.barycentric;
  std::array<double, 3> out{};
  const mesh::Triangle &here = triangles[triangle], &there = triangles[v.triangle];
  for (std::size_t j = 0; j < 3; ++j) {
    if (v.barycentric[j] == 0) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      if (here[i] == there[j]) out[i] = v.barycentric[j];
    }
  }
  return out;
}

double utilisation(const CutMesh& mesh) {
  double used = 0, all = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec2f &p = mesh.vertices[a].uv, &q = mesh.vertices[b].uv, &r = mesh.vertices[c].uv;
    const Page& page = mesh.pages[mesh.page_of(t)];
    used += 0.5 * std::abs((double{q.x} - p.x) * (double{r.y} - p.y) - (double{q.y} - p.y) * (double{r.x} - p.x)) *
            page.width * page.height;
  }
  for (const Page& p : mesh.pages) all += static_cast<double>(p.width) * p.height;
  return all > 0 ? used / all : 0;
}

CutMesh make_atlas(const AtlasComponent& component, std::uint32_t texture_size, Progress& progress) {
  mesh::ThreadPool here(1);
  const FlatCharts charts = lay_flat(component, ChartKinds::faces, progress, here);
  Placed placed = place(std::span(&component, 1), std::span(&charts, 1), {.width = texture_size});
  if (!placed.folded.empty())
    throw Error(ErrorCode::not_certified, "a triangle is too small for the numbers of the atlas");
  progress.report(Stage::atlas, 1, 1);
  return std::move(placed.mesh);
}

} // namespace orbis::texture
