// Point location on a triangulated sphere, by a tree of boxes: no walk that could go astray where triangles are thin.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/mesh/triangle_mesh.h"
#include "core/vec3.h"

namespace orbis::remesh {

// A place on a triangle: the weights of its corners, not negative, sum 1.
struct Place {
  std::uint32_t triangle = 0;
  std::array<double, 3> weights{};
};

// Each triangle stands for its part of the sphere: the central projection of the flat triangle, whose points are
// sum w_i p_i. Projection keeps the lines, so the place of a direction d on a triangle (a, b, c) has the weights
// det(d, b, c) : det(d, c, a) : det(d, a, b).
class SphereTree {
public:
  // points: unit; triangles: indices into points, at least one. Both outlive the tree. O(n log n).
  SphereTree(std::span<const Vec3d> points, std::span<const mesh::Triangle> triangles);

  // The place on the sphere's triangulation in the direction d, a unit vector. Among the triangles that contain it up
  // to rounding, the one that it lies deepest in: so there is always an answer, and a place is never off by more than
  // rounding. Throws Error{internal} where nothing is near, which a triangulation of the whole sphere cannot have.
  [[nodiscard]] Place locate(const Vec3d& d) const;

  // Calls visit(triangle) for each one whose part of the sphere may meet that of the triangle (a, b, c), unit vectors:
  // all that do, and some that are merely close.
  template <class Visit> void near(const std::array<Vec3d, 3>& corners, Visit visit) const {
    search(box_of(corners), visit);
  }

private:
  struct Box {
    Vec3d low, high;
    [[nodiscard]] bool meets(const Box& other) const;
  };
  // An inner node has its left child behind it and its right child at `right`; a leaf has items [first, last).
  struct Node {
    Box box;
    std::uint32_t right = 0, first = 0, last = 0;
  };
  struct Item {
    Box box;
    std::uint32_t triangle = 0;
  };

  // Of the triangle's part of the sphere, bulge included.
  static Box box_of(const std::array<Vec3d, 3>& p);
  std::uint32_t build(std::uint32_t first, std::uint32_t last);

  template <class Visit> void search(const Box& box, Visit visit) const {
    std::array<std::uint32_t, 64> stack{}; // of a tree that halves its triangles: more than 2^32 need
    std::size_t waiting = 1;
    while (waiting > 0) {
      const std::uint32_t n = stack[--waiting];
      const Node& node = nodes_[n];
      if (!node.box.meets(box)) continue;
      if (node.right == 0) {
        for (std::uint32_t i = node.first; i < node.last; ++i)
          if (items_[i].box.meets(box)) visit(items_[i].triangle);
      } else {
        stack[waiting++] = node.right;
        stack[waiting++] = n + 1;
      }
    }
  }

  std::span<const Vec3d> points_;
  std::span<const mesh::Triangle> triangles_;
  std::vector<Item> items_; // in the order of the leaves
  std::vector<Node> nodes_;
};

} // namespace orbis::remesh
