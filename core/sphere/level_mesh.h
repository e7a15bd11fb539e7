// One level of detail of the hierarchy, densely numbered in the order of the input.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/sphere/hierarchy.h"
#include "core/sphere/reference.h"
#include "core/sphere/star_table.h"

namespace orbis::sphere {

// What a level's vertices and triangles are called in the hierarchy, and the level by itself: arrays without gaps, so
// that a coarse level fits into a cache.
class LevelMesh {
public:
  explicit LevelMesh(const Hierarchy& hierarchy);

  // Takes in a round whose removals have been undone.
  void add_round(const Hierarchy& hierarchy, std::size_t round);

  // Makes triangles, stars and references. regularisation: as of compute_references.
  void build(const Hierarchy& hierarchy, std::span<const Vec3d> positions, double regularisation,
             mesh::ThreadPool& pool);

  [[nodiscard]] std::span<const mesh::Index> vertices() const { return vertices_; } // in the hierarchy
  [[nodiscard]] std::span<const mesh::Triangle> triangles() const { return triangles_; }
  [[nodiscard]] const StarTable& stars() const { return stars_; }
  [[nodiscard]] std::span<const Reference> references() const { return references_; }
  // What the hierarchy's vertex v is called here.
  [[nodiscard]] mesh::Index number_of(mesh::Index v) const { return number_[v]; }

private:
  std::vector<mesh::Index> vertices_;
  std::vector<std::uint32_t> slots_;
  std::vector<mesh::Index> number_; // by vertex of the hierarchy; those that are not live have an old one
  std::vector<mesh::Triangle> triangles_;
  std::vector<Vec3d> positions_;
  std::vector<Reference> references_;
  StarTable stars_;
};

} // namespace orbis::sphere
