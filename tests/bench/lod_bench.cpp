// Levels of detail alone: time, how far each level is from the full surface, and how it looks.
//
//   bench_lod [--levels 0.25,0.05,0.01] [--size 2048] [--meshopt] [--pictures DIR] [--write FULL.obj]
//             [--beside LOW.obj,NORMALS.png]… MODEL…
//
// For each model and level: triangles; CPU milliseconds of the simplification of all levels; mean distance level to
// full and full to level, Hausdorff distance, mean and largest texture deviation, all in per cent of the bounding box's
// diagonal; part of the surface that samples outside of the charts, in per cent; PSNR of the normal-mapped render
// against the full surface's, and of one with the level's own normals, in dB. --meshopt: the same distances for
// meshoptimizer's simplification of the uncut mesh. --pictures: a row of pictures for each model: full, then for each
// level with the normal map and without. --write: the full surface, for others to work on. --beside: the same measures
// for another program's level (in the same coordinates) with its map of object-space normals, and their pictures too;
// tests/bench/blender.py makes one.
#include <meshoptimizer.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <list>
#include <sstream>
#include <string>
#include <vector>

#include "bench/read_surface.h"
#include "core/asset/asset.h"
#include "core/asset/image_codec.h"
#include "core/lod/distance.h"
#include "core/lod/normal_map.h"
#include "core/lod/render.h"
#include "core/lod/simplify.h"
#include "core/sphere/embedding.h"
#include "core/sphere/snap.h"
#include "core/texture/sampler.h"
#include "core/texture/shape.h"

using namespace orbis;

namespace {

struct Arguments {
  std::vector<double> ratios{0.25, 0.05, 0.01};
  std::uint32_t size = 2048;
  bool meshopt = false;
  std::string pictures, written;
  std::vector<std::string> beside; // LOW.obj,NORMALS.png
};

void write_obj(const std::string& path, const mesh::TriangleMesh& surface) {
  std::ofstream file(path);
  file.precision(9);
  for (const Vec3f& p : surface.positions) file << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
  for (const auto& [a, b, c] : surface.triangles) file << "f " << a + 1 << ' ' << b + 1 << ' ' << c + 1 << '\n';
}

// Another program's level: its triangles, and normals from a picture.
class Foreign {
public:
  explicit Foreign(const std::string& files)
      : image_(asset::decode_image(bench::bytes_of(files.substr(files.find(',') + 1)), std::uint64_t{1} << 28U,
                                   "the normals")),
        sampler_(image_, texture::Wrap::clamp, texture::Wrap::clamp, 1, texture::Encoding::linear) {
    const asset::Asset asset = asset::read_asset(bench::bytes_of(files.substr(0, files.find(','))), {}, {});
    for (const asset::Primitive& p : asset.primitives) {
      const auto first = static_cast<mesh::Index>(positions_.size());
      const asset::Attribute* uv = p.find("TEXCOORD_0");
      if (uv == nullptr) throw Error(ErrorCode::malformed, "the level has no texture coordinates", files);
      for (const Vec3f& position : p.positions()) {
        const auto v = static_cast<std::uint32_t>(positions_.size()) - first;
        positions_.push_back(position);
        uv_.push_back({uv->get(v, 0), uv->get(v, 1)});
      }
      for (std::size_t i = 0; i + 2 < p.indices.size(); i += 3)
        triangles_.push_back({first + p.indices[i], first + p.indices[i + 1], first + p.indices[i + 2]});
    }
  }

  [[nodiscard]] std::span<const Vec3f> positions() const { return positions_; }
  [[nodiscard]] std::span<const mesh::Triangle> triangles() const { return triangles_; }
  [[nodiscard]] lod::Sitter sitter() const {
    return {positions_, triangles_, [this](std::span<const lod::Spot> spots, std::span<Vec3f> out) {
              for (std::size_t i = 0; i < spots.size(); ++i) {
                const mesh::Triangle& corners = triangles_[spots[i].triangle];
                const std::array<double, 3> w{1.0 - spots[i].b - spots[i].c, spots[i].b, spots[i].c};
                double u = 0, v = 0;
                for (std::size_t k = 0; k < 3; ++k) {
                  u += w[k] * uv_[corners[k]][0];
                  v += w[k] * uv_[corners[k]][1];
                }
                const texture::Light n = sampler_.sample(u * image_.width, v * image_.height, 0);
                out[i] = {2 * n[0] - 1, 2 * n[1] - 1, 2 * n[2] - 1};
              }
            }};
  }

private:
  texture::Image image_;
  texture::Sampler sampler_;
  std::vector<Vec3f> positions_;
  std::vector<std::array<double, 2>> uv_;
  std::vector<mesh::Triangle> triangles_;
};

texture::CutMesh make_atlas(const mesh::TriangleMesh& surface, std::uint32_t size) {
  NoProgress progress;
  const sphere::Embedding embedding = sphere::embed_isometric(surface, Quality::standard, 0, progress);
  const sphere::Snapped snapped = sphere::snap(embedding.points, surface.triangles);
  return texture::make_atlas(
      {surface.triangles, surface.triangles, snapped.points, surface.positions, surface.triangles.size()}, size,
      progress);
}

double milliseconds_since(std::clock_t start) {
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

// meshoptimizer's simplification as a level: its places in the atlas are not used.
lod::Level meshopt_level(const mesh::TriangleMesh& surface, std::size_t triangles, double& milliseconds) {
  lod::Level level;
  std::vector<std::uint32_t> indices(3 * surface.triangles.size());
  const auto* source = surface.triangles.front().data();
  const std::clock_t start = std::clock();
  float error = 0;
  indices.resize(meshopt_simplify(indices.data(), source, 3 * surface.triangles.size(), &surface.positions[0].x,
                                  surface.positions.size(), sizeof(Vec3f), 3 * triangles, 1.0F, 0, &error));
  milliseconds = milliseconds_since(start);
  level.positions = surface.positions;
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
    level.mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  return level;
}

// The part of the pictures that any of them needs, with a margin.
struct Frame {
  std::uint32_t left = 0, right = 0, top = 0, bottom = 0; // right and bottom: one past the last

  [[nodiscard]] std::uint32_t width() const { return right - left; }
  [[nodiscard]] std::uint32_t height() const { return bottom - top; }
};

Frame frame_of(const std::vector<lod::Picture>& row) {
  const std::uint32_t size = row[0].size, margin = size / 50;
  Frame frame{size, 0, size, 0};
  for (const lod::Picture& picture : row) {
    for (std::uint32_t i = 0; i < size * size; ++i) {
      if (picture.light[i] == lod::background) continue;
      frame.left = std::min(frame.left, i % size);
      frame.right = std::max(frame.right, i % size + 1);
      frame.top = std::min(frame.top, i / size);
      frame.bottom = std::max(frame.bottom, i / size + 1);
    }
  }
  return {frame.left - std::min(margin, frame.left), std::min(frame.right + margin, size),
          frame.top - std::min(margin, frame.top), std::min(frame.bottom + margin, size)};
}

// A level twice: with the full surface's normals from the atlas, and with its own.
struct Shown {
  std::vector<Vec3d> own_normals;
  lod::Sitter with_map, without_map;

  Shown(const lod::Level& level, const lod::NormalMap& map)
      : own_normals(
            texture::smooth_normals(level.mesh, std::vector<Vec3d>(level.positions.begin(), level.positions.end()))),
        with_map{level.positions, level.mesh.triangles, map.on(level.mesh)},
        without_map{level.positions, level.mesh.triangles, lod::interpolated(own_normals, level.mesh.triangles)} {}
};

void write_pictures(const std::string& path, const lod::Photographer& photographer, const lod::NormalMap& map,
                    const std::vector<lod::Level>& levels, const std::list<Foreign>& beside, std::size_t view) {
  std::vector<lod::Picture> row{photographer.of_full(view)};
  for (const lod::Level& level : levels) {
    const Shown shown(level, map);
    row.push_back(photographer.of(shown.with_map, view));
    row.push_back(photographer.of(shown.without_map, view));
  }
  for (const Foreign& other : beside) row.push_back(photographer.of(other.sitter(), view));
  const Frame frame = frame_of(row);
  texture::Image image{frame.width() * static_cast<std::uint32_t>(row.size()), frame.height(), 3, {}};
  image.pixels.resize(std::size_t{image.width} * image.height * 3);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const lod::Picture& picture = row[x / frame.width()];
      const std::size_t column = frame.left + x % frame.width();
      const float light = picture.light[(frame.top + y) * std::size_t{picture.size} + column];
      const float shown = light == lod::background ? 1.0F : light;
      for (std::size_t c = 0; c < 3; ++c) image.at(x, y)[c] = static_cast<std::uint8_t>(255 * shown + 0.5F);
    }
  }
  const std::vector<std::byte> bytes = asset::encode_jpeg(image, 85);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void measure(const std::string& path, const Arguments& arguments) {
  const std::string name = path.substr(path.rfind('/') + 1);
  const mesh::TriangleMesh surface = bench::read_surface(path);
  const texture::CutMesh cut = make_atlas(surface, arguments.size);
  const std::vector<std::uint32_t> primitive_of(surface.triangles.size(), 0);
  std::vector<lod::Target> targets;
  for (const double r : arguments.ratios)
    targets.push_back({static_cast<std::uint64_t>(r * static_cast<double>(surface.triangles.size())), 0});

  NoProgress progress;
  mesh::ThreadPool threads(0);
  std::clock_t start = std::clock();
  const lod::FullSurface full(surface, primitive_of, cut);
  const std::vector<lod::Level> levels = lod::simplify(full, targets, threads, progress);
  const double simplification = milliseconds_since(start);

  start = std::clock();
  const lod::Ruler ruler(full, threads);
  const std::vector<Vec3d> positions(full.positions().begin(), full.positions().end());
  const std::vector<Vec3d> normals = texture::smooth_normals(cut, positions);
  const lod::NormalMap map(full, normals);
  std::vector<Vec3f> in_model;
  for (const Vec3d& p : positions) in_model.push_back(full.in_model(p));
  const lod::Photographer photographer({in_model, cut.triangles, lod::interpolated(normals, cut.triangles)}, 512,
                                       threads);
  for (const lod::Level& level : levels) {
    const lod::Distances d = ruler.distances(level);
    const lod::TextureDeviation t = ruler.texture_deviation(level);
    const Shown shown(level, map);
    std::printf("%-26s %7zu %6zu %6.0f ms  %.4f %.4f %.3f  %.4f %.3f  %.4f  %.1f %.1f\n", name.c_str(),
                surface.triangles.size(), level.mesh.triangles.size(), simplification, 100 * d.to_full,
                100 * d.from_full, 100 * d.hausdorff, 100 * t.mean, 100 * t.largest, 100 * t.outside,
                photographer.psnr(shown.with_map), photographer.psnr(shown.without_map));
  }
  std::printf("measured in %.0f ms\n", milliseconds_since(start));
  for (const lod::Target& target : targets) {
    if (!arguments.meshopt) break;
    double time = 0;
    const lod::Level level = meshopt_level(surface, target.triangles, time);
    const lod::Distances d = ruler.distances(level);
    std::printf("%-26s %7zu %6zu %6.0f ms  %.4f %.4f %.3f  meshoptimizer\n", name.c_str(), surface.triangles.size(),
                level.mesh.triangles.size(), time, 100 * d.to_full, 100 * d.from_full, 100 * d.hausdorff);
  }
  std::list<Foreign> beside; // sitters refer to them
  for (const std::string& files : arguments.beside) {
    const Foreign& other = beside.emplace_back(files);
    std::vector<Vec3d> scaled;
    for (const Vec3f& p : other.positions()) scaled.push_back(full.in_scale(p));
    const lod::Distances d = lod::distances_between(scaled, other.triangles(), positions, cut.triangles, threads);
    std::printf("%-26s %7zu %6zu            %.4f %.4f %.3f                          %.1f  %s\n", name.c_str(),
                surface.triangles.size(), other.triangles().size(), 100 * d.to_full, 100 * d.from_full,
                100 * d.hausdorff, photographer.psnr(other.sitter()), files.c_str());
  }
  if (!arguments.written.empty()) write_obj(arguments.written, surface);
  for (std::size_t view = 0; view < lod::Photographer::views && !arguments.pictures.empty(); ++view)
    write_pictures(arguments.pictures + "/" + name + "-" + std::to_string(view) + ".jpg", photographer, map, levels,
                   beside, view);
}

} // namespace

int main(int count, char** values) {
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    if (word == "--levels" && i + 1 < count) {
      arguments.ratios.clear();
      std::istringstream list(values[++i]);
      for (std::string item; std::getline(list, item, ',');) arguments.ratios.push_back(std::stod(item));
    } else if (word == "--size" && i + 1 < count) {
      arguments.size = static_cast<std::uint32_t>(std::stoul(values[++i]));
    } else if (word == "--meshopt") {
      arguments.meshopt = true;
    } else if (word == "--pictures" && i + 1 < count) {
      arguments.pictures = values[++i];
    } else if (word == "--write" && i + 1 < count) {
      arguments.written = values[++i];
    } else if (word == "--beside" && i + 1 < count) {
      arguments.beside.emplace_back(values[++i]);
    } else {
      try {
        measure(word, arguments);
      } catch (const Error& e) {
        std::printf("%s: %s\n", word.c_str(), e.what());
      }
    }
  }
}
