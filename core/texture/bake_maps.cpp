#include "core/texture/bake_maps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>

#include "core/float4.h"
#include "core/texture/shade.h"

namespace orbis::texture {
namespace {

using Weights = std::array<double, 3>;

// A number in [0, 1] as the nearest multiple of 1 / most; what is no number is 0.
template <class Number, class Real> Number rounded(Real value) {
  constexpr Real most = std::numeric_limits<Number>::max();
  return static_cast<Number>(value > 0 ? std::min(most * value + Real(0.5), most) : Real(0));
}

// value: three numbers, by index.
template <class Value, class Picture>
void store_numbers(const Value& value, Picture& image, std::uint32_t x, std::uint32_t y) {
  auto* p = image.at(x, y);
  using Number = std::remove_reference_t<decltype(*p)>;
  for (int c = 0; c < 3; ++c) p[c] = rounded<Number>(value[c]);
}

template <class Picture> Picture empty_picture(const TexelMap& map, std::uint32_t channels) {
  Picture image{map.width(), map.height(), channels, {}};
  image.pixels.resize(std::size_t{image.width} * image.height * image.channels);
  return image;
}

Vec3d blend(const std::array<Vec3f, 3>& corners, const Weights& w) {
  return Vec3d(corners[0]) * w[0] + Vec3d(corners[1]) * w[1] + Vec3d(corners[2]) * w[2];
}

// What the corners of a triangle have.
using Corners = std::array<Float4, 3>;

Float4 blend(const Corners& corners, const Weights& w) {
  return corners[0] * static_cast<float>(w[0]) + corners[1] * static_cast<float>(w[1]) +
         corners[2] * static_cast<float>(w[2]);
}

// Only the direction of a normal counts; the largest coordinate of a triangle's becomes 1, so that products of several
// fit floats.
Corners scaled(const std::array<Vec3f, 3>& normals) {
  float largest = 0;
  for (const Vec3f& n : normals) largest = std::max({largest, std::abs(n.x), std::abs(n.y), std::abs(n.z)});
  const double scale = largest > 0 ? 1 / double{largest} : 0;
  return {float4(Vec3d(normals[0]) * scale), float4(Vec3d(normals[1]) * scale), float4(Vec3d(normals[2]) * scale)};
}

Float4 unit_or(const Float4& v, const Float4& otherwise) {
  const float length = norm3(v);
  return length > 0 && std::isfinite(length) ? v * (1 / length) : otherwise;
}

// The frame of a renderer at a point of a triangle: n ~ x T + y B + z N with T, B and N brought to unit length. They
// are kept as interpolated, at whatever length.
struct Frame {
  Float4 tangent, bitangent, normal;

  [[nodiscard]] Float4 to_space(const Float4& v) const {
    return unit_or(tangent, Float4{1, 0, 0, 0}) * v[0] + unit_or(bitangent, Float4{0, 1, 0, 0}) * v[1] +
           unit_or(normal, Float4{0, 0, 1, 0}) * v[2];
  }

  // The inverse, of any vector along n, brought to unit length (Cramer: interpolated vectors are not perpendicular to
  // each other). With T = a T', B = b B', N = c N' and T', B', N' of unit length, x ~ n . (B' x N') is along
  // a n . (B x N), and so on: one division is enough. Where they lie in one plane no colour would be right; the flat
  // one stays.
  [[nodiscard]] Float4 from_space(const Float4& n) const {
    constexpr Float4 flat{0, 0, 1, 0};
    const float a = norm3(tangent), b = norm3(bitangent), c = norm3(normal);
    const Float4 along_x = cross3(bitangent, normal);
    const float determinant = dot3(tangent, along_x);
    if (!(std::abs(determinant) >= 1e-5F * a * b * c)) return flat;
    const Float4 v{a * dot3(n, along_x), b * dot3(n, cross3(normal, tangent)), c * dot3(n, cross3(tangent, bitangent)),
                   0};
    return unit_or(determinant > 0 ? v : -v, flat);
  }
};

// The frames at the corners of a triangle.
class CornerFrames {
public:
  CornerFrames() = default;
  CornerFrames(const std::array<Tangent, 3>& tangents, const std::array<Vec3f, 3>& normals)
      : normals_(scaled(normals)) {
    for (std::size_t k = 0; k < 3; ++k) {
      tangents_[k] = Float4{tangents[k].x, tangents[k].y, tangents[k].z, 0};
      bitangents_[k] = cross3(normals_[k], tangents_[k]) * tangents[k].w;
    }
  }
  [[nodiscard]] Frame at(const Weights& w) const {
    return {blend(tangents_, w), blend(bitangents_, w), blend(normals_, w)};
  }

private:
  Corners tangents_{}, bitangents_{}, normals_{};
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
    if (own_frames_) corners_ = frames_->corners(t);
    scale_ = source_.detail != nullptr ? source_.scales[source_.source_of[t]] : 0.0F;
    if (scale_ == 0) {
      normals_ = scaled(source_.normals[t]);
      return;
    }
    footprint_ = source_.detail->footprint(t, place);
    detail_frames_ = {source_.tangents[t], source_.normals[t]};
  }

  void texel(std::uint32_t x, std::uint32_t y, const Weights& w) {
    const Float4 along = normal_at(w);
    Float4 n;
    if (own_frames_)
      n = corners_.at(w).from_space(along);
    else if (frames_)
      n = frames_->at(x, y, x + 0.5, y + 0.5).from_space(along);
    else
      n = unit_or(along, Float4{0, 0, 1, 0});
    store_numbers((n + 1.0F) * 0.5F, image_, x, y);
  }

private:
  // In the space of POSITION, of any length.
  [[nodiscard]] Float4 normal_at(const Weights& w) const {
    if (scale_ == 0) return blend(normals_, w);
    const Light c = TextureReader::read(footprint_, w);
    return detail_frames_.at(w).to_space(Float4{scale_ * (2 * c[0] - 1), scale_ * (2 * c[1] - 1), 2 * c[2] - 1, 0});
  }

  CornerFrames corners_; // of the triangle in work, with own_frames_
  CornerFrames detail_frames_;
  Corners normals_{}; // without detail
  TextureReader::Footprint footprint_;
  const NormalSource& source_;
  Picture& image_;
  std::optional<FieldReader> frames_;
  float scale_ = 0;
  bool own_frames_ = false; // those of the triangles that the map shows
};

class PositionShader {
public:
  PositionShader(std::span<const std::array<Vec3f, 3>> positions, const Box& box, Image16& image)
      : positions_(positions), box_(box), image_(image) {}

  void triangle(std::uint32_t t, const TriangleInPage&) { corners_ = &positions_[t]; }

  void texel(std::uint32_t x, std::uint32_t y, const Weights& w) {
    const Vec3d p = blend(*corners_, w) - box_.low, size = box_.high - box_.low;
    store_numbers(std::array{fraction(p.x, size.x), fraction(p.y, size.y), fraction(p.z, size.z)}, image_, x, y);
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
