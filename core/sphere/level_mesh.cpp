#include "core/sphere/level_mesh.h"

#include <algorithm>

namespace orbis::sphere {
namespace {

constexpr std::size_t grain = 4096;

void merge_sorted(std::vector<std::uint32_t>& into, std::vector<std::uint32_t> added) {
  std::ranges::sort(added);
  std::vector<std::uint32_t> merged(into.size() + added.size());
  std::ranges::merge(into, added, merged.begin());
  into = std::move(merged);
}

} // namespace

LevelMesh::LevelMesh(const Hierarchy& hierarchy)
    : vertices_(hierarchy.tetrahedron.begin(), hierarchy.tetrahedron.end()),
      slots_(hierarchy.tetrahedron_slots.begin(), hierarchy.tetrahedron_slots.end()),
      number_(hierarchy.removed.size() + hierarchy.tetrahedron.size()) {
  std::ranges::sort(vertices_);
  std::ranges::sort(slots_);
}

void LevelMesh::add_round(const Hierarchy& hierarchy, std::size_t round) {
  const std::uint32_t first = hierarchy.round_first[round], end = hierarchy.round_first[round + 1];
  merge_sorted(vertices_, {hierarchy.removed.begin() + first, hierarchy.removed.begin() + end});
  std::vector<std::uint32_t> slots;
  slots.reserve(2 * (end - first));
  for (std::uint32_t i = first; i < end; ++i) {
    slots.push_back(hierarchy.slots(i).front());
    slots.push_back(hierarchy.slots(i).back());
  }
  merge_sorted(slots_, std::move(slots));
}

void LevelMesh::build(const Hierarchy& hierarchy, std::span<const Vec3d> positions, double regularisation,
                      mesh::ThreadPool& pool) {
  positions_.resize(vertices_.size());
  pool.for_blocks(vertices_.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      number_[vertices_[i]] = static_cast<mesh::Index>(i);
      positions_[i] = positions[vertices_[i]];
    }
  });
  triangles_.resize(slots_.size());
  pool.for_blocks(slots_.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const mesh::Triangle& t = hierarchy.triangles[slots_[i]];
      triangles_[i] = {number_[t[0]], number_[t[1]], number_[t[2]]};
    }
  });
  stars_.build(triangles_, vertices_.size(), pool);
  compute_references(positions_, triangles_, regularisation, pool, references_);
}

} // namespace orbis::sphere
