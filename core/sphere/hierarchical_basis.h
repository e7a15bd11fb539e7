// A preconditioner from the hierarchy that the map grew on.
//
// A smooth displacement of the sphere is told by few vertices: those of a coarse level, with the others carried along.
// In the hierarchical basis (Yserentant, On the multi-level splitting of finite element spaces, 1986) a vertex' value
// is what its ring carries to it, plus a part of its own; the Hessian is nearly diagonal there, with the diagonal that
// each vertex had at the level at which it was inserted. For conjugate gradients that turns hundreds of iterations into
// tens, whatever the size of the mesh.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/checkpoints.h"
#include "core/mesh/thread_pool.h"
#include "core/sphere/distortion_energy.h"
#include "core/sphere/hierarchy.h"

namespace orbis::sphere {

// A vector of the tangent plane, in the frame of its vertex (TangentFrame).
struct Tangent {
  double x = 0, y = 0;
};

class HierarchicalBasis {
public:
  // hierarchy: must outlive this.
  HierarchicalBasis(const Hierarchy& hierarchy, mesh::ThreadPool& pool);

  // Keeps the stiffness that vertex v has now, at point p, as its diagonal block: to be called once its level is
  // relaxed.
  void keep_stiffness(mesh::Index v, const Expansion& expansion, const Vec3d& p);

  // The stiffness kept of these vertices, to go on from a checkpoint.
  void write_stiffness(std::span<const mesh::Index> vertices, StateWriter& state) const;
  void read_stiffness(std::span<const mesh::Index> vertices, StateReader& state);

  // Gets ready for points that the caller then leaves alone: frames, and the mean value weights (Floater 2003) by which
  // a ring carries its vertex. points: all vertices of the mesh, the finest level.
  void prepare(std::span<const Vec3d> points);

  // out = S diag^-1 S^T in: symmetric and positive definite. Both by vertex number.
  void apply(std::span<const Tangent> in, std::span<Tangent> out);

private:
  void weigh_ring(std::size_t removal, std::span<const Vec3d> points);
  void hand_to_rings(std::size_t round);
  void carry_by_rings(std::size_t round);

  const Hierarchy& hierarchy_;
  mesh::ThreadPool& pool_;
  std::vector<std::array<float, 6>> stiffness_; // symmetric 3 x 3 in space, by vertex: xx xy xz yy yz zz
  // All that follows is in floats: a preconditioner need not be exact, only the same every time.
  struct Frame {
    Vec3f x, y;
  };
  std::vector<std::array<float, 3>> inverse_; // xx xy yy in the frame
  std::vector<Frame> frames_;
  std::vector<float> weights_; // parallel to hierarchy.ring_vertices; a ring's add up to 1
  std::vector<Vec3f> field_;   // the vector being carried, in space
};

} // namespace orbis::sphere
