// The local problem of the paper (section 3): where in its star on the sphere should a vertex lie?
//
//   ds(p) = sum_j w_j theta_j^2      theta_j: angle between p and its neighbour j, in radians; sum_j w_j = 1
//
// and the safeguard: a barrier that is exactly zero while every triangle of the star has V >= floor,
//
//   b(p) = floor sum_t (x_t - 1)^2 / x_t  for x_t < 1     x = V / floor,  V = det(p, q_k, q_k+1)
//
// Both are convex where the star lies within a hemisphere and V > 0 (V is linear in p), so the minimum is unique.
#pragma once

#include <vector>

#include "core/vec3.h"

namespace orbis::sphere {

// A vertex and its neighbours on the unit sphere.
struct Star {
  Vec3d centre;
  std::vector<Vec3d> ring;    // counter-clockwise seen from outside, closed; three points or more
  std::vector<double> weight; // one per neighbour, positive, of sum 1
};

// det(p, a, b): positive where the triangle is counter-clockwise seen from outside, about twice its area where it is
// small. From differences: the determinant of three nearly equal vectors would lose all its digits.
[[nodiscard]] inline double orientation_volume(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  return dot(p, cross(a - p, b - p));
}

// theta^2 for two unit vectors with the squared chord c = |p - q|^2 = 4 sin^2(theta / 2). Keeps full relative precision
// for small angles, where arccos(p . q) has none.
[[nodiscard]] double squared_angle(double c);

// ds(p) with the vertex at p, a unit vector; the safeguard left out.
[[nodiscard]] double angle_energy(const Star& star, const Vec3d& p);

// ds(p) + b(p); infinite where a triangle of the star is folded or has no area.
[[nodiscard]] double star_energy(const Star& star, const Vec3d& p, double floor);

// Value, gradient and Hessian of star_energy in the tangent plane at p: derivatives of s, t at 0 along the great
// circles through p. p must lie where star_energy is finite. Neighbours beyond a right angle contribute the positive
// part of their Hessian only.
struct StarDerivatives {
  Vec3d e1, e2;          // orthonormal basis of the tangent plane, (e1, e2, p) right-handed
  bool pressed = false;  // some triangle has V < floor / 10
  double value = 0;      // star_energy
  double g1 = 0, g2 = 0; // gradient along e1, e2
  double h11 = 0, h12 = 0, h22 = 0;
};
[[nodiscard]] StarDerivatives star_derivatives(const Star& star, const Vec3d& p, double floor);

// The best place found for the star's centre, and by how much it is better.
struct Place {
  Vec3d point;
  double ratio = 1;     // star_energy there / star_energy at the centre, at most 1; 1: stay
  bool pressed = false; // with the centre where it is, some triangle has V < floor / 10
};
// Newton's method from the centre, each step shortened until the energy falls; where the ring does not lie in the
// hemisphere around the centre, weighted means in the stereographic tangent plane come first. The star with its centre
// moved to the point has no folded triangle. The centre must lie where star_energy is finite.
//   gain  a step that promises less than this part of the energy is not made; in (0, 1)
[[nodiscard]] Place best_place(const Star& star, double floor, double gain);

// An orthonormal pair that makes a right-handed basis with the unit vector p.
struct TangentBasis {
  Vec3d e1, e2;
};
[[nodiscard]] TangentBasis tangent_basis(const Vec3d& p);

} // namespace orbis::sphere
