// How far a piecewise linear map from a surface to the plane is from keeping shapes and areas.
//
// For a triangle (p, a, b) with reference area A and reference angles,
//
//   D = 1/2 sum cot(opposite angle) |edge|^2    Dirichlet energy of the linear map (Pinkall and Polthier 1993)
//   V                                           twice the image's area, signed; 0 exactly at a fold
//   x = V / (2 A)                               area ratio
//   E = A (D / V) ((x + 1/x) / 2)^n             = A where isometric
//
// D / V measures angles alone (Hormann and Greiner, MIPS, 2000); the second factor measures areas. With the exponent
// n = 1 this is the symmetric Dirichlet energy (Smith and Schaefer 2015); higher ones weigh areas more, since an atlas
// is for even texels (docs/atlas.md has the figures). Triangles that only close a hole have n = 1 whatever the others
// have: they are to shrink, but not at the cost of the surface. E grows without bound at a fold: descent keeps
// orientation.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/texture/flat_charts.h"

namespace orbis::texture {

// Of one triangle: the cotangents of its angles on the surface, corner by corner, its area there, and whether it is no
// part of the surface and closes a hole.
struct PlaneReference {
  std::array<double, 3> cot{};
  double area = 0;
  bool closes_hole = false;
};

// Slivers are rounded off: a hundred-thousandth of the mean squared edge length is added to the squared lengths, so
// that cotangents stay finite. A triangle without extent is taken as equilateral, of area 0.
[[nodiscard]] PlaneReference plane_reference(const Vec3d& p0, const Vec3d& p1, const Vec3d& p2);

// A flat mesh whose points may move within a rectangle.
struct PlaneMesh {
  std::vector<FlatPoint> points;
  std::vector<bool> fixed_x, fixed_y; // one per point
  std::vector<mesh::Triangle> triangles;
  std::vector<PlaneReference> references; // one per triangle, areas above 0
  int exponent = 4;                       // n of the surface's triangles, a multiple of 4
};

// Twice the area of a triangle as it is seen from outside the surface, with y down; positive where it is not folded.
[[nodiscard]] inline double doubled_area(const FlatPoint& p, const FlatPoint& a, const FlatPoint& b) {
  return (a.y - p.y) * (b.x - p.x) - (a.x - p.x) * (b.y - p.y);
}

// The sum of E over the triangles, which must be positive.
[[nodiscard]] double energy_of(const PlaneMesh& mesh);

// Lowers the energy: sweeps over the points with one safeguarded Newton step each. Points whose step gains less than
// one part in a hundred of their star's energy rest until a neighbour moves. All triangles must be positive, and stay
// so. Deterministic; O(points) a sweep.
void relax(PlaneMesh& mesh, int sweeps);

// Scales the mesh along the two axes to where its energy is least.
void stretch_to_best(PlaneMesh& mesh);

} // namespace orbis::texture
