// The instances of a node: EXT_mesh_gpu_instancing.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/asset/accessor_reader.h"
#include "core/asset/document.h"
#include "core/asset/placement.h"

namespace orbis::asset {

class InstanceReader {
public:
  // Keeps a reference.
  explicit InstanceReader(const Document& document) : document_(document) {}

  // TRANSLATION, ROTATION or SCALE of a node's instances; nothing where it has none, or one of another shape.
  [[nodiscard]] std::optional<Attribute> attribute(const Json& node, const std::string& name);

  // Where the instances of a node stand beneath it, the first `most` of them; the node's own place alone where it has
  // none.
  [[nodiscard]] std::vector<Placement> placements(const Json& node, std::size_t most);

private:
  const Document& document_;
  std::optional<tinygltf::Model> model_; // made when needed
};

} // namespace orbis::asset
