// The stages of the embedding as one picture, for the docs.
//
//   stage_pictures MODEL OUT.png
//
// Five levels of the hierarchy, from the tetrahedron to the whole surface: above on the surface, below each one's own
// map on the sphere. Triangles keep their colour, that of the direction of their normal on the surface.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "bench/read_surface.h"
#include "core/asset/image_codec.h"
#include "core/mesh/spatial_order.h"
#include "core/mesh/unit_positions.h"
#include "core/sphere/canonical_turn.h"
#include "core/sphere/embedding.h"
#include "core/sphere/hierarchy.h"
#include "core/sphere/level_mesh.h"
#include "core/texture/canvas.h"

using namespace orbis;

namespace {

constexpr std::uint32_t cell = 360, tile = 32;
constexpr std::array<std::size_t, 4> wanted_vertices{4, 60, 500, 2'000};

// A texture of tiles, one a colour, each dark along its three edges: (0, 0), (1, 0) and (0, 1) are a triangle's
// corners.
constexpr std::uint32_t tiles_a_row = 16;

texture::Image tiles() {
  texture::Image out{tiles_a_row * tile, tiles_a_row * tile, 3, {}};
  out.pixels.resize(std::size_t{3} * out.width * out.height);
  for (std::uint32_t y = 0; y < out.height; ++y) {
    for (std::uint32_t x = 0; x < out.width; ++x) {
      const std::uint32_t i = x / tile, j = y / tile, u = x % tile, v = y % tile;
      const bool edge = u < 2 || v < 2 || u + v > tile - 5;
      const double hue = 6.2831853 * i / tiles_a_row, light = 0.55 + 0.4 * j / tiles_a_row;
      for (std::uint32_t c = 0; c < 3; ++c) {
        const double shade = light * (0.72 + 0.28 * std::cos(hue - 2.0943951 * c));
        out.at(x, y)[c] = static_cast<std::uint8_t>(255 * (edge ? 0.25 * shade : shade));
      }
    }
  }
  return out;
}

// Every triangle by itself, on the tile of its colour.
class Drawing {
public:
  explicit Drawing(const mesh::TriangleMesh& level) : level_(level) {
    mesh_.charts.resize(1);
    mesh_.pages.push_back({tiles_a_row * tile, tiles_a_row * tile});
    for (std::uint32_t t = 0; t < level.triangles.size(); ++t) add(t);
  }

  [[nodiscard]] texture::Shape shape(std::span<const Vec3d> at) const {
    texture::Shape out{mesh_, {}, {}, {}, {}};
    for (const mesh::Triangle& t : level_.triangles) {
      const Vec3d n = cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]);
      const double length = norm(n);
      for (const mesh::Index v : t) {
        out.positions.push_back(at[v]);
        out.normals.push_back(length > 0 ? n * (1 / length) : Vec3d{0, 0, 1});
      }
    }
    return out;
  }

private:
  void add(std::uint32_t t) {
    const auto& [a, b, c] = level_.triangles[t];
    const Vec3d p(level_.positions[a]), n = cross(Vec3d(level_.positions[b]) - p, Vec3d(level_.positions[c]) - p);
    const double turn = (std::atan2(n.x, n.z) / 6.2831853 + 1) * tiles_a_row;
    const double height = 0.5 * (n.y / std::max(norm(n), 1e-300) + 1) * (tiles_a_row - 1);
    const auto i = static_cast<std::uint32_t>(turn) % tiles_a_row, j = static_cast<std::uint32_t>(height);
    const float size = 1.0F / tiles_a_row, u = static_cast<float>(i) * size, v = static_cast<float>(j) * size;
    const float inner = size * (tile - 1) / tile;
    const auto first = static_cast<mesh::Index>(mesh_.vertices.size());
    for (const Vec2f uv : {Vec2f{u, v}, Vec2f{u + inner, v}, Vec2f{u, v + inner}}) {
      mesh_.vertices.push_back({t, {}, {}, uv, static_cast<std::uint32_t>(mesh_.vertices.size())});
    }
    mesh_.triangles.push_back({first, first + 1, first + 2});
    mesh_.parent.push_back(t);
    mesh_.chart.push_back(0);
  }

  const mesh::TriangleMesh& level_;
  texture::CutMesh mesh_;
};

mesh::TriangleMesh mesh_of(const sphere::LevelMesh& level, const mesh::TriangleMesh& surface) {
  mesh::TriangleMesh out;
  for (const mesh::Index v : level.vertices()) out.positions.push_back(surface.positions[v]);
  out.triangles.assign(level.triangles().begin(), level.triangles().end());
  return out;
}

void draw(const mesh::TriangleMesh& level, std::uint32_t column, texture::Canvas& canvas) {
  NoProgress progress;
  std::vector<Vec3d> points = sphere::embed_isometric(level, Quality::high, 1, progress).points;
  points = sphere::canonically_turned(level, std::move(points));
  std::vector<Vec3d> positions;
  for (const Vec3f& p : level.positions) positions.emplace_back(p);
  const Drawing drawing(level);
  canvas.draw(drawing.shape(positions), {column * cell, 0, cell, cell});
  canvas.draw(drawing.shape(points), {column * cell, cell, cell, cell});
  std::printf("%zu vertices\n", level.positions.size());
}

} // namespace

int main(int count, char** values) {
  if (count != 3) {
    std::fprintf(stderr, "stage_pictures MODEL OUT.png\n");
    return 2;
  }
  mesh::ThreadPool pool(0);
  NoProgress progress;
  const mesh::TriangleMesh surface = bench::read_surface(values[1]);
  sphere::Hierarchy hierarchy = sphere::build_hierarchy(surface, pool, progress);
  sphere::LevelMesh level(hierarchy);
  const texture::Image page = tiles();
  texture::Canvas canvas(cell * (static_cast<std::uint32_t>(wanted_vertices.size()) + 1), 2 * cell, std::span(&page, 1),
                         pool);
  std::uint32_t column = 0;
  for (std::size_t round = hierarchy.rounds() + 1; round-- > 0;) {
    level.build(hierarchy, mesh::unit_positions(surface), 0.05, pool);
    const bool wanted = column < wanted_vertices.size() && level.vertices().size() >= wanted_vertices[column];
    if (wanted || round == 0) draw(mesh_of(level, surface), column++, canvas);
    if (round == 0) break;
    for (std::uint32_t i = hierarchy.round_first[round - 1]; i < hierarchy.round_first[round]; ++i) hierarchy.undo(i);
    level.add_round(hierarchy, round - 1);
  }
  const std::vector<std::byte> png = asset::encode_png(canvas.picture());
  std::ofstream(values[2], std::ios::binary)
      .write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
}
