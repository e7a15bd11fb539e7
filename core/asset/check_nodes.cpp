#include <vector>

#include "core/asset/check_document.h"
#include "core/asset/nodes.h"

namespace orbis::asset {
namespace {

constexpr std::size_t max_levels = 2000;
constexpr std::size_t none = static_cast<std::size_t>(-1);

// All 2x2 minors vanish: the image is a line or a point.
bool has_rank_below_two(const Matrix3& m) {
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t i2 = (i + 1) % 3, j2 = (j + 1) % 3;
      if (m[i][j] * m[i2][j2] != m[i][j2] * m[i2][j]) return false;
    }
  }
  return true;
}

class NodeTree {
public:
  explicit NodeTree(const Json& document) : reader_(document), document_(document) {
    if (const Json* nodes = find(document, "nodes")) nodes_ = nodes;
    const std::size_t count = nodes_ ? nodes_->size() : 0;
    parent_.assign(count, none);
    for (std::size_t n = 0; n < count; ++n) link_children(n);
    order_nodes();
  }

  void check_scales() const;

private:
  void link_children(std::size_t n) {
    const Json* children = reader_.array((*nodes_)[n], "children");
    if (!children) return;
    for (const Json& child : *children) {
      std::size_t& parent = parent_[child.get<std::size_t>()];
      if (parent != none) reader_.fail(child, {}, "names a node that already has a parent");
      parent = n;
    }
  }

  // Parents before children. A node with one parent that no root leads to lies on a cycle, or below one.
  void order_nodes() {
    std::vector<std::size_t> level(parent_.size(), 1);
    for (std::size_t n = 0; n < parent_.size(); ++n) {
      if (parent_[n] == none) order_.push_back(n);
    }
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const Json& node = (*nodes_)[order_[i]];
      if (level[order_[i]] > max_levels) {
        reader_.fail(node, {}, "is nested deeper than the limit of " + std::to_string(max_levels) + " levels",
                     ErrorCode::too_large);
      }
      const Json* children = find(node, "children");
      if (!children) continue;
      for (const Json& child : *children) {
        level[child.get<std::size_t>()] = level[order_[i]] + 1;
        order_.push_back(child.get<std::size_t>());
      }
    }
    if (order_.size() == parent_.size()) return;
    std::vector<bool> reached(parent_.size());
    for (const std::size_t n : order_) reached[n] = true;
    for (std::size_t n = 0; n < reached.size(); ++n) {
      if (!reached[n]) reader_.fail((*nodes_)[n], "children", "lead back to the node itself");
    }
  }

  [[nodiscard]] std::vector<bool> animated_nodes() const;

  JsonReader reader_;
  const Json& document_;
  const Json* nodes_ = nullptr;
  std::vector<std::size_t> parent_, order_;
};

// Nodes whose scale an animation may change. An animated property that is named by a pointer counts for every node.
std::vector<bool> NodeTree::animated_nodes() const {
  std::vector<bool> animated(parent_.size());
  const Json* animations = find(document_, "animations");
  if (!animations) return animated;
  for (const Json& animation : *animations) {
    const Json* channels = reader_.array(animation, "channels");
    if (!channels) continue;
    for (const Json& channel : *channels) {
      const Json& target = reader_.required_object(channel, "target");
      const std::string& path = reader_.required_text(target, "path");
      if (path == "pointer") animated.assign(animated.size(), true);
      if (const Json* node = find(target, "node"); node && path == "scale") animated[node->get<std::size_t>()] = true;
    }
  }
  return animated;
}

void NodeTree::check_scales() const {
  const std::vector<bool> animated = animated_nodes();
  std::vector<Matrix3> world(parent_.size());
  std::vector<bool> may_grow = animated;
  // For each mesh: the first node that scales it to nothing, unless another one shows it.
  std::vector<std::size_t> vanishing(array_size(document_, "meshes"), none);
  std::vector<bool> shown(vanishing.size());
  for (const std::size_t n : order_) {
    const Json& node = (*nodes_)[n];
    world[n] = local_placement(reader_, node).linear;
    if (const std::size_t p = parent_[n]; p != none) {
      world[n] = world[p] * world[n];
      if (may_grow[p]) may_grow[n] = true;
    }
    const auto mesh = reader_.integer(node, "mesh");
    if (!mesh) continue;
    // The joints, not the node, place a skinned mesh.
    const bool vanishes = !may_grow[n] && !find(node, "skin") && has_rank_below_two(world[n]);
    if (!vanishes) shown[*mesh] = true;
    if (vanishes && vanishing[*mesh] == none) vanishing[*mesh] = n;
  }
  for (std::size_t m = 0; m < vanishing.size(); ++m) {
    if (shown[m] || vanishing[m] == none) continue;
    throw Error(ErrorCode::invalid_geometry,
                "node " + std::to_string(vanishing[m]) + " scales mesh " + std::to_string(m) +
                    " to nothing; give it and the nodes above it a scale that is not 0",
                "/nodes/" + std::to_string(vanishing[m]));
  }
}

} // namespace

void check_nodes(const Json& document) { NodeTree(document).check_scales(); }

} // namespace orbis::asset
