// Meshes that some nodes mirror and others do not.
#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "core/asset/animated_property.h"
#include "core/asset/asset.h"
#include "core/asset/output.h"

namespace orbis::asset {

// How the nodes of the document show a mesh, all of them, whatever scene they are in.
struct Handedness {
  bool straight = false; // by some node; so is what joints place, and what no node shows
  bool mirrored = false; // by some node, whose transform has a negative determinant
  bool mixed = false;    // by the instances of one node (EXT_mesh_gpu_instancing), which count as straight then
};

// By mesh of the document. What animations make of it does not count.
[[nodiscard]] std::vector<Handedness> handedness_of_meshes(const Asset& asset);

// Gives the nodes that mirror a mesh a copy of it whose TANGENT has its w negated; all else the copy shares.
class MirroredInstances {
public:
  // Keeps references to both. asset: what the output's document came from.
  MirroredInstances(Output& out, const Asset& asset) : out_(out), asset_(asset) {}

  // A primitive that was written with its geometry, which outlives this: to be copied where geometry.mirrors_tangents.
  void add(const Json& primitive, const NewPrimitive& geometry);

  // When all primitives and nodes are there. Copies stand behind the other meshes. What animates a mesh by pointer
  // animates its copy too.
  void split();

private:
  [[nodiscard]] bool is_affected(const Json& mesh) const;
  [[nodiscard]] Json mirrored(Json primitive);
  std::size_t copy_of(std::size_t mesh);

  Output& out_;
  const Asset& asset_;
  std::map<std::size_t, const NewPrimitive*> by_tangent_; // by the accessor of TANGENT
  std::map<std::size_t, std::size_t> number_of_copy_;     // by mesh
  std::vector<PartCopy> copies_;
};

} // namespace orbis::asset
