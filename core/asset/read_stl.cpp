#include "core/asset/read_stl.h"

#include <array>
#include <bit>
#include <cstring>
#include <unordered_map>

#include "core/asset/text_reader.h"
#include "core/model_format.h"

namespace orbis::asset {
namespace {

using Corner = std::array<float, 3>;

struct CornerHash {
  std::size_t operator()(const Corner& p) const {
    std::uint64_t hash = 0;
    for (const float x : p) hash = (hash ^ std::bit_cast<std::uint32_t>(x)) * 0x9E3779B97F4A7C15ull;
    return static_cast<std::size_t>(hash ^ (hash >> 32));
  }
};

// The triangles of one solid, with one vertex for each position.
class Solid {
public:
  explicit Solid(const Limits& limits) : limits_(limits) {}

  void add_corner(Corner p) {
    for (float& x : p) x += 0.0f; // -0 and 0 are one place
    if (indices_.size() >= 3 * limits_.max_triangles) {
      throw Error(ErrorCode::too_large,
                  "the STL has more than the limit of " + std::to_string(limits_.max_triangles) + " triangles");
    }
    const auto [place, is_new] = number_of_.try_emplace(p, static_cast<std::uint32_t>(number_of_.size()));
    if (is_new) {
      const auto* bytes = reinterpret_cast<const std::byte*>(p.data());
      positions_.insert(positions_.end(), bytes, bytes + sizeof p);
    }
    indices_.push_back(place->second);
  }

  [[nodiscard]] std::size_t corners() const { return indices_.size(); }

  // Hands the triangles over as a mesh, and begins anew.
  void move_to(ModelBuilder& model, std::string_view name) {
    if (indices_.empty()) return;
    const Attribute position{"POSITION", ComponentType::f32, false, 3, std::move(positions_)};
    model.add_primitive(model.add_mesh(name), indices_, std::span(&position, 1), std::nullopt);
    number_of_.clear();
    positions_.clear();
    indices_.clear();
  }

private:
  const Limits& limits_;
  std::unordered_map<Corner, std::uint32_t, CornerHash> number_of_;
  Bytes positions_;
  std::vector<std::uint32_t> indices_;
};

float float_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < 4; ++i) bits |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  return std::bit_cast<float>(bits);
}

// recognise() has held the size against the count.
void read_binary(std::span<const std::byte> bytes, const Limits& limits, ModelBuilder& model) {
  constexpr std::size_t header = 84, record = 50, normal = 12;
  Solid solid(limits);
  for (std::size_t at = header; at + record <= bytes.size(); at += record) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t p = at + normal + 12 * corner;
      solid.add_corner({float_at(bytes, p), float_at(bytes, p + 4), float_at(bytes, p + 8)});
    }
  }
  solid.move_to(model, "");
}

void read_text(std::span<const std::byte> bytes, const Limits& limits, ModelBuilder& model) {
  TextReader text(bytes, "the STL file");
  Solid solid(limits);
  std::string name;
  while (text.next_line()) {
    const std::string_view word = text.word();
    if (word == "solid") {
      name = text.rest_of_line();
    } else if (word == "vertex") {
      Corner p{};
      for (float& x : p) x = text.number<float>(text.word());
      solid.add_corner(p);
    } else if (word == "endfacet") {
      if (solid.corners() % 3 != 0) text.fail("a facet does not have three vertices");
    } else if (word == "endsolid") {
      solid.move_to(model, name);
    }
  }
  if (solid.corners() > 0) text.fail("the file ends within a solid; it is truncated");
}

} // namespace

Converted read_stl(std::span<const std::byte> bytes, const Limits& limits) {
  ModelBuilder model;
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (is_binary_stl(head, bytes.size())) {
    read_binary(bytes, limits, model);
  } else {
    read_text(bytes, limits, model);
  }
  return {model.glb(), {}};
}

} // namespace orbis::asset
