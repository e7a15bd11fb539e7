#include "core/asset/ply_header.h"

#include <algorithm>
#include <array>

namespace orbis::asset {
namespace {

// Old and new names of the types, in the order of PlyType.
constexpr std::array<std::array<std::string_view, 2>, 8> type_names{{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};
constexpr std::size_t max_properties = 256;

PlyType read_type(TextReader& text) {
  const std::string_view word = text.word();
  for (std::size_t i = 0; i < type_names.size(); ++i) {
    if (std::ranges::find(type_names[i], word) != type_names[i].end()) return static_cast<PlyType>(i);
  }
  text.fail(TextReader::quoted(word) + " is no type of a PLY property");
}

PlyForm read_form(TextReader& text) {
  const std::string_view word = text.word();
  if (word == "ascii") return PlyForm::text;
  if (word == "binary_little_endian") return PlyForm::little_endian;
  if (word == "binary_big_endian") return PlyForm::big_endian;
  text.fail(TextReader::quoted(word) + " is no form of PLY", ErrorCode::unsupported_feature);
}

PlyProperty read_property(TextReader& text) {
  PlyProperty out;
  const TextReader before = text;
  if (text.word() == "list") {
    out.count_type = read_type(text);
    if (is_floating(*out.count_type)) text.fail("the length of a list cannot be a fraction");
  } else {
    text = before;
  }
  out.type = read_type(text);
  out.name = text.word();
  if (out.name.empty()) text.fail("the property has no name");
  return out;
}

} // namespace

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes.at(static_cast<std::size_t>(type));
}

bool is_floating(PlyType type) { return type == PlyType::f32 || type == PlyType::f64; }

const PlyProperty* PlyElement::find(std::string_view property) const {
  const auto found = std::ranges::find(properties, property, &PlyProperty::name);
  return found == properties.end() ? nullptr : &*found;
}

PlyHeader read_ply_header(TextReader& text) {
  PlyHeader header;
  while (text.next_line()) {
    const std::string_view word = text.word();
    if (word == "end_header") return header;
    if (word == "format") {
      header.form = read_form(text);
    } else if (word == "element") {
      PlyElement element{std::string(text.word()), 0, {}};
      element.count = text.number<std::uint64_t>(text.word());
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      if (header.elements.empty()) text.fail("the property belongs to no element");
      std::vector<PlyProperty>& properties = header.elements.back().properties;
      if (properties.size() == max_properties || header.elements.size() > max_properties) {
        text.fail("there are too many properties", ErrorCode::too_large);
      }
      properties.push_back(read_property(text));
    } else if (word == "comment" && text.word() == "TextureFile") {
      header.textures.emplace_back(text.rest_of_line());
    }
  }
  text.fail("the header has no end");
}

} // namespace orbis::asset
