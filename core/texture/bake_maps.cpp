#include "core/texture/bake_maps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "core/texture/shade.h"

namespace orbis::texture {
namespace {

using Weights = std::array<double, 3>;

// A number in [0, 1] as the nearest multiple of 1 / most; what is no number is 0.
template <class Number> Number rounded(double value) {
  constexpr double most = std::numeric_limits<Number>::max();
  return static_cast<Number>(value > 0 ? std::min(most * value + 0.5, most) : 0.0);
}

template <class Picture> void store_numbers(const Vec3d& value, Picture& image, std::uint32_t x, std::uint32_t y) {
  auto* p = image.at(x, y);
  using Number = std::remove_reference_t<decltype(*p)>;
  p[0] = rounded<Number>(value.x);
  p[1] = rounded<Number>(value.y);
  p[2] = rounded<Number>(value.z);
}

template <class Picture> Picture empty_picture(const TexelMap& map, std::uint32_t channels) {
  Picture image{map.width(), map.height(), channels, {}};
  image.pixels.resize(std::size_t{image.width} * image.height * image.channels);
  return image;
}

template <class Vector> Vec3d vector_of(const Vector& v) { return {double{v.x}, double{v.y}, double{v.z}}; }

template <class Corners> Vec3d blend(const Corners& corners, const Weights& w) {
  return vector_of(corners[0]) * w[0] + vector_of(corners[1]) * w[1] + vector_of(corners[2]) * w[2];
}

Vec3d unit_or(const Vec3d& v, const Vec3d& otherwise) {
  const double length = norm(v);
  return length > 0 && std::isfinite(length) ? v * (1 / length) : otherwise;
}

// The frame of a renderer at a point of a triangle: n ~ x T + y B + z N with T, B and N brought to unit length. They
// are kept as interpolated, at whatever length.
struct Frame {
  Vec3d tangent, bitangent, normal;

  [[nodiscard]] Vec3d to_space(const Vec3d& v) const {
    return unit_or(tangent, {1, 0, 0}) * v.x + unit_or(bitangent, {0, 1, 0}) * v.y + unit_or(normal, {0, 0, 1}) * v.z;
  }

  // The inverse, of any vector along n, brought to unit length (Cramer: interpolated vectors are not perpendicular to
  // each other). With T = a T', B = b B', N = c N' and T', B', N' of unit length, x ~ n . (B' x N') is along
  // a n . (B x N), and so on: one division is enough. Where they lie in one plane no colour would be right; the flat
  // one stays.
  [[nodiscard]] Vec3d from_space(const Vec3d& n) const {
    const double a = norm(tangent), b = norm(bitangent), c = norm(normal);
    const Vec3d along_x = cross(bitangent, normal);
    const double determinant = dot(tangent, along_x);
    if (!(std::abs(determinant) >= 1e-6 * a * b * c)) return {0, 0, 1};
    const Vec3d v{a * dot(n, along_x), b * dot(n, cross(normal, tangent)), c * dot(n, cross(tangent, bitangent))};
    return unit_or(v * (determinant > 0 ? 1.0 : -1.0), {0, 0, 1});
  }
};

// The frames at the corners of a triangle.
class CornerFrames {
public:
  CornerFrames() = default;
  CornerFrames(const std::array<Tangent, 3>& tangents, const std::array<Vec3f, 3>& normals) {
    for (std::size_t k = 0; k < 3; ++k) {
      tangents_[k] = vector_of(tangents[k]);
      normals_[k] = vector_of(normals[k]);
      bitangents_[k] = cross(normals_[k], tangents_[k]) * double{tangents[k].w};
    }
  }
  [[nodiscard]] Frame at(const Weights& w) const {
    return {blend(tangents_, w), blend(bitangents_, w), blend(normals_, w)};
  }

private:
  std::array<Vec3d, 3> tangents_, bitangents_, normals_;
};

// Reads a field at one place after the other; what belongs to a triangle is kept until the next.
class FieldReader {
public:
  explicit FieldReader(const FrameField& field) : field_(field) {}

  Frame at(std::uint32_t texel_x, std::uint32_t texel_y, double x, double y) {
    const std::uint32_t t = field_.map->triangle(texel_x, texel_y);
    if (t != triangle_) {
      triangle_ = t;
      place_ = field_.map->place(t);
      corners_ = corners(t);
    }
    return corners_.at(place_.nearest_weights(x, y));
  }
  [[nodiscard]] CornerFrames corners(std::uint32_t t) const {
    std::array<Vec3f, 3> normals;
    std::array<Tangent, 3> tangents;
    for (std::size_t k = 0; k < 3; ++k) {
      normals[k] = field_.normals[field_.triangles[t][k]];
      tangents[k] = field_.tangents[field_.triangles[t][k]];
    }
    return {tangents, normals};
  }
  // Whether the field lies on the triangles of this map.
  [[nodiscard]] bool is_on(const TexelMap& map) const { return field_.map == &map; }

private:
  const FrameField& field_;
  std::uint32_t triangle_ = TexelMap::nothing;
  TriangleInPage place_;
  CornerFrames corners_;
};

class TextureShader {
public:
  TextureShader(const TextureReader& reader, std::span<const CornerColor> colors, Encoding encoding, Image& image)
      : reader_(reader), colors_(colors), encoding_(encoding), image_(image) {}

  void triangle(std::uint32_t t, const TriangleInPage& place) {
    footprint_ = reader_.footprint(t, place);
    color_ = colors_.empty() ? nullptr : &colors_[t];
  }

  void texel(std::uint32_t x, std::uint32_t y, const Weights& w) {
    Light light = TextureReader::read(footprint_, w);
    for (std::size_t c = 0; color_ != nullptr && c < 4; ++c) {
      light[c] *= static_cast<float>(w[0] * (*color_)[0][c] + w[1] * (*color_)[1][c] + w[2] * (*color_)[2][c]);
    }
    store(light, image_, x, y, encoding_);
  }

private:
  const TextureReader& reader_;
  std::span<const CornerColor> colors_;
  Encoding encoding_;
  Image& image_;
  TextureReader::Footprint footprint_;
  const CornerColor* color_ = nullptr;
};

template <class Picture> class NormalShader {
public:
  NormalShader(const TexelMap& map, const NormalSource& source, const FrameField* frames, Picture& image)
      : source_(source), image_(image) {
    if (frames != nullptr) frames_.emplace(*frames);
    own_frames_ = frames_ && frames_->is_on(map);
  }

  void triangle(std::uint32_t t, const TriangleInPage& place) {
    triangle_ = t;
    if (own_frames_) corners_ = frames_->corners(t);
    scale_ = source_.detail != nullptr ? source_.scales[source_.source_of[t]] : 0.0F;
    if (scale_ == 0) return;
    footprint_ = source_.detail->footprint(t, place);
    detail_frames_ = {source_.tangents[t], source_.normals[t]};
  }

  void texel(std::uint32_t x, std::uint32_t y, const Weights& w) {
    const Vec3d along = normal_at(w);
    Vec3d n;
    if (own_frames_)
      n = corners_.at(w).from_space(along);
    else if (frames_)
      n = frames_->at(x, y, x + 0.5, y + 0.5).from_space(along);
    else
      n = unit_or(along, {0, 0, 1});
    store_numbers((n + Vec3d{1, 1, 1}) * 0.5, image_, x, y);
  }

private:
  // In the space of POSITION, of any length.
  [[nodiscard]] Vec3d normal_at(const Weights& w) const {
    if (scale_ == 0) return blend(source_.normals[triangle_], w);
    const Light c = TextureReader::read(footprint_, w);
    return detail_frames_.at(w).to_space({scale_ * (2.0 * c[0] - 1), scale_ * (2.0 * c[1] - 1), 2.0 * c[2] - 1});
  }

  const NormalSource& source_;
  std::optional<FieldReader> frames_;
  bool own_frames_ = false; // those of the triangles that the map shows
  CornerFrames corners_;    // of the triangle in work, with own_frames_
  Picture& image_;
  std::uint32_t triangle_ = 0;
  float scale_ = 0;
  TextureReader::Footprint footprint_;
  CornerFrames detail_frames_;
};

class PositionShader {
public:
  PositionShader(std::span<const std::array<Vec3f, 3>> positions, const Box& box, Image16& image)
      : positions_(positions), box_(box), image_(image) {}

  void triangle(std::uint32_t t, const TriangleInPage&) { corners_ = &positions_[t]; }

  void texel(std::uint32_t x, std::uint32_t y, const Weights& w) {
    const Vec3d p = blend(*corners_, w) - box_.low, size = box_.high - box_.low;
    store_numbers({fraction(p.x, size.x), fraction(p.y, size.y), fraction(p.z, size.z)}, image_, x, y);
  }

private:
  static double fraction(double part, double whole) { return whole > 0 ? part / whole : 0; }

  std::span<const std::array<Vec3f, 3>> positions_;
  const Box& box_;
  Image16& image_;
  const std::array<Vec3f, 3>* corners_ = nullptr;
};

} // namespace

Image bake_texture(const TexelMap& map, const TextureReader& reader, std::span<const CornerColor> colors,
                   Encoding encoding, bool alpha, const Progress& progress, mesh::ThreadPool& pool) {
  auto image = empty_picture<Image>(map, alpha ? 4 : 3);
  shade(map, pool, progress, [&] { return TextureShader(reader, colors, encoding, image); });
  return image;
}

template <class Picture>
Picture bake_normals(const TexelMap& map, const NormalSource& source, const FrameField* frames,
                     const Progress& progress, mesh::ThreadPool& pool) {
  auto image = empty_picture<Picture>(map, 3);
  shade(map, pool, progress, [&] { return NormalShader<Picture>(map, source, frames, image); });
  return image;
}
template Image bake_normals<Image>(const TexelMap&, const NormalSource&, const FrameField*, const Progress&,
                                   mesh::ThreadPool&);
template Image16 bake_normals<Image16>(const TexelMap&, const NormalSource&, const FrameField*, const Progress&,
                                       mesh::ThreadPool&);

Image16 bake_positions(const TexelMap& map, std::span<const std::array<Vec3f, 3>> positions, const Box& box,
                       const Progress& progress, mesh::ThreadPool& pool) {
  auto image = empty_picture<Image16>(map, 3);
  shade(map, pool, progress, [&] { return PositionShader(positions, box, image); });
  return image;
}

} // namespace orbis::texture
