#include "core/mesh/gluing.h"

#include <algorithm>

#include "core/mesh/edges.h"

namespace orbis::mesh {

bool have_same_points(const Triangle& s, const Triangle& t) {
  return std::ranges::all_of(s, [&](Index v) { return v == t[0] || v == t[1] || v == t[2]; });
}

namespace {

bool is_shared(std::span<const Triangle> triangles, std::span<const EdgeSide> sides) {
  return sides.size() > 2 ||
         (sides.size() == 2 && have_same_points(triangles[sides[0].half_edge / 3], triangles[sides[1].half_edge / 3]));
}

void append(std::span<const EdgeSide> sides, SharedEdges& out) {
  out.emplace_back();
  for (const EdgeSide& side : sides) out.back().push_back(side.half_edge);
}

} // namespace

GluedSoup glue_pairs(std::span<const Triangle> triangles, std::size_t points) {
  GluedSoup out;
  out.gluing.triangles.assign(triangles.begin(), triangles.end());
  out.gluing.twin.assign(3 * triangles.size(), open_edge);
  EdgeTable(triangles, points).for_each([&](Index, Index, std::span<const EdgeSide> sides) {
    if (is_shared(triangles, sides)) {
      append(sides, out.shared);
    } else if (sides.size() == 2) {
      out.gluing.glue(sides[0].half_edge, sides[1].half_edge);
    }
  });
  return out;
}

SharedEdges shared_edges(std::span<const Triangle> triangles, std::size_t points) {
  SharedEdges out;
  EdgeTable(triangles, points).for_each([&](Index, Index, std::span<const EdgeSide> sides) {
    if (is_shared(triangles, sides)) append(sides, out);
  });
  return out;
}

Fans fans_of(const Gluing& gluing) {
  constexpr Index none = std::numeric_limits<Index>::max();
  const std::vector<std::uint32_t>& twin = gluing.twin;
  Fans out{std::vector<Index>(twin.size(), none), 0};
  for (std::uint32_t first = 0; first < twin.size(); ++first) {
    if (out.of_corner[first] != none) continue;
    const Index fan = out.count++;
    // Counter-clockwise until the fan closes or ends at an open edge; then clockwise for what is left of it.
    std::uint32_t corner = first;
    while (corner != open_edge && out.of_corner[corner] == none) {
      out.of_corner[corner] = fan;
      corner = twin[previous_in_triangle(corner)];
    }
    if (corner != open_edge) continue;
    for (std::uint32_t h = twin[first]; h != open_edge; h = twin[next_in_triangle(h)]) {
      out.of_corner[next_in_triangle(h)] = fan;
    }
  }
  return out;
}

std::vector<std::vector<std::uint32_t>> boundary_loops(const Gluing& gluing) {
  std::vector<std::vector<std::uint32_t>> out;
  std::vector<bool> seen(gluing.twin.size(), false);
  for (std::uint32_t first = 0; first < gluing.twin.size(); ++first) {
    if (!gluing.is_open(first) || seen[first]) continue;
    out.emplace_back();
    for (std::uint32_t h = first; !seen[h];) {
      seen[h] = true;
      out.back().push_back(h);
      // The next open edge around the vertex that h leads to.
      h = next_in_triangle(h);
      while (!gluing.is_open(h)) h = next_in_triangle(gluing.twin[h]);
    }
  }
  return out;
}

Pieces pieces_of(const Gluing& gluing) {
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  Pieces out{std::vector<std::uint32_t>(gluing.triangles.size(), none), 0};
  std::vector<std::uint32_t> stack;
  for (std::uint32_t first = 0; first < gluing.triangles.size(); ++first) {
    if (out.of_triangle[first] != none) continue;
    const std::uint32_t piece = out.count++;
    out.of_triangle[first] = piece;
    stack.push_back(first);
    while (!stack.empty()) {
      const std::uint32_t t = stack.back();
      stack.pop_back();
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t h = gluing.twin[3 * t + k];
        if (h == open_edge || out.of_triangle[h / 3] != none) continue;
        out.of_triangle[h / 3] = piece;
        stack.push_back(h / 3);
      }
    }
  }
  return out;
}

} // namespace orbis::mesh
