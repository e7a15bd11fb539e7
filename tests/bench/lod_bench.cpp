// Levels of detail alone: time, and how far each level is from the full surface.
//
//   bench_lod [--levels 0.25,0.05,0.01] [--size 2048] MODEL…
//
// For each model and level: triangles; CPU milliseconds of the simplification of all levels; mean distance level to
// full, full to level, Hausdorff distance, mean texture deviation, all in per cent of the bounding box's diagonal; part
// of the surface that samples outside of the charts, in per cent.
#include <cstdio>
#include <ctime>
#include <sstream>
#include <string>
#include <vector>

#include "bench/read_surface.h"
#include "core/lod/distance.h"
#include "core/lod/simplify.h"
#include "core/sphere/embedding.h"
#include "core/sphere/snap.h"

using namespace orbis;

namespace {

double milliseconds_since(std::clock_t start) {
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

void measure(const std::string& path, const std::vector<double>& ratios, std::uint32_t size) {
  const mesh::TriangleMesh surface = bench::read_surface(path);
  NoProgress progress;
  const sphere::Embedding embedding = sphere::embed_isometric(surface, Quality::standard, 0, progress);
  const sphere::Snapped snapped = sphere::snap(embedding.points, surface.triangles);
  const texture::CutMesh cut = texture::make_atlas(
      {surface.triangles, surface.triangles, snapped.points, surface.positions, surface.triangles.size()}, size,
      progress);
  const std::vector<std::uint32_t> primitive_of(surface.triangles.size(), 0);

  std::vector<lod::Target> targets;
  for (const double r : ratios)
    targets.push_back({static_cast<std::uint64_t>(r * static_cast<double>(surface.triangles.size())), 0});
  std::clock_t start = std::clock();
  const lod::FullSurface full(surface, primitive_of, cut);
  const std::vector<lod::Level> levels =
      lod::simplify(full, targets, double(cut.gutter) / cut.pages[0].width, progress);
  const double simplification = milliseconds_since(start);
  start = std::clock();
  mesh::ThreadPool threads(0);
  const lod::Ruler ruler(full, threads);
  for (const lod::Level& level : levels) {
    const lod::Distances d = ruler.distances(level);
    const lod::TextureDeviation t = ruler.texture_deviation(level);
    const std::string name = path.substr(path.rfind('/') + 1);
    std::printf("%-26s %7zu %7zu %6.0f  %.4f %.4f %.3f  %.4f %.3f  %.4f  %d %.4f %llu %d\n", name.c_str(),
                surface.triangles.size(), level.mesh.triangles.size(), simplification, 100 * d.to_full,
                100 * d.from_full, 100 * d.hausdorff, 100 * t.mean, 100 * t.largest, 100 * t.outside,
                int(level.concessions.turned_normals), level.concessions.outline,
                static_cast<unsigned long long>(level.concessions.lost_components), int(level.concessions.is_short));
  }
  std::printf("measured in %.0f ms\n", milliseconds_since(start));
}

} // namespace

int main(int count, char** values) {
  std::vector<double> ratios{0.25, 0.05, 0.01};
  std::uint32_t size = 2048;
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    if (word == "--levels" && i + 1 < count) {
      ratios.clear();
      std::istringstream list(values[++i]);
      for (std::string item; std::getline(list, item, ',');) ratios.push_back(std::stod(item));
    } else if (word == "--size" && i + 1 < count) {
      size = static_cast<std::uint32_t>(std::stoul(values[++i]));
    } else {
      try {
        measure(word, ratios, size);
      } catch (const Error& e) {
        std::printf("%s: %s\n", word.c_str(), e.what());
      }
    }
  }
}
