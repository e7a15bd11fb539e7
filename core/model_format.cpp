#include "core/model_format.h"

#include <algorithm>
#include <array>

#include "core/utf8.h"

namespace orbis {
namespace {

constexpr std::string_view white_space = " \t\r\n";

std::string_view trimmed_front(std::string_view text) {
  const std::size_t first = text.find_first_not_of(white_space);
  return first == std::string_view::npos ? std::string_view() : text.substr(first);
}

bool is_text(std::string_view head) {
  return std::ranges::none_of(head, [](char c) { return static_cast<unsigned char>(c) < 9; });
}

bool is_obj(std::string_view head) {
  constexpr std::array<std::string_view, 15> keywords{"v",      "vt",     "vn", "vp", "f",      "l",      "p", "o",
                                                      "mtllib", "usemtl", "s",  "g",  "usemap", "cstype", "mg"};
  if (!is_text(head)) return false;
  for (std::string_view rest = trimmed_front(head); !rest.empty(); rest = trimmed_front(rest)) {
    const std::size_t end = std::min(rest.find_first_of("\r\n"), rest.size());
    if (rest.front() != '#') {
      const std::string_view word = rest.substr(0, std::min(rest.find_first_of(white_space), rest.size()));
      return word.size() < rest.size() && std::ranges::find(keywords, word) != keywords.end();
    }
    rest.remove_prefix(end);
  }
  return head.starts_with('#') || head.find("\n#") != std::string_view::npos;
}

constexpr std::uint64_t stl_header = 84, stl_triangle = 50; // bytes

// Its count, if it is a binary STL; 0 where the head is too short.
std::uint64_t binary_stl_triangles(std::string_view head) {
  if (head.size() < stl_header) return 0;
  std::uint64_t count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    count |= static_cast<std::uint64_t>(static_cast<unsigned char>(head[80 + i])) << (8 * i);
  }
  return count;
}

std::uint64_t binary_stl_size(std::uint64_t triangles) { return stl_header + triangles * stl_triangle; }

} // namespace

std::string_view name_of(ModelFormat format) {
  constexpr std::array<std::string_view, 7> names{"glb", "gltf", "draco", "obj", "ply", "stl", "zip"};
  return names.at(static_cast<std::size_t>(format));
}

bool is_binary_stl(std::string_view head, std::uint64_t size) {
  const std::uint64_t count = binary_stl_triangles(head);
  return count > 0 && size == binary_stl_size(count);
}

std::optional<ModelFormat> recognise(std::string_view head, std::uint64_t size) {
  head = head.substr(0, format_head_bytes);
  if (head.starts_with("glTF")) return ModelFormat::glb;
  if (head.starts_with("DRACO")) return ModelFormat::draco;
  if (head.starts_with("PK\x03\x04") || head.starts_with("PK\x05\x06")) return ModelFormat::zip;
  if (head.starts_with("ply\n") || head.starts_with("ply\r")) return ModelFormat::ply;
  if (is_binary_stl(head, size)) return ModelFormat::stl;
  head = without_byte_order_mark(head);
  const std::string_view text = trimmed_front(head);
  if (text.starts_with('{') || text.starts_with('[')) return ModelFormat::gltf;
  if (text.starts_with("solid") && is_text(head)) return ModelFormat::stl;
  if (is_obj(head)) return ModelFormat::obj;
  return std::nullopt;
}

std::string unrecognised(std::string_view head, std::uint64_t size) {
  std::string text = "the model is none of GLB, glTF JSON, Draco, OBJ, PLY, STL and zip; convert it to one of these";
  const std::uint64_t count = binary_stl_triangles(head), counted = binary_stl_size(count);
  const bool is_near = size < 2 * counted && counted < 2 * size;
  if (count == 0 || !is_near || is_text(head.substr(0, format_head_bytes))) return text;
  text.append(". If it is a binary STL: its header counts ").append(std::to_string(count));
  text.append(" triangles, which take ").append(std::to_string(counted));
  return text.append(" bytes, but there are ").append(std::to_string(size));
}

} // namespace orbis
