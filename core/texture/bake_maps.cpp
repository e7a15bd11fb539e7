#include "core/texture/bake_maps.h"

#include <algorithm>
#include <cmath>

namespace orbis::texture {
namespace {

constexpr std::size_t rows_a_block = 8;

using Weights = std::array<double, 3>;

// Walks over the map on all threads, each with a shader of its own made by `make`.
template <class Make> void shade(const TexelMap& map, mesh::ThreadPool& pool, Make make) {
  pool.for_blocks(map.height(), rows_a_block, [&](std::size_t begin, std::size_t end) {
    auto shader = make();
    map.walk(begin, end, shader);
  });
}

std::uint16_t to_16_bits(double value) {
  return static_cast<std::uint16_t>(std::lround(65535 * (value > 0 ? std::min(value, 1.0) : 0.0)));
}

void store16(const Vec3d& value, Image16& image, std::uint32_t x, std::uint32_t y) {
  std::uint16_t* p = image.at(x, y);
  p[0] = to_16_bits(value.x);
  p[1] = to_16_bits(value.y);
  p[2] = to_16_bits(value.z);
}

Image16 empty_image16(const TexelMap& map) {
  Image16 image{map.width(), map.height(), 3, {}};
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

// The frame of a renderer: n ~ x T + y B + z N with unit T, B and N.
struct Frame {
  Vec3d tangent, bitangent, normal;

  Frame(const std::array<Tangent, 3>& tangents, const std::array<Vec3f, 3>& normals, const Weights& w)
      : tangent(unit_or(blend(tangents, w), {1, 0, 0})), normal(unit_or(blend(normals, w), {0, 0, 1})) {
    for (std::size_t k = 0; k < 3; ++k) {
      bitangent += cross(vector_of(normals[k]), vector_of(tangents[k])) * (double{tangents[k].w} * w[k]);
    }
    bitangent = unit_or(bitangent, {0, 1, 0});
  }

  [[nodiscard]] Vec3d to_space(const Vec3d& v) const { return tangent * v.x + bitangent * v.y + normal * v.z; }
  // The inverse, brought to unit length (Cramer: interpolated vectors are not perpendicular to each other). Where they
  // lie in one plane no colour would be right; the flat one stays.
  [[nodiscard]] Vec3d from_space(const Vec3d& n) const {
    const Vec3d x = cross(bitangent, normal), y = cross(normal, tangent), z = cross(tangent, bitangent);
    const double determinant = dot(tangent, x);
    if (std::abs(determinant) < 1e-6) return {0, 0, 1};
    return unit_or(Vec3d{dot(n, x), dot(n, y), dot(n, z)} * (1 / determinant), {0, 0, 1});
  }
};

Frame frame_at_place(const FrameField& field, std::uint32_t texel_x, std::uint32_t texel_y, double x, double y) {
  const std::uint32_t t = field.map->triangle(texel_x, texel_y);
  const Weights w = field.map->place(t).nearest_weights(x, y);
  std::array<Vec3f, 3> normals;
  std::array<Tangent, 3> tangents;
  for (std::size_t k = 0; k < 3; ++k) {
    normals[k] = field.normals[field.triangles[t][k]];
    tangents[k] = field.tangents[field.triangles[t][k]];
  }
  return {tangents, normals, w};
}

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

class NormalShader {
public:
  NormalShader(const NormalSource& source, const FrameField* frames, Image16& image)
      : source_(source), frames_(frames), image_(image) {}

  void triangle(std::uint32_t t, const TriangleInPage& place) {
    triangle_ = t;
    scale_ = source_.detail != nullptr ? source_.scales[source_.source_of[t]] : 0.0F;
    if (scale_ != 0) footprint_ = source_.detail->footprint(t, place);
  }

  void texel(std::uint32_t x, std::uint32_t y, const Weights& w) {
    Vec3d n = normal_at(w);
    if (frames_ != nullptr) n = frame_at(x, y).from_space(n);
    store16((n + Vec3d{1, 1, 1}) * 0.5, image_, x, y);
  }

private:
  // In the space of POSITION.
  [[nodiscard]] Vec3d normal_at(const Weights& w) const {
    const std::array<Vec3f, 3>& normals = source_.normals[triangle_];
    if (scale_ == 0) return unit_or(blend(normals, w), {0, 0, 1});
    const Light c = TextureReader::read(footprint_, w);
    const Vec3d detail{scale_ * (2.0 * c[0] - 1), scale_ * (2.0 * c[1] - 1), 2.0 * c[2] - 1};
    return unit_or(Frame(source_.tangents[triangle_], normals, w).to_space(detail), {0, 0, 1});
  }

  [[nodiscard]] Frame frame_at(std::uint32_t x, std::uint32_t y) const {
    return frame_at_place(*frames_, x, y, x + 0.5, y + 0.5);
  }

  const NormalSource& source_;
  const FrameField* frames_;
  Image16& image_;
  std::uint32_t triangle_ = 0;
  float scale_ = 0;
  TextureReader::Footprint footprint_;
};

class PositionShader {
public:
  PositionShader(std::span<const std::array<Vec3f, 3>> positions, const Box& box, Image16& image)
      : positions_(positions), box_(box), image_(image) {}

  void triangle(std::uint32_t t, const TriangleInPage&) { corners_ = &positions_[t]; }

  void texel(std::uint32_t x, std::uint32_t y, const Weights& w) {
    const Vec3d p = blend(*corners_, w) - box_.low, size = box_.high - box_.low;
    store16({fraction(p.x, size.x), fraction(p.y, size.y), fraction(p.z, size.z)}, image_, x, y);
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
                   Encoding encoding, bool alpha, mesh::ThreadPool& pool) {
  Image image{map.width(), map.height(), alpha ? 4U : 3U, {}};
  image.pixels.resize(std::size_t{image.width} * image.height * image.channels);
  shade(map, pool, [&] { return TextureShader(reader, colors, encoding, image); });
  return image;
}

Image16 bake_normals(const TexelMap& map, const NormalSource& source, const FrameField* frames,
                     mesh::ThreadPool& pool) {
  Image16 image = empty_image16(map);
  shade(map, pool, [&] { return NormalShader(source, frames, image); });
  return image;
}

Image16 bake_positions(const TexelMap& map, std::span<const std::array<Vec3f, 3>> positions, const Box& box,
                       mesh::ThreadPool& pool) {
  Image16 image = empty_image16(map);
  shade(map, pool, [&] { return PositionShader(positions, box, image); });
  return image;
}

VertexFrame frame_of(const FrameField& field, std::uint32_t texel_x, std::uint32_t texel_y, double x, double y) {
  const Frame frame = frame_at_place(field, texel_x, texel_y, x, y);
  const Vec3d& n = frame.normal;
  const Vec3d t = unit_or(frame.tangent - n * dot(n, frame.tangent), cross(frame.bitangent, n));
  const float w = dot(cross(n, t), frame.bitangent) < 0 ? -1.0F : 1.0F;
  return {Vec3f(n), {static_cast<float>(t.x), static_cast<float>(t.y), static_cast<float>(t.z), w}};
}

Image to_8_bits(const Image16& image) {
  Image out{image.width, image.height, image.channels, {}};
  out.pixels.reserve(image.pixels.size());
  for (const std::uint16_t value : image.pixels) {
    out.pixels.push_back(static_cast<std::uint8_t>((255U * std::uint32_t{value} + 32767U) / 65535U));
  }
  return out;
}

} // namespace orbis::texture
