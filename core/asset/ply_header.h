// The header of a PLY file: what is in it, in which form.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/asset/text_reader.h"

namespace orbis::asset {

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };
[[nodiscard]] std::size_t size_of(PlyType type);
[[nodiscard]] bool is_floating(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;
  std::optional<PlyType> count_type; // of a list: the type of its length
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  [[nodiscard]] const PlyProperty* find(std::string_view property) const;
};

enum class PlyForm { text, little_endian, big_endian };

struct PlyHeader {
  PlyForm form = PlyForm::text;
  std::vector<PlyElement> elements;
  std::vector<std::string> textures; // MeshLab's "comment TextureFile …"
};

// Reads up to "end_header"; `text` then stands before the data. Throws Error{malformed, unsupported_feature}.
[[nodiscard]] PlyHeader read_ply_header(TextReader& text);

} // namespace orbis::asset
