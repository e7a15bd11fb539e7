#include "core/asset/ply_faces.h"

#include <algorithm>
#include <cmath>

#include "core/asset/polygon.h"
#include "core/asset/vertex_color.h"

namespace orbis::asset {
namespace {

enum class Use { none, vertices, texcoords, texture, red, green, blue, alpha };

std::uint16_t stored(double unit) {
  return static_cast<std::uint16_t>(std::lround(std::clamp(unit, 0.0, 1.0) * 65535));
}

class FaceReader {
public:
  FaceReader(const PlyElement& element, const PlyVertices& vertices, std::size_t textures, const Limits& limits)
      : element_(element), positions_(vertices.attributes.front()), textures_(textures), limits_(limits),
        uses_(element.properties.size(), Use::none) {
    plan(vertices);
  }

  void note_lost(std::vector<Asset::Note>& notes) const {
    for (std::size_t i = 0; i < uses_.size(); ++i) {
      if (uses_[i] == Use::none) note_lost_property(element_, element_.properties[i], notes);
    }
  }

  PlyFaces read(PlyValues& values) {
    for (std::uint64_t f = 0; f < element_.count; ++f) {
      for (std::size_t i = 0; i < uses_.size(); ++i) read_property(element_.properties[i], uses_[i], values);
      add_face(values);
    }
    return std::move(out_);
  }

private:
  void plan(const PlyVertices& vertices) {
    use("vertex_indices", true, Use::vertices);
    use("vertex_index", true, Use::vertices);
    has_texcoords_ = !vertices.has("TEXCOORD_0") && use("texcoord", true, Use::texcoords);
    if (has_texcoords_ || vertices.has("TEXCOORD_0")) has_textures_ = use("texnumber", false, Use::texture);
    const bool has_color = std::ranges::all_of(std::array{"red", "green", "blue"}, [&](const char* name) {
      const PlyProperty* found = element_.find(name);
      return found != nullptr && !found->count_type;
    });
    if (!has_color || vertices.has("COLOR_0")) return;
    has_colors_ = use("red", false, Use::red) && use("green", false, Use::green) && use("blue", false, Use::blue);
    if (use("alpha", false, Use::alpha)) out_.color_components = 4;
  }

  bool use(std::string_view name, bool is_list, Use what) {
    const PlyProperty* found = element_.find(name);
    if (!found || found->count_type.has_value() != is_list) return false;
    uses_[static_cast<std::size_t>(found - element_.properties.data())] = what;
    return true;
  }

  void read_property(const PlyProperty& property, Use use, PlyValues& values) {
    switch (use) {
    case Use::none:
      return values.skip(property);
    case Use::vertices:
      return read_polygon(property, values);
    case Use::texcoords:
      return read_texcoords(property, values);
    case Use::texture: {
      const double number = values.next(property.type);
      const auto end = static_cast<double>(std::max<std::size_t>(textures_, 1));
      texture_ = number >= 0 && number < end ? static_cast<std::uint32_t>(number) : PlyFaces::no_texture;
      return;
    }
    case Use::red:
    case Use::green:
    case Use::blue:
      color_[static_cast<std::size_t>(use) - static_cast<std::size_t>(Use::red)] = stored(linear(property, values));
      return;
    case Use::alpha: {
      const double alpha = values.next(property.type);
      color_[3] = stored(is_floating(property.type) ? alpha : unit_color(alpha, property.type));
    }
    }
  }

  // As for vertices: integers are sRGB, fractions linear.
  static double linear(const PlyProperty& property, PlyValues& values) {
    const double value = values.next(property.type);
    return is_floating(property.type) ? value : linear_from_srgb(unit_color(value, property.type));
  }

  void read_polygon(const PlyProperty& property, PlyValues& values) {
    const std::uint64_t count =
        values.next_index(*property.count_type, max_corners + 1, "the number of a face's corners");
    polygon_.clear();
    corners_.clear();
    for (std::uint64_t i = 0; i < count; ++i) {
      const auto v =
          static_cast<std::uint32_t>(values.next_index(property.type, positions_.count(), "the vertex of a face"));
      polygon_.push_back(v);
      corners_.emplace_back(vector_at(positions_, v));
    }
  }

  void read_texcoords(const PlyProperty& property, PlyValues& values) {
    const std::uint64_t count =
        values.next_index(*property.count_type, 2 * max_corners + 1, "the number of a face's texture coordinates");
    texcoords_.clear();
    for (std::uint64_t i = 0; i < count; ++i) texcoords_.push_back(static_cast<float>(values.next(property.type)));
  }

  void add_face(const PlyValues& values) {
    if (polygon_.size() < 3) return; // a point or a line
    const bool is_textured = !has_texcoords_ || texcoords_.size() == 2 * polygon_.size();
    for (const std::uint32_t corner : triangulate_polygon(corners_)) {
      out_.indices.push_back(polygon_[corner]);
      if (!has_texcoords_) continue;
      out_.texcoords.push_back(is_textured ? Vec2f{texcoords_[2 * corner], 1 - texcoords_[2 * corner + 1]} : Vec2f{});
    }
    const std::size_t triangles = out_.indices.size() / 3;
    if (triangles > limits_.max_triangles) {
      values.fail("there are more than the limit of " + std::to_string(limits_.max_triangles) + " triangles",
                  ErrorCode::too_large);
    }
    if (has_colors_) out_.colors.resize(triangles, color_);
    if (has_texcoords_ || has_textures_) out_.textures.resize(triangles, is_textured ? texture_ : PlyFaces::no_texture);
  }

  const PlyElement& element_;
  const Attribute& positions_;
  std::size_t textures_;
  const Limits& limits_;
  std::vector<Use> uses_; // by property
  bool has_texcoords_ = false, has_textures_ = false, has_colors_ = false;
  PlyFaces out_;
  // Of the face at hand.
  std::vector<std::uint32_t> polygon_;
  std::vector<Vec3f> corners_;
  std::vector<float> texcoords_;
  std::uint32_t texture_ = 0;
  PlyFaces::Color color_{65535, 65535, 65535, 65535};
};

} // namespace

PlyFaces read_ply_faces(const PlyElement& element, PlyValues& values, const PlyVertices& vertices, std::size_t textures,
                        const Limits& limits, std::vector<Asset::Note>& notes) {
  FaceReader reader(element, vertices, textures, limits);
  reader.note_lost(notes);
  return reader.read(values);
}

} // namespace orbis::asset
