#include "core/asset/read_obj.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "core/asset/corner_list.h"
#include "core/asset/extent.h"
#include "core/asset/obj_materials.h"
#include "core/asset/polygon.h"
#include "core/asset/text_reader.h"
#include "core/asset/vertex_color.h"

namespace orbis::asset {
namespace {

constexpr std::uint32_t none = 0xffffffff;

// What a corner of a face names: places in the lists of positions, texture coordinates and normals.
struct Corner {
  std::uint32_t position = none, texcoord = none, normal = none;
  friend bool operator==(const Corner&, const Corner&) = default;
};

struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    std::uint64_t hash = c.position;
    hash = hash * 0x9E3779B97F4A7C15ull ^ c.texcoord;
    hash = hash * 0x9E3779B97F4A7C15ull ^ c.normal;
    return static_cast<std::size_t>(hash ^ hash >> 29);
  }
};

// The lists that faces refer to.
struct Lists {
  std::vector<Vec3d> positions;
  std::vector<Vec3f> normals;
  std::vector<Vec2f> texcoords;
  std::vector<std::optional<Vec3f>> colors; // of the positions, up to the last one that has a colour

  [[nodiscard]] std::optional<Vec3f> color_of(std::uint32_t position) const {
    return position < colors.size() ? colors[position] : std::nullopt;
  }
};

// A primitive in the making: one material, and corners that all have, or all lack, texture coordinates and normals.
using Part = CornerList<Corner, CornerHash>;

struct PartKey {
  std::string material;
  bool has_texcoords = false, has_normals = false;
  friend auto operator<=>(const PartKey&, const PartKey&) = default;
};

// A primitive that waits for the end of the file: positions are measured from a point that all of them decide.
struct FinishedPart {
  PartKey key;
  std::vector<Corner> vertices;
  std::vector<std::uint32_t> indices;
};

struct Object {
  std::string name;
  std::vector<FinishedPart> parts;
};

Attribute floats(std::string name, std::uint32_t components, std::size_t count) {
  Attribute out{std::move(name), ComponentType::f32, false, components, {}};
  out.data.resize(count * components * sizeof(float));
  return out;
}

void set(Attribute& attribute, std::size_t v, const Vec3d& value) {
  attribute.set(v, 0, value.x);
  attribute.set(v, 1, value.y);
  attribute.set(v, 2, value.z);
}

class ObjReader {
public:
  ObjReader(std::span<const std::byte> bytes, const Limits& limits, const ModelFiles& files)
      : text_(bytes, "the OBJ file"), limits_(limits), materials_(model_, files, notes_) {}

  Converted run() {
    while (text_.next_line()) read_line();
    finish_object();
    origin_ = extent_.origin();
    note_origin(origin_, notes_);
    for (const Object& object : objects_) write(object);
    if (left_out_ > 0) {
      notes_.push_back({"elements-left-out",
                        std::to_string(left_out_) + " points, lines, curves or surfaces of the OBJ file were left out: "
                                                    "only its faces are read",
                        ""});
    }
    return {model_.glb(), std::move(notes_)};
  }

private:
  void read_line() {
    const std::string_view word = text_.word();
    if (word == "v") {
      read_position();
    } else if (word == "vt") {
      const float u = next_float();
      lists_.texcoords.push_back({u, text_.at_end_of_line() ? 1.0f : 1 - next_float()});
    } else if (word == "vn") {
      lists_.normals.push_back(next_vector());
    } else if (word == "f") {
      read_face();
    } else if (word == "o") {
      finish_object();
      object_ = text_.rest_of_line();
    } else if (word == "usemtl") {
      material_ = text_.rest_of_line();
    } else if (word == "mtllib") {
      materials_.read_libraries(text_.rest_of_line());
    } else if (word == "l" || word == "p" || word == "curv" || word == "surf") {
      ++left_out_;
    }
  }

  float next_float() { return text_.number<float>(text_.word()); }
  Vec3f next_vector() {
    const float x = next_float(), y = next_float();
    return {x, y, next_float()};
  }
  // A double that becomes the float32 nearest to what the text says. The double nearest to it can lie midway between
  // two floats, and then might become the other one.
  double next_coordinate() {
    const std::string_view word = text_.word();
    const auto single = text_.number<float>(word);
    const auto value = text_.number<double>(word);
    return static_cast<float>(value) == single ? value : std::nextafter(value, double{single});
  }
  Vec3d next_position() {
    const double x = next_coordinate(), y = next_coordinate();
    return {x, y, next_coordinate()};
  }

  // x y z, perhaps a weight, perhaps a colour: three, four, six or seven numbers.
  void read_position() {
    if (lists_.positions.size() >= limits_.max_vertices) too_many(limits_.max_vertices, "vertices");
    lists_.positions.push_back(next_position());
    extent_.add(lists_.positions.back());
    std::array<float, 4> more{};
    std::size_t count = 0;
    while (count < more.size() && !text_.at_end_of_line()) more[count++] = next_float();
    if (count < 3) return;
    lists_.colors.resize(lists_.positions.size());
    lists_.colors.back() = Vec3f(more[count - 3], more[count - 2], more[count - 1]);
  }

  void read_face() {
    corners_.clear();
    for (std::string_view word = text_.word(); !word.empty(); word = text_.word()) {
      if (word == "\\" && text_.next_line()) continue; // the face goes on in the next line
      if (word.front() == '#') break;
      if (corners_.size() == max_corners) too_many(max_corners, "corners in a face");
      corners_.push_back(read_corner(word));
    }
    if (corners_.size() < 3) text_.fail("the face has fewer than three corners");
    Part& part = part_of_face();
    for (const std::uint32_t corner : triangulate_polygon(points_of_face())) part.add(corners_[corner]);
    triangles_ += corners_.size() - 2;
    if (triangles_ > limits_.max_triangles) too_many(limits_.max_triangles, "triangles");
  }

  std::span<const Vec3f> points_of_face() {
    const Vec3d origin = extent_.origin(); // of what has been read: all that the face can name
    points_.clear();
    points_.reserve(corners_.size());
    for (const Corner& corner : corners_) points_.emplace_back(lists_.positions[corner.position] - origin);
    return points_;
  }

  // "7", "7/8", "7//9" or "7/8/9".
  Corner read_corner(std::string_view word) {
    std::array<std::string_view, 3> parts{};
    std::size_t n = 0;
    for (std::string_view rest = word; n < 3; ++n) {
      const std::size_t slash = rest.find('/');
      parts[n] = rest.substr(0, slash);
      if (slash == std::string_view::npos) break;
      rest.remove_prefix(slash + 1);
      if (n == 2) text_.fail(TextReader::quoted(word) + " is no corner of a face");
    }
    return {place(parts[0], lists_.positions.size(), "position"),
            parts[1].empty() ? none : place(parts[1], lists_.texcoords.size(), "texture coordinate"),
            parts[2].empty() ? none : place(parts[2], lists_.normals.size(), "normal")};
  }

  // Numbers count from 1, or backward from -1.
  std::uint32_t place(std::string_view word, std::size_t size, const char* what) {
    const auto number = text_.number<std::int64_t>(word);
    const std::int64_t index = number > 0 ? number - 1 : static_cast<std::int64_t>(size) + number;
    if (number == 0 || index < 0 || index >= static_cast<std::int64_t>(size)) {
      text_.fail("the face names " + std::string(what) + " " + std::to_string(number) + ", but there are " +
                 std::to_string(size) + " before it");
    }
    return static_cast<std::uint32_t>(index);
  }

  Part& part_of_face() {
    PartKey key{material_, true, true};
    for (const Corner& corner : corners_) {
      key.has_texcoords = key.has_texcoords && corner.texcoord != none;
      key.has_normals = key.has_normals && corner.normal != none;
    }
    for (Corner& corner : corners_) {
      if (!key.has_texcoords) corner.texcoord = none;
      if (!key.has_normals) corner.normal = none;
    }
    const auto [place, is_new] = parts_.try_emplace(key);
    if (is_new) order_.push_back(place);
    return place->second;
  }

  void finish_object() {
    if (order_.empty()) return;
    Object& object = objects_.emplace_back(Object{object_, {}});
    object.parts.reserve(order_.size());
    for (const auto& part : order_) {
      object.parts.push_back({part->first, std::move(part->second.vertices), std::move(part->second.indices)});
    }
    order_.clear();
    parts_.clear();
  }

  void write(const Object& object) {
    const std::size_t mesh = model_.add_mesh(object.name, origin_);
    for (const FinishedPart& part : object.parts) {
      const std::vector<Attribute> attributes = attributes_of(part);
      const auto material = part.key.material.empty() ? std::nullopt : materials_.find(part.key.material);
      model_.add_primitive(mesh, part.indices, attributes, material);
    }
  }

  std::vector<Attribute> attributes_of(const FinishedPart& part) {
    const std::size_t count = part.vertices.size();
    std::vector<Attribute> out{floats("POSITION", 3, count)};
    for (std::size_t v = 0; v < count; ++v) set(out[0], v, lists_.positions[part.vertices[v].position] - origin_);
    if (part.key.has_normals) add_normals(part, out);
    if (part.key.has_texcoords) {
      Attribute uv = floats("TEXCOORD_0", 2, count);
      for (std::size_t v = 0; v < count; ++v) {
        const Vec2f& value = lists_.texcoords[part.vertices[v].texcoord];
        uv.set(v, 0, double{value.x});
        uv.set(v, 1, double{value.y});
      }
      out.push_back(std::move(uv));
    }
    add_colors(part, out);
    return out;
  }

  // A part without any colour goes without; in one with some, white changes nothing of the others.
  void add_colors(const FinishedPart& part, std::vector<Attribute>& out) {
    const bool has_color = std::ranges::any_of(
        part.vertices, [&](const Corner& corner) { return lists_.color_of(corner.position).has_value(); });
    if (!has_color) return;
    Attribute colors = linear_colors(part.vertices.size(), 3);
    for (std::size_t v = 0; v < part.vertices.size(); ++v) {
      const Vec3f c = lists_.color_of(part.vertices[v].position).value_or(Vec3f(1, 1, 1));
      colors.set(v, 0, linear_from_srgb(double{c.x}));
      colors.set(v, 1, linear_from_srgb(double{c.y}));
      colors.set(v, 2, linear_from_srgb(double{c.z}));
    }
    out.push_back(std::move(colors));
  }

  void add_normals(const FinishedPart& part, std::vector<Attribute>& out) {
    Attribute normals = floats("NORMAL", 3, part.vertices.size());
    for (std::size_t v = 0; v < part.vertices.size(); ++v)
      set(normals, v, Vec3d(lists_.normals[part.vertices[v].normal]));
    if (make_unit(normals)) {
      out.push_back(std::move(normals));
    } else {
      notes_.push_back(
          {"normals-left-out", "a normal has no direction, so that those of its material's faces were left out", ""});
    }
  }

  [[noreturn]] void too_many(std::uint64_t limit, const std::string& what) const {
    text_.fail("there are more than the limit of " + std::to_string(limit) + " " + what, ErrorCode::too_large);
  }

  TextReader text_;
  const Limits& limits_;
  ModelBuilder model_;
  std::vector<Asset::Note> notes_;
  ObjMaterials materials_;
  Lists lists_;
  Extent extent_;
  Vec3d origin_;
  std::vector<Object> objects_;
  std::string object_, material_;
  std::map<PartKey, Part> parts_;                        // of the object at hand
  std::vector<std::map<PartKey, Part>::iterator> order_; // as they came
  std::vector<Corner> corners_;                          // of the face at hand
  std::vector<Vec3f> points_;
  std::uint64_t triangles_ = 0, left_out_ = 0;
};

} // namespace

Converted read_obj(std::span<const std::byte> bytes, const Limits& limits, const ModelFiles& files) {
  return ObjReader(bytes, limits, files).run();
}

} // namespace orbis::asset
