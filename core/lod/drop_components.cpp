#include "core/lod/drop_components.h"

#include <algorithm>
#include <vector>

namespace orbis::lod {
namespace {

struct Component {
  double area = 0; // on the full surface, creases weighing more
  Vec3d low, high;
  std::uint32_t first = 0; // a point of it
};

void grow(Component& c, const Vec3d& p) {
  c.low = {std::min(c.low.x, p.x), std::min(c.low.y, p.y), std::min(c.low.z, p.z)};
  c.high = {std::max(c.high.x, p.x), std::max(c.high.y, p.y), std::max(c.high.z, p.z)};
}

std::vector<Component> components_of(const WedgeMesh& mesh) {
  std::vector<Component> out;
  std::vector<bool> seen(mesh.points.size());
  std::vector<std::uint32_t> ring, stack;
  for (std::uint32_t p = 0; p < mesh.points.size(); ++p) {
    if (!mesh.points[p].is_alive || seen[p]) continue;
    Component& component = out.emplace_back(Component{0, mesh.points[p].position, mesh.points[p].position, p});
    seen[p] = true;
    stack.assign(1, p);
    while (!stack.empty()) {
      const std::uint32_t q = stack.back();
      stack.pop_back();
      grow(component, mesh.points[q].position);
      mesh.for_each_corner(
          q, [&](std::uint32_t c) { component.area += mesh.quadrics[mesh.triangles[c / 3][c % 3]].weight; });
      mesh.neighbours_of(q, ring);
      for (const std::uint32_t r : ring) {
        if (seen[r]) continue;
        seen[r] = true;
        stack.push_back(r);
      }
    }
  }
  return out;
}

} // namespace

Dropped drop_components(WedgeMesh& mesh, std::uint64_t triangles, double below) {
  std::vector<Component> components = components_of(mesh);
  std::stable_sort(components.begin(), components.end(),
                   [](const Component& a, const Component& b) { return a.area < b.area; });
  Dropped out;
  for (const Component& c : components) {
    if (mesh.triangle_count <= triangles || out.components + 1 == components.size()) break;
    const double size = norm(c.high - c.low);
    if (!(size < below)) continue;
    out.triangles += mesh.remove_component(c.first);
    ++out.components;
    out.largest = std::max(out.largest, size);
  }
  return out;
}

} // namespace orbis::lod
