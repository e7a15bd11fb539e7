#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/texture/bake.h"
#include "core/texture/color.h"
#include "core/texture/cube_map.h"
#include "core/texture/lettering.h"

namespace orbis::texture {
namespace {

struct Palette {
  std::string_view name;
  Rgb light, full, ink; // fields alternate between light and full; ink is for text on light fields and for lines
};
constexpr std::array<Palette, face_count> palettes{{
    {"+X", {250, 220, 214}, {222, 98, 84}, {110, 28, 20}},
    {"-X", {252, 231, 200}, {230, 150, 54}, {107, 62, 8}},
    {"+Y", {225, 241, 206}, {116, 178, 70}, {42, 82, 16}},
    {"-Y", {208, 240, 232}, {50, 164, 144}, {10, 74, 64}},
    {"+Z", {212, 227, 250}, {74, 130, 212}, {20, 56, 112}},
    {"-Z", {232, 219, 247}, {146, 100, 202}, {62, 30, 104}},
}};
constexpr Rgb white{255, 255, 255};
constexpr Rgb border_color{38, 42, 52};

class FacePainter {
public:
  FacePainter(Face face, Image& image)
      : image_(image), side_(image.width), palette_(palettes[face]), fields_(side_ >= 128  ? 8
                                                                             : side_ >= 48 ? 4
                                                                                           : 2),
        field_(static_cast<double>(side_) / fields_) {}

  void paint() {
    checker();
    for (int row = 0; row < fields_; ++row)
      for (int column = 0; column < fields_; ++column) label(column, row);
    lines();
  }

private:
  Image& image_;
  std::uint32_t side_;
  const Palette& palette_;
  int fields_;   // a side
  double field_; // texels a field

  [[nodiscard]] static bool is_light(int column, int row) { return (column + row) % 2 == 0; }

  void blend(std::uint32_t x, std::uint32_t y, const Rgb& color, float t) {
    std::uint8_t* texel = image_.at(x, y);
    const Rgb result = mixed({texel[0], texel[1], texel[2]}, color, t);
    std::copy(result.begin(), result.end(), texel);
  }

  void checker() {
    std::vector<int> field(side_);
    for (std::uint32_t i = 0; i < side_; ++i) field[i] = static_cast<int>((i + 0.5) / field_);
    for (std::uint32_t y = 0; y < side_; ++y)
      for (std::uint32_t x = 0; x < side_; ++x) {
        const Rgb& color = is_light(field[x], field[y]) ? palette_.light : palette_.full;
        std::copy(color.begin(), color.end(), image_.at(x, y));
      }
  }

  // The part of a texel that a line of this width around `centre` covers.
  static float covered(std::uint32_t texel, double centre, double width) {
    const double from = std::max<double>(texel, centre - width / 2);
    const double to = std::min<double>(texel + 1.0, centre + width / 2);
    return static_cast<float>(std::max(to - from, 0.0));
  }

  void lines() {
    const double thin = std::max(field_ / 40, 0.75), thick = 3 * thin; // half of the border lies on the next face
    std::vector<float> grid(side_), border(side_);
    for (std::uint32_t i = 0; i < side_; ++i) {
      for (int k = 1; k < fields_; ++k) grid[i] += covered(i, k * field_, thin);
      border[i] = covered(i, 0, thick) + covered(i, side_, thick);
    }
    for (std::uint32_t y = 0; y < side_; ++y)
      for (std::uint32_t x = 0; x < side_; ++x) {
        if (const float t = std::max(grid[x], grid[y]); t > 0) blend(x, y, palette_.ink, 0.85F * std::min(t, 1.0F));
        if (const float t = std::max(border[x], border[y]); t > 0) blend(x, y, border_color, std::min(t, 1.0F));
      }
  }

  void label(int column, int row) {
    const Rgb& color = is_light(column, row) ? palette_.ink : white;
    const std::string field{static_cast<char>('A' + column), static_cast<char>('1' + row)};
    constexpr double smallest_legible = 6;
    const double large = 0.38 * field_, small = 0.15 * field_;
    const double x = (column + 0.5) * field_, y = (row + 0.5) * field_;
    if (small >= smallest_legible) {
      text(field, large, x, y + 0.08 * field_, color);
      text(palette_.name, small, x, y - 0.34 * field_, color);
    } else if (large >= smallest_legible) {
      text(field, large, x, y, color);
    }
  }

  void text(std::string_view letters, double height, double centre_x, double centre_y, const Rgb& color) {
    const TextMask mask = draw_text(letters, height);
    const auto x0 = static_cast<std::uint32_t>(std::lround(std::max(centre_x - mask.width / 2.0, 0.0)));
    const auto y0 = static_cast<std::uint32_t>(std::lround(std::max(centre_y - mask.height / 2.0, 0.0)));
    for (std::uint32_t y = 0; y < std::min(mask.height, side_ - y0); ++y)
      for (std::uint32_t x = 0; x < std::min(mask.width, side_ - x0); ++x)
        if (const std::uint8_t t = mask.coverage[std::size_t{y} * mask.width + x]; t > 0)
          blend(x0 + x, y0 + y, color, static_cast<float>(t) / 255);
  }
};

// A side of a face about as many texels long as the largest component's share of the page lets it appear, less what
// the central projection stretches it by: then one read a texel does.
std::uint32_t side_for(const CutMesh& mesh, std::uint32_t page) {
  constexpr double smallest = 64, largest = 2048;
  std::map<std::uint32_t, double> texels; // by component
  for (const Chart& c : mesh.charts)
    if (c.page == page) texels[c.component] += static_cast<double>(c.width) * c.height;
  double most = 0;
  for (const auto& [component, count] : texels) most = std::max(most, count);
  return static_cast<std::uint32_t>(std::clamp(0.8 * std::sqrt(most / face_count), smallest, largest));
}

} // namespace

Image bake_pattern(const TexelMap& map, const CutMesh& mesh, std::uint32_t page, const Progress& progress,
                   mesh::ThreadPool& pool) {
  std::vector<Image> faces(face_count);
  const std::uint32_t side = side_for(mesh, page);
  progress.check();
  pool.for_blocks(face_count, 1, [&](std::size_t f, std::size_t) {
    faces[f] = {side, side, 3, {}};
    faces[f].pixels.resize(std::size_t{3} * side * side);
    FacePainter(static_cast<Face>(f), faces[f]).paint();
  });
  return bake_cube_map(map, mesh, faces, progress, pool);
}

} // namespace orbis::texture
