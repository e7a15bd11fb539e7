#include "core/steps/bake_maps.h"

#include <array>

#include "core/asset/image_codec.h"
#include "core/steps/geometry_maps.h"
#include "core/steps/material_maps.h"
#include "core/steps/page_baking.h"

namespace orbis {

namespace {

// Levels keep the seams of the atlas (lod/wedge_mesh.h), not those of the coordinates that other textures have.
void note_kept_textures(const BakeJob& job) {
  for (std::size_t p = 0; p < job.asset.primitives.size() && !job.levels.empty(); ++p) {
    const asset::NewPrimitive& delivered = job.delivery.primitives[p];
    if (delivered.indices.empty() || !asset::keeps_textures(job.asset, job.asset.primitives[p], delivered.textures))
      continue;
    job.report.notes.push_back({"level-texture-coordinates",
                                "the material has textures that are not baked: on levels of detail they smear where "
                                "triangles cross the seams of their own coordinates",
                                pointer_to(job.asset.primitives[p])});
  }
}

} // namespace

std::vector<std::byte> atlas_picture(const BakedMaps& maps, const Options& options) {
  const auto largest = std::ranges::max_element(
      maps.pages, {}, [](const texture::Image& page) { return std::uint64_t{page.width} * page.height; });
  std::string name = "base_color";
  if (maps.pages.size() > 1) name.append("-").append(std::to_string(largest - maps.pages.begin() + 1));
  const auto file = std::ranges::find(maps.files, name.append(".png"), &MapFile::name);
  if (file != maps.files.end()) return file->bytes;
  return asset::encode_png(*largest, texture::Encoding::srgb, options.threads);
}

BakedMaps bake_maps(const Request& request, const Limits& limits, const SurfaceInAtlas& from,
                    const SurfaceInAtlas& shown, Delivery& delivery, std::span<DetailLevel> levels, Progress& progress,
                    Report& report) {
  const BakeJob job{request, limits, from.asset, from.surface, from.cut, shown, delivery, levels, progress, report};
  PageBaking page(job);
  MaterialMaps materials(job, page);
  GeometryMaps geometry(job, page);
  const std::array<std::function<void()>, 7> steps{
      [&] { materials.bake_base_color(); },       [&] { materials.bake_metallic_roughness_and_occlusion(); },
      [&] { materials.bake_emissive(); },         [&] { geometry.bake_normals(); },
      [&] { geometry.bake_ambient_occlusion(); }, [&] { geometry.bake_positions(); },
      [&] { geometry.bake_displacements(); },
  };
  const std::size_t pages = from.cut.pages.size();
  const std::uint64_t total = pages * steps.size();
  std::uint64_t done = 0;
  for (std::uint32_t p = 0; p < pages; ++p) {
    page.open(p);
    for (const auto& step : steps) {
      progress.check();
      progress.report(Stage::bake, done++, total);
      step();
    }
  }
  progress.check();
  note_kept_textures(job);
  progress.report(Stage::bake, total, total);
  return page.take();
}

} // namespace orbis
