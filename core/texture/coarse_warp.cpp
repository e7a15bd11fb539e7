#include "core/texture/coarse_warp.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/texture/raster.h"

namespace orbis::texture {
namespace {

constexpr std::uint32_t first_cells = 4;
constexpr int first_sweeps = 40, later_sweeps = 10;

// A symmetric 2 x 2 matrix.
struct Symmetric {
  double xx = 0, xy = 0, yy = 0;

  void add(const Symmetric& m, double w) {
    xx += w * m.xx;
    xy += w * m.xy;
    yy += w * m.yy;
  }
  [[nodiscard]] double determinant() const { return xx * yy - xy * xy; }
};

// What lies in one half of a cell.
struct Content {
  double area = 0;                 // of the surface
  double area_of_holes = 0;        // part of it
  Symmetric stretched, contracted; // means over the surface of C and of adj(C^-1), see metric_of
};

// The surface's shape in the plane. With the surface laid out isometrically, B its map to the plane and J a map of the
// plane, |J B|^2 = tr(J C J^T), C = B B^T.
Symmetric metric_of(const std::array<FlatPoint, 3>& p, const PlaneReference& r) {
  // 1/2 sum cot |edge|^2 = A |B|^2 / 2 in each pair of directions.
  Symmetric c;
  for (std::size_t k = 0; k < 3; ++k) {
    const FlatPoint &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
    const double x = a.x - b.x, y = a.y - b.y;
    c.add({x * x, x * y, y * y}, r.cot[k] / (2 * r.area));
  }
  return c;
}

std::array<FlatPoint, 3> corners_of(const PlaneMesh& mesh, std::size_t t) {
  return {mesh.points[mesh.triangles[t][0]], mesh.points[mesh.triangles[t][1]], mesh.points[mesh.triangles[t][2]]};
}

// The halves of the cells: lower left of the diagonal from the cell's first corner, and upper right.
std::size_t half_at(const FlatPoint& p, std::uint32_t cells) {
  const double x = std::clamp(p.x, 0.0, 1.0) * cells, y = std::clamp(p.y, 0.0, 1.0) * cells;
  const auto i = std::min(static_cast<std::uint32_t>(x), cells - 1),
             j = std::min(static_cast<std::uint32_t>(y), cells - 1);
  return 2 * (std::size_t{j} * cells + i) + (x - i > y - j ? 1 : 0);
}

void add(const PlaneMesh& mesh, std::size_t t, double area, Content& content) {
  const Symmetric c = metric_of(corners_of(mesh, t), mesh.references[t]);
  content.area += area;
  if (mesh.references[t].closes_hole) content.area_of_holes += area;
  content.stretched.add(c, area);
  content.contracted.add(c, area / std::max(c.determinant(), 1e-300));
}

// Triangles count to the half that holds their centre; a half without any takes the triangle around its own centre.
std::vector<Content> contents(const PlaneMesh& mesh, std::uint32_t cells) {
  std::vector<Content> out(2 * std::size_t{cells} * cells);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto p = corners_of(mesh, t);
    const FlatPoint centre{(p[0].x + p[1].x + p[2].x) / 3, (p[0].y + p[1].y + p[2].y) / 3};
    add(mesh, t, mesh.references[t].area, out[half_at(centre, cells)]);
  }
  const std::vector<Content> before = out;
  const double half = 0.5 / (static_cast<double>(cells) * cells);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto p = corners_of(mesh, t);
    std::array<RasterPoint, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) corners[k] = {3 * cells * p[k].x, 3 * cells * p[k].y};
    const double density = mesh.references[t].area / (0.5 * doubled_area(p[0], p[1], p[2]));
    // The centres of the halves lie near the first and last of the nine parts of a cell beside the diagonal.
    rasterize(corners, 3 * cells, 3 * cells, [&](std::uint32_t x, std::uint32_t y, const std::array<double, 3>&) {
      const bool upper = x % 3 == 2 && y % 3 == 0, lower = x % 3 == 0 && y % 3 == 2;
      if (!upper && !lower) return;
      const std::size_t i = 2 * (std::size_t{y / 3} * cells + x / 3) + (upper ? 1 : 0);
      if (before[i].area == 0 && out[i].area == 0) add(mesh, t, density * half, out[i]);
    });
  }
  return out;
}

// A half of a cell as a triangle of the surface: with the area that lies in it, in the mean shape.
PlaneReference reference_of(const Content& content, const std::array<FlatPoint, 3>& p, double least_area) {
  // Both means, the one that stretched parts rule and the one that contracted parts rule, at determinant 1.
  Symmetric c;
  for (const Symmetric& m : {content.stretched, content.contracted}) {
    const double d = m.determinant();
    if (d > 0) c.add(m, 1 / std::sqrt(d));
  }
  if (!(c.determinant() > 0)) c = {1, 0, 1};
  // Lengths in the surface: e^T C^-1 e up to scale.
  const auto surface_length = [&](const FlatPoint& a, const FlatPoint& b) {
    const double x = a.x - b.x, y = a.y - b.y;
    return c.yy * x * x - 2 * c.xy * x * y + c.xx * y * y;
  };
  const double l0 = surface_length(p[1], p[2]), l1 = surface_length(p[2], p[0]), l2 = surface_length(p[0], p[1]);
  const double four_areas = 2 * std::sqrt(c.determinant()) * std::abs(doubled_area(p[0], p[1], p[2]));
  const double sum = l0 + l1 + l2;
  return {{(sum - 2 * l0) / four_areas, (sum - 2 * l1) / four_areas, (sum - 2 * l2) / four_areas},
          std::max(content.area, least_area),
          2 * content.area_of_holes > content.area};
}

} // namespace

CoarseWarp::CoarseWarp(const PlaneMesh& mesh, std::uint32_t cells) {
  double total = 0;
  for (const PlaneReference& r : mesh.references) total += r.area;
  const double side = std::sqrt(total);
  grid_.points = {{0, 0}, {side, 0}, {0, side}, {side, side}};
  for (std::uint32_t n = std::min(first_cells, cells); n <= cells; n *= 2) {
    CoarseWarp finer = *this;
    finer.cells_ = n;
    finer.grid_ = {};
    finer.grid_.exponent = mesh.exponent;
    for (std::uint32_t y = 0; y <= n; ++y)
      for (std::uint32_t x = 0; x <= n; ++x) {
        finer.grid_.points.push_back(linear({static_cast<double>(x) / n, static_cast<double>(y) / n}));
        finer.grid_.fixed_x.push_back(x == 0 || x == n);
        finer.grid_.fixed_y.push_back(y == 0 || y == n);
      }
    const std::vector<Content> content = contents(mesh, n);
    for (std::uint32_t y = 0; y < n; ++y)
      for (std::uint32_t x = 0; x < n; ++x) {
        const auto corner = [&](std::uint32_t i, std::uint32_t j) { return finer.node(x + i, y + j); };
        const auto at = [&](std::uint32_t i, std::uint32_t j) {
          return FlatPoint{static_cast<double>(x + i) / n, static_cast<double>(y + j) / n};
        };
        const std::size_t i = 2 * (std::size_t{y} * n + x);
        const double least = 1e-4 * total / (2.0 * n * n);
        finer.grid_.triangles.push_back({corner(0, 0), corner(0, 1), corner(1, 1)});
        finer.grid_.references.push_back(reference_of(content[i], {at(0, 0), at(0, 1), at(1, 1)}, least));
        finer.grid_.triangles.push_back({corner(0, 0), corner(1, 1), corner(1, 0)});
        finer.grid_.references.push_back(reference_of(content[i + 1], {at(0, 0), at(1, 1), at(1, 0)}, least));
      }
    stretch_to_best(finer.grid_);
    relax(finer.grid_, n == first_cells ? first_sweeps : later_sweeps);
    stretch_to_best(finer.grid_);
    *this = std::move(finer);
  }
}

FlatPoint CoarseWarp::linear(const FlatPoint& at) const {
  const double x = std::clamp(at.x, 0.0, 1.0) * cells_, y = std::clamp(at.y, 0.0, 1.0) * cells_;
  const auto i = std::min(static_cast<std::uint32_t>(x), cells_ - 1),
             j = std::min(static_cast<std::uint32_t>(y), cells_ - 1);
  const double s = x - i, t = y - j;
  const FlatPoint &o = grid_.points[node(i, j)], &d = grid_.points[node(i + 1, j + 1)];
  const FlatPoint& side = s > t ? grid_.points[node(i + 1, j)] : grid_.points[node(i, j + 1)];
  const double w = std::min(s, t), v = std::max(s, t) - w, u = 1 - w - v;
  return {u * o.x + v * side.x + w * d.x, u * o.y + v * side.y + w * d.y};
}

// Beyond the border the grid goes on as its reflection in the border's nodes, so that sides stay where they are.
FlatPoint CoarseWarp::control(std::int64_t x, std::int64_t y) const {
  const std::int64_t n = cells_, border_x = std::clamp<std::int64_t>(x, 0, n),
                     border_y = std::clamp<std::int64_t>(y, 0, n);
  const auto reflected = [](const FlatPoint& border, const FlatPoint& inside) {
    return FlatPoint{2 * border.x - inside.x, 2 * border.y - inside.y};
  };
  if (x != border_x) return reflected(control(border_x, y), control(2 * border_x - x, y));
  if (y != border_y) return reflected(control(x, border_y), control(x, 2 * border_y - y));
  return grid_.points[node(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))];
}

FlatPoint CoarseWarp::operator()(const FlatPoint& at) const {
  const auto weights = [](double t) {
    const double u = 1 - t;
    return std::array{u * u * u / 6, (3 * t * t * t - 6 * t * t + 4) / 6, (3 * u * u * u - 6 * u * u + 4) / 6,
                      t * t * t / 6};
  };
  const double x = std::clamp(at.x, 0.0, 1.0) * cells_, y = std::clamp(at.y, 0.0, 1.0) * cells_;
  const auto i = std::min<std::int64_t>(static_cast<std::int64_t>(x), cells_ - 1),
             j = std::min<std::int64_t>(static_cast<std::int64_t>(y), cells_ - 1);
  const auto wx = weights(x - static_cast<double>(i)), wy = weights(y - static_cast<double>(j));
  FlatPoint sum;
  for (std::size_t l = 0; l < 4; ++l)
    for (std::size_t k = 0; k < 4; ++k) {
      const FlatPoint c = control(i + static_cast<std::int64_t>(k) - 1, j + static_cast<std::int64_t>(l) - 1);
      sum.x += wx[k] * wy[l] * c.x;
      sum.y += wx[k] * wy[l] * c.y;
    }
  return sum;
}

} // namespace orbis::texture
