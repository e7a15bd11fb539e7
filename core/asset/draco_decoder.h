// Draco meshes, through libdraco's decoder: the whole of a .drc file and the buffers of KHR_draco_mesh_compression.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/asset/asset.h"

namespace draco {
class Mesh;
}

namespace orbis::asset {

[[nodiscard]] bool is_draco(std::span<const std::byte> bytes);

class DracoMesh {
public:
  // The counts that the header claims are held against the limits and the size of the data before the decoder runs
  // (a few hundred bytes can ask for gigabytes), and every index is checked afterwards (damaged data often decodes
  // without an error). `where` goes into errors. Throws Error: malformed, too_large, invalid_geometry for a point
  // cloud.
  DracoMesh(std::span<const std::byte> bytes, const Limits& limits, const std::string& where);
  ~DracoMesh();

  [[nodiscard]] std::size_t vertex_count() const;
  [[nodiscard]] std::vector<std::uint32_t> indices() const; // three per triangle, all below vertex_count()

  enum class Use { position, normal, color, texcoord, generic };
  struct Info {
    std::uint32_t id = 0; // Draco's unique id, as glTF names it
    Use use = Use::generic;
    ComponentType type = ComponentType::f32; // f32 where glTF has no such type
    bool exact = true;                       // false: conversion to `type` may round
    bool normalized = false;
    std::uint32_t components = 0;
  };
  [[nodiscard]] std::vector<Info> attributes() const;

  // The values of attribute `id` as `type`, one per vertex, converted only where the stored type is another. Throws
  // Error{malformed} where there is no such attribute or its number of components is not `components`.
  [[nodiscard]] Bytes values(std::uint32_t id, ComponentType type, std::uint32_t components) const;

private:
  std::unique_ptr<draco::Mesh> mesh_;
  std::string where_;
};

} // namespace orbis::asset
