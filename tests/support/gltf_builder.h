// Small glTF files, built in code.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace orbis::test {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<std::byte>;

template <class T> Bytes bytes_of(std::span<const T> values) {
  const auto bytes = std::as_bytes(values);
  return {bytes.begin(), bytes.end()};
}
template <class T> Bytes bytes_of(std::initializer_list<T> values) {
  return bytes_of(std::span<const T>(values.begin(), values.size()));
}
inline Bytes bytes_of(std::string_view text) { return bytes_of(std::span<const char>(text)); }

template <class T> constexpr int component_code() {
  if constexpr (std::is_same_v<T, std::int8_t>) return 5120;
  if constexpr (std::is_same_v<T, std::uint8_t>) return 5121;
  if constexpr (std::is_same_v<T, std::int16_t>) return 5122;
  if constexpr (std::is_same_v<T, std::uint16_t>) return 5123;
  if constexpr (std::is_same_v<T, std::uint32_t>) return 5125;
  return 5126;
}

inline std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    const std::size_t have = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (k < have ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) out += k <= have ? digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

// Joins chunks as they are: no check, so that tests can build broken containers.
inline Bytes glb_of(std::string json, const std::optional<Bytes>& bin) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto words = [](std::initializer_list<std::uint32_t> w) { return bytes_of(w); };
  const auto append = [](Bytes& to, const Bytes& from) { to.insert(to.end(), from.begin(), from.end()); };
  Bytes body = words({static_cast<std::uint32_t>(json.size()), 0x4E4F534A});
  append(body, bytes_of(json));
  if (bin) {
    Bytes padded = *bin;
    padded.resize((padded.size() + 3) / 4 * 4);
    append(body, words({static_cast<std::uint32_t>(padded.size()), 0x004E4942}));
    append(body, padded);
  }
  Bytes out = words({0x46546C67, 2, static_cast<std::uint32_t>(body.size() + 12)});
  append(out, body);
  return out;
}

// A document under construction. Nothing is checked.
class GltfBuilder {
public:
  Json json{{"asset", {{"version", "2.0"}}}};
  Bytes bin;

  // References to parts of the document stay valid while top-level arrays are added.
  GltfBuilder() { json.get_ref<Json::object_t&>().reserve(32); }
  GltfBuilder(const GltfBuilder& other) : GltfBuilder() {
    for (const auto& [key, value] : other.json.get_ref<const Json::object_t&>()) json[key] = value;
    bin = other.bin;
  }
  GltfBuilder& operator=(const GltfBuilder&) = delete;

  std::size_t add_view(const Bytes& data, std::size_t stride = 0) {
    bin.resize((bin.size() + 3) / 4 * 4);
    Json view{{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", data.size()}};
    if (stride != 0) view["byteStride"] = stride;
    bin.insert(bin.end(), data.begin(), data.end());
    return append("bufferViews", view);
  }

  template <class T>
  std::size_t add_accessor(const std::vector<T>& values, std::string_view type, std::size_t components,
                           bool normalized = false) {
    Json accessor{{"bufferView", add_view(bytes_of(std::span<const T>(values)))},
                  {"componentType", component_code<T>()},
                  {"count", values.size() / components},
                  {"type", type}};
    if (normalized) accessor["normalized"] = true;
    return append("accessors", accessor);
  }

  std::size_t append(const char* array, Json item) {
    if (!json[array].is_array()) json[array] = Json::array();
    json[array].push_back(std::move(item));
    return json[array].size() - 1;
  }

  // A mesh of one primitive, shown by one node of one scene.
  void add_mesh(Json primitive) {
    const std::size_t mesh = append("meshes", Json{{"primitives", Json::array({std::move(primitive)})}});
    const std::size_t node = append("nodes", Json{{"mesh", mesh}});
    if (!json.contains("scenes")) {
      json["scene"] = 0;
      json["scenes"] = Json::array({Json{{"nodes", Json::array()}}});
    }
    json["scenes"][0]["nodes"].push_back(node);
  }

  [[nodiscard]] Bytes glb() const {
    Json out = json;
    if (!bin.empty() && !out.contains("buffers")) out["buffers"] = Json::array({Json{{"byteLength", bin.size()}}});
    return glb_of(out.dump(), bin.empty() ? std::nullopt : std::optional(bin));
  }

  // The same as JSON with a data URI.
  [[nodiscard]] Bytes gltf() const {
    Json out = json;
    out["buffers"] =
        Json::array({Json{{"byteLength", bin.size()}, {"uri", "data:application/octet-stream;base64," + base64(bin)}}});
    return bytes_of(out.dump());
  }
};

inline const std::vector<float> tetrahedron_positions{1, 1, 1, -1, -1, 1, -1, 1, -1, 1, -1, -1};
inline const std::vector<std::uint16_t> tetrahedron_indices{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

// A tetrahedron with indices.
inline GltfBuilder tetrahedron() {
  GltfBuilder b;
  const auto position = b.add_accessor(tetrahedron_positions, "VEC3", 3);
  b.json["accessors"][0]["min"] = {-1, -1, -1};
  b.json["accessors"][0]["max"] = {1, 1, 1};
  const auto indices = b.add_accessor(tetrahedron_indices, "SCALAR", 1);
  b.add_mesh(Json{{"attributes", {{"POSITION", position}}}, {"indices", indices}});
  return b;
}

// A valid PNG of one white texel.
inline Bytes tiny_png() {
  constexpr std::uint8_t png[] = {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48,
                                  0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x02, 0x00, 0x00,
                                  0x00, 0x90, 0x77, 0x53, 0xde, 0x00, 0x00, 0x00, 0x0c, 0x49, 0x44, 0x41, 0x54, 0x78,
                                  0xda, 0x63, 0xf8, 0xff, 0xff, 0x3f, 0x00, 0x05, 0xfe, 0x02, 0xfe, 0x33, 0x12, 0x95,
                                  0x14, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  return bytes_of(std::span<const std::uint8_t>(png));
}

} // namespace orbis::test
