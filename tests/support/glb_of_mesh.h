// Meshes as GLB files, for tests that start at the front door.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/shapes.h"

namespace orbis {

// Puts a GLB together from arrays.
class GlbOfMesh {
public:
  template <class T>
  std::size_t add(const std::vector<T>& values, int component_type, const char* type, std::size_t count,
                  int target = 34962) {
    while (binary_.size() % 4 != 0) binary_.push_back(std::byte{0});
    const std::size_t bytes = values.size() * sizeof(T);
    document_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", bytes}, {"target", target}});
    const auto* first = reinterpret_cast<const std::byte*>(values.data());
    binary_.insert(binary_.end(), first, first + bytes);
    document_["accessors"].push_back({{"bufferView", document_["bufferViews"].size() - 1},
                                      {"componentType", component_type},
                                      {"count", count},
                                      {"type", type}});
    return document_["accessors"].size() - 1;
  }

  std::size_t add_positions(const std::vector<Vec3f>& positions) {
    const std::size_t a = add(positions, 5126, "VEC3", positions.size());
    std::array<float, 3> low{1e38F, 1e38F, 1e38F}, high{-1e38F, -1e38F, -1e38F};
    for (const Vec3f& p : positions) {
      low = {std::min(low[0], p.x), std::min(low[1], p.y), std::min(low[2], p.z)};
      high = {std::max(high[0], p.x), std::max(high[1], p.y), std::max(high[2], p.z)};
    }
    document_["accessors"][a]["min"] = low;
    document_["accessors"][a]["max"] = high;
    return a;
  }

  std::size_t add_indices(const std::vector<mesh::Triangle>& triangles) {
    return add(triangles, 5125, "SCALAR", triangles.size() * 3, 34963);
  }

  nlohmann::json& document() { return document_; }

  std::vector<std::byte> bytes() {
    while (binary_.size() % 4 != 0) binary_.push_back(std::byte{0});
    document_["asset"]["version"] = "2.0";
    document_["buffers"] = nlohmann::json::array({{{"byteLength", binary_.size()}}});
    std::string json = document_.dump();
    while (json.size() % 4 != 0) json += ' ';
    std::vector<std::byte> out;
    const auto word = [&](std::uint32_t w) {
      for (int i = 0; i < 4; ++i) out.push_back(static_cast<std::byte>(w >> (8 * i)));
    };
    word(0x46546C67);
    word(2);
    word(static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + binary_.size()));
    word(static_cast<std::uint32_t>(json.size()));
    word(0x4E4F534A);
    for (const char c : json) out.push_back(static_cast<std::byte>(c));
    word(static_cast<std::uint32_t>(binary_.size()));
    word(0x004E4942);
    out.insert(out.end(), binary_.begin(), binary_.end());
    return out;
  }

private:
  nlohmann::json document_;
  std::vector<std::byte> binary_;
};

inline nlohmann::json one_primitive(nlohmann::json attributes, std::size_t indices) {
  nlohmann::json primitive;
  primitive["attributes"] = std::move(attributes);
  primitive["indices"] = indices;
  nlohmann::json mesh;
  mesh["primitives"] = nlohmann::json::array({primitive});
  return nlohmann::json::array({mesh});
}

inline void one_node(nlohmann::json& document) {
  document["nodes"] = nlohmann::json::parse(R"([{"mesh": 0}])");
  document["scenes"] = nlohmann::json::parse(R"([{"nodes": [0]}])");
}

inline std::vector<std::byte> glb_of(const mesh::TriangleMesh& m) {
  GlbOfMesh glb;
  nlohmann::json attributes;
  attributes["POSITION"] = glb.add_positions(m.positions);
  const std::size_t indices = glb.add_indices(m.triangles);
  glb.document()["meshes"] = one_primitive(attributes, indices);
  one_node(glb.document());
  return glb.bytes();
}

// Every triangle with three vertices of its own, and a texture coordinate that tells them apart.
inline std::vector<std::byte> soup_glb_of(const mesh::TriangleMesh& m) {
  GlbOfMesh glb;
  std::vector<Vec3f> positions;
  std::vector<Vec2f> uv;
  std::vector<mesh::Triangle> triangles;
  for (const mesh::Triangle& t : m.triangles) {
    const auto first = static_cast<mesh::Index>(positions.size());
    for (const mesh::Index v : t) {
      uv.push_back({static_cast<float>(positions.size()) / 4096, static_cast<float>(v) / 4096});
      positions.push_back(m.positions[v]);
    }
    triangles.push_back({first, first + 1, first + 2});
  }
  nlohmann::json attributes;
  attributes["POSITION"] = glb.add_positions(positions);
  attributes["TEXCOORD_0"] = glb.add(uv, 5126, "VEC2", uv.size());
  const std::size_t indices = glb.add_indices(triangles);
  glb.document()["meshes"] = one_primitive(attributes, indices);
  one_node(glb.document());
  return glb.bytes();
}

// Each vertex fully bound to one of five joints, by its number.
inline std::vector<std::byte> skinned_glb_of(const mesh::TriangleMesh& m) {
  GlbOfMesh glb;
  std::vector<std::uint8_t> joints;
  std::vector<float> weights;
  for (std::size_t v = 0; v < m.positions.size(); ++v) {
    const auto first = static_cast<std::uint8_t>(v % 5), second = static_cast<std::uint8_t>((v + 2) % 5);
    joints.insert(joints.end(), {first, second, 0, 0});
    weights.insert(weights.end(), {0.75F, 0.25F, 0, 0});
  }
  nlohmann::json attributes;
  attributes["POSITION"] = glb.add_positions(m.positions);
  attributes["JOINTS_0"] = glb.add(joints, 5121, "VEC4", m.positions.size());
  attributes["WEIGHTS_0"] = glb.add(weights, 5126, "VEC4", m.positions.size());
  const std::size_t indices = glb.add_indices(m.triangles);
  glb.document()["meshes"] = one_primitive(attributes, indices);
  glb.document()["nodes"] = nlohmann::json::parse(R"([{"mesh": 0, "skin": 0}, {}, {}, {}, {}, {}])");
  glb.document()["scenes"] = nlohmann::json::parse(R"([{"nodes": [0, 1, 2, 3, 4, 5]}])");
  glb.document()["skins"] = nlohmann::json::parse(R"([{"joints": [1, 2, 3, 4, 5]}])");
  return glb.bytes();
}

} // namespace orbis
