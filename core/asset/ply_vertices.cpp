#include "core/asset/ply_vertices.h"

#include <algorithm>
#include <array>

#include "core/asset/extent.h"
#include "core/asset/vertex_color.h"

namespace orbis::asset {
namespace {

// Where a vertex property goes: component of an attribute, and how its value changes on the way.
struct Place {
  enum class Change { none, downward, to_linear, to_unit };
  std::size_t attribute = 0;
  std::uint32_t component = 0;
  Change change = Change::none;
};

double changed(double value, PlyType type, Place::Change change) {
  switch (change) {
  case Place::Change::none:
    return value;
  case Place::Change::downward:
    return 1 - value;
  case Place::Change::to_linear:
    return linear_from_srgb(unit_color(value, type));
  case Place::Change::to_unit:
    return unit_color(value, type);
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
      if (!places_[i]) note_lost_property(element, element.properties[i], notes);
    }
  }

  PlyVertices read(PlyValues& values) {
    for (Attribute& a : attributes_) a.data.resize(element_.count * a.components * size_of(a.type));
    if (!holds_float_positions(values)) exact_.resize(element_.count);
    for (std::size_t v = 0; v < element_.count; ++v) {
      for (std::size_t i = 0; i < places_.size(); ++i) read_value(values, v, i);
    }
    PlyVertices out;
    out.origin = move_to_origin();
    out.attributes = std::move(attributes_);
    return out;
  }

private:
  [[nodiscard]] bool holds_float_positions(const PlyValues& values) const {
    return std::ranges::all_of(std::array{"x", "y", "z"},
                               [&](const char* name) { return values.holds_floats(*element_.find(name)); });
  }

  void read_value(PlyValues& values, std::size_t v, std::size_t i) {
    const PlyProperty& property = element_.properties[i];
    if (!places_[i]) return values.skip(property);
    const auto& [attribute, component, change] = *places_[i];
    const double value = values.next(property.type);
    attributes_[attribute].set(v, component, changed(value, property.type, change));
    if (attribute == position && !exact_.empty()) exact_[v][component] = value;
  }

  // Writes the positions anew where they are better measured from another point, which is returned.
  Vec3d move_to_origin() {
    Extent extent;
    for (const auto& [x, y, z] : exact_) extent.add({x, y, z});
    const Vec3d origin = extent.origin();
    if (origin == Vec3d()) return origin;
    for (std::size_t v = 0; v < exact_.size(); ++v) {
      attributes_[position].set(v, 0, exact_[v][0] - origin.x);
      attributes_[position].set(v, 1, exact_[v][1] - origin.y);
      attributes_[position].set(v, 2, exact_[v][2] - origin.z);
    }
    return origin;
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

  static constexpr std::size_t position = 0; // among the attributes
  const PlyElement& element_;
  std::vector<std::optional<Place>> places_; // by property
  std::vector<Attribute> attributes_;
  std::vector<std::array<double, 3>> exact_; // the positions; none where the file itself has no more than floats
};

} // namespace

bool PlyVertices::has(std::string_view attribute) const {
  return std::ranges::find(attributes, attribute, &Attribute::name) != attributes.end();
}

PlyVertices read_ply_vertices(const PlyElement& element, PlyValues& values, std::vector<Asset::Note>& notes) {
  PlyVertices out = VertexPlan(element, notes).read(values);
  note_origin(out.origin, notes);
  return out;
}

void note_lost_property(const PlyElement& element, const PlyProperty& property, std::vector<Asset::Note>& notes) {
  notes.push_back({"property-not-carried-over",
                   "the " + element.name + " property " + TextReader::quoted(property.name) + " is not carried over",
                   ""});
}

double unit_color(double value, PlyType type) { return value / (type == PlyType::u16 ? 65535 : 255); }

} // namespace orbis::asset
