#include "core/asset/read_ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "core/asset/ply_header.h"
#include "core/asset/polygon.h"
#include "core/asset/vertex_color.h"

namespace orbis::asset {
namespace {

// The values behind the header, one after the other, in any of the three forms.
class Values {
public:
  Values(TextReader text, PlyForm form) : text_(text), bytes_(text.rest()), form_(form) {}

  double next(PlyType type) {
    if (form_ == PlyForm::text) return text_.number<double>(text_.word_over_lines());
    const std::size_t size = size_of(type);
    if (bytes_.size() < size) text_.fail("the data ends too early; the file is truncated");
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const auto byte = static_cast<unsigned char>(bytes_[form_ == PlyForm::big_endian ? i : size - 1 - i]);
      bits = bits << 8 | byte;
    }
    bytes_.remove_prefix(size);
    return decoded(bits, type);
  }

  // A whole number that is not negative, below `end`.
  std::uint64_t next_index(PlyType type, std::uint64_t end, const char* what) {
    const double value = next(type);
    if (!(value >= 0) || value >= static_cast<double>(end) || value != std::floor(value)) {
      text_.fail(std::string(what) + " is out of range; there are " + std::to_string(end));
    }
    return static_cast<std::uint64_t>(value);
  }

  // Refuses counts that the rest of the file cannot hold, before anything is made from them.
  void check_count(const PlyElement& element) const {
    std::uint64_t row = 0;
    for (const PlyProperty& property : element.properties) {
      row += form_ == PlyForm::text ? 2 : size_of(property.count_type.value_or(property.type));
    }
    if (row > 0 && element.count > (bytes_.size() + 1) / row) {
      text_.fail("the header promises " + std::to_string(element.count) + " rows of " +
                 TextReader::quoted(element.name) + ", but the file is too short for them; it is truncated");
    }
  }

  void skip(const PlyProperty& property) {
    const std::uint64_t count =
        property.count_type ? next_index(*property.count_type, std::uint64_t{1} << 32, "the length of a list") : 1;
    for (std::uint64_t i = 0; i < count; ++i) (void)next(property.type);
  }

  [[noreturn]] void fail(const std::string& message, ErrorCode code) const { text_.fail(message, code); }

private:
  static double decoded(std::uint64_t bits, PlyType type) {
    switch (type) {
    case PlyType::i8:
      return static_cast<std::int8_t>(bits);
    case PlyType::i16:
      return static_cast<std::int16_t>(bits);
    case PlyType::i32:
      return static_cast<std::int32_t>(bits);
    case PlyType::f32:
      return double{std::bit_cast<float>(static_cast<std::uint32_t>(bits))};
    case PlyType::f64:
      return std::bit_cast<double>(bits);
    default:
      return static_cast<double>(bits);
    }
  }

  TextReader text_;
  std::string_view bytes_;
  PlyForm form_;
};

// Where a vertex property goes: component of an attribute, and how its value changes on the way.
struct Place {
  enum class Change { none, downward, to_linear, to_unit };
  std::size_t attribute = 0;
  std::uint32_t component = 0;
  Change change = Change::none;
};

double changed(double value, PlyType type, Place::Change change) {
  const double largest = type == PlyType::u16 ? 65535 : 255;
  switch (change) {
  case Place::Change::none:
    return value;
  case Place::Change::downward:
    return 1 - value;
  case Place::Change::to_linear:
    return linear_from_srgb(value / largest);
  case Place::Change::to_unit:
    return value / largest;
  }
  return value;
}

// Gives the properties of the element "vertex" their places among glTF's attributes.
class VertexPlan {
public:
  VertexPlan(const PlyElement& element, std::vector<Asset::Note>& notes)
      : element_(element), places_(element.properties.size()) {
    add("POSITION", {"x", "y", "z"});
    if (attributes_.empty()) {
      throw Error(ErrorCode::invalid_geometry, "the PLY file has no vertices with the properties x, y and z");
    }
    add("NORMAL", {"nx", "ny", "nz"});
    add_texcoords();
    add_colors();
    for (std::size_t i = 0; i < places_.size(); ++i) {
      if (places_[i]) continue;
      notes.push_back({"property-not-carried-over",
                       "the vertex property " + TextReader::quoted(element.properties[i].name) + " is not carried over",
                       ""});
    }
  }

  std::vector<Attribute> read(Values& values) {
    for (Attribute& a : attributes_) a.data.resize(element_.count * a.components * size_of(a.type));
    for (std::size_t v = 0; v < element_.count; ++v) {
      for (std::size_t i = 0; i < places_.size(); ++i) read_value(values, v, i);
    }
    return std::move(attributes_);
  }

private:
  void read_value(Values& values, std::size_t v, std::size_t i) {
    const PlyProperty& property = element_.properties[i];
    if (!places_[i]) return values.skip(property);
    const double value = values.next(property.type);
    attributes_[places_[i]->attribute].set(v, places_[i]->component, changed(value, property.type, places_[i]->change));
  }

  // An attribute whose components are all there as plain numbers.
  bool add(const char* name, std::initializer_list<std::string_view> properties) {
    const bool is_there = std::ranges::all_of(properties, [&](std::string_view property) {
      const PlyProperty* found = element_.find(property);
      return found && !found->count_type;
    });
    if (!is_there) return false;
    const auto components = static_cast<std::uint32_t>(properties.size());
    std::uint32_t c = 0;
    for (const std::string_view property : properties) place_of(property) = Place{attributes_.size(), c++};
    attributes_.push_back({name, ComponentType::f32, false, components, {}});
    return true;
  }

  void add_texcoords() {
    constexpr std::array<std::array<std::string_view, 2>, 3> names{
        {{"s", "t"}, {"u", "v"}, {"texture_u", "texture_v"}}};
    for (const auto& [u, v] : names) {
      if (!add("TEXCOORD_0", {u, v})) continue;
      place_of(v)->change = Place::Change::downward;
      return;
    }
  }

  void add_colors() {
    const bool has_alpha = add("COLOR_0", {"red", "green", "blue", "alpha"});
    if (!has_alpha && !add("COLOR_0", {"red", "green", "blue"})) return;
    if (is_floating(element_.find("red")->type)) return;
    attributes_.back() = linear_colors(0, has_alpha ? 4 : 3);
    for (const auto* name : {"red", "green", "blue"}) place_of(name)->change = Place::Change::to_linear;
    if (has_alpha) place_of("alpha")->change = Place::Change::to_unit;
  }

  std::optional<Place>& place_of(std::string_view property) {
    return places_[static_cast<std::size_t>(element_.find(property) - element_.properties.data())];
  }

  const PlyElement& element_;
  std::vector<std::optional<Place>> places_; // by property
  std::vector<Attribute> attributes_;
};

// The element "face" as triangles.
class FaceReader {
public:
  FaceReader(const Attribute& positions, const Limits& limits) : positions_(positions), limits_(limits) {}

  std::vector<std::uint32_t> read(const PlyElement& element, Values& values) {
    for (std::uint64_t f = 0; f < element.count; ++f) {
      for (const PlyProperty& property : element.properties) {
        if (property.count_type && (property.name == "vertex_indices" || property.name == "vertex_index")) {
          read_polygon(property, values);
        } else {
          values.skip(property);
        }
      }
    }
    return std::move(indices_);
  }

private:
  void read_polygon(const PlyProperty& property, Values& values) {
    const std::uint64_t count =
        values.next_index(*property.count_type, max_corners + 1, "the number of a face's corners");
    polygon_.clear();
    corners_.clear();
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::uint64_t v = values.next_index(property.type, positions_.count(), "the vertex of a face");
      polygon_.push_back(static_cast<std::uint32_t>(v));
      corners_.emplace_back(static_cast<float>(positions_.get(v, 0)), static_cast<float>(positions_.get(v, 1)),
                            static_cast<float>(positions_.get(v, 2)));
    }
    if (count < 3) return; // a point or a line
    for (const std::uint32_t corner : triangulate_polygon(corners_)) indices_.push_back(polygon_[corner]);
    if (indices_.size() > 3 * limits_.max_triangles) {
      values.fail("there are more than the limit of " + std::to_string(limits_.max_triangles) + " triangles",
                  ErrorCode::too_large);
    }
  }

  const Attribute& positions_;
  const Limits& limits_;
  std::vector<std::uint32_t> indices_, polygon_;
  std::vector<Vec3f> corners_;
};

struct Contents {
  std::vector<Attribute> attributes;
  std::vector<std::uint32_t> indices;
};

Contents read_elements(const PlyHeader& header, Values& values, const Limits& limits, std::vector<Asset::Note>& notes) {
  Contents out;
  for (const PlyElement& element : header.elements) {
    values.check_count(element);
    if (element.name == "vertex") {
      if (element.count > limits.max_vertices) {
        values.fail("there are more than the limit of " + std::to_string(limits.max_vertices) + " vertices",
                    ErrorCode::too_large);
      }
      out.attributes = VertexPlan(element, notes).read(values);
    } else if (element.name == "face") {
      if (out.attributes.empty()) values.fail("the faces come before the vertices", ErrorCode::unsupported_feature);
      out.indices = FaceReader(out.attributes.front(), limits).read(element, values);
    } else {
      for (std::uint64_t row = 0; row < element.count && !element.properties.empty(); ++row) {
        for (const PlyProperty& property : element.properties) values.skip(property);
      }
    }
  }
  return out;
}

} // namespace

Converted read_ply(std::span<const std::byte> bytes, const Limits& limits, const ModelFiles& files) {
  TextReader text(bytes, "the PLY file");
  const PlyHeader header = read_ply_header(text);
  Values values(text, header.form);
  Converted out;
  Contents contents = read_elements(header, values, limits, out.notes);
  if (contents.indices.empty()) {
    throw Error(ErrorCode::invalid_geometry,
                "the PLY file has no faces: points alone are no surface; reconstruct one first");
  }
  std::erase_if(contents.attributes, [&](Attribute& a) {
    if (a.name != "NORMAL" || make_unit(a)) return false;
    out.notes.push_back({"normals-left-out", "a normal has no direction, so that all were left out", ""});
    return true;
  });
  ModelBuilder model;
  std::optional<std::size_t> material;
  const bool has_texcoords =
      std::ranges::any_of(contents.attributes, [](const auto& a) { return a.name == "TEXCOORD_0"; });
  if (!header.texture.empty() && has_texcoords) {
    if (const auto texture = add_texture_file(model, files, header.texture, out.notes)) {
      material = model.add_material(
          {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", *texture}}}, {"metallicFactor", 0}}}});
    }
  }
  model.add_primitive(model.add_mesh(""), contents.indices, contents.attributes, material);
  out.glb = model.glb();
  return out;
}

} // namespace orbis::asset
