// Accessors as typed arrays: strides, sparse values and accessors without data resolved.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/asset/document.h"
#include "core/asset/typed_model.h"

namespace orbis::asset {

class AccessorReader {
public:
  // Both outlive the reader. `model` is typed_model(document.json).
  AccessorReader(const Document& document, const tinygltf::Model& model) : document_(document), model_(model) {}

  [[nodiscard]] const tinygltf::Accessor& accessor(std::size_t i) const { return model_.accessors.at(i); }

  // A vertex attribute, tightly packed. Expects a vector type. Throws Error{malformed} for sparse indices that are out
  // of range or do not increase.
  [[nodiscard]] Attribute attribute(std::size_t i, const std::string& name) const;
  // SCALAR of u8, u16 or u32, else Error{malformed}.
  [[nodiscard]] std::vector<std::uint32_t> indices(std::size_t i) const;

private:
  [[nodiscard]] Bytes packed(std::size_t i) const;
  void apply_sparse(std::size_t i, Bytes& out) const;
  [[nodiscard]] std::span<const std::byte> part(int view, std::size_t offset, std::size_t size) const;

  const Document& document_;
  const tinygltf::Model& model_;
};

} // namespace orbis::asset
