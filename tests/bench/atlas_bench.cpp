// The atlas alone: what it costs, and how evenly it spreads texels.
//
//   bench_atlas [--size 2048] MODEL…
//
// For each model: triangles, charts, length of the seams over the square root of the area, texels per area of the worst
// triangle and at the first percentile of the surface over the median, L2 stretch, per cent of the page that charts
// use, CPU seconds of cutting, flattening and packing. Models that are not one closed surface of genus 0 are named as
// such.
#include <cstdio>
#include <ctime>
#include <string>

#include "bench/read_surface.h"
#include "core/sphere/embedding.h"
#include "core/sphere/snap.h"
#include "core/texture/quality.h"

using namespace orbis;

namespace {

void measure(const std::string& path, std::uint32_t size) {
  const mesh::TriangleMesh surface = bench::read_surface(path);
  NoProgress progress;
  const sphere::Embedding embedding = sphere::embed_isometric(surface, Quality::standard, 0, progress);
  const sphere::Snapped snapped = sphere::snap(embedding.points, surface.triangles);
  const std::clock_t start = std::clock();
  const texture::CutMesh cut = texture::make_atlas(
      {surface.triangles, surface.triangles, snapped.points, surface.positions, surface.triangles.size()}, size,
      progress);
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  const texture::AtlasQuality q = texture::measure_atlas(cut, surface);
  std::printf("%-28s %7zu %3zu %5.2f  %.3f %.3f  %.3f  %2.0f %%  %.2f s\n", path.substr(path.rfind('/') + 1).c_str(),
              surface.triangles.size(), cut.charts.size(), q.seam_length, q.density_min / q.density_median,
              q.density_p1 / q.density_median, q.l2_stretch, 100 * texture::utilisation(cut), seconds);
  std::fflush(stdout);
}

} // namespace

int main(int count, char** values) {
  std::uint32_t size = 2048;
  for (int i = 1; i < count; ++i) {
    const std::string word = values[i];
    if (word == "--size" && i + 1 < count) {
      size = static_cast<std::uint32_t>(std::stoul(values[++i]));
      continue;
    }
    try {
      measure(word, size);
    } catch (const Error& e) {
      std::printf("%s: %s\n", word.c_str(), e.what());
    }
  }
}
