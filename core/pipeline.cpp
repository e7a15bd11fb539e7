#include "core/pipeline.h"

#include <sys/resource.h>

#include "core/asset/asset.h"
#include "core/check_options.h"
#include "core/steps/archive.h"
#include "core/steps/bake_maps.h"
#include "core/steps/delivery.h"
#include "core/steps/dump.h"
#include "core/steps/embed.h"
#include "core/steps/levels.h"
#include "core/steps/likeness.h"
#include "core/steps/measure.h"
#include "core/steps/mirrored_tangents.h"
#include "core/steps/morph.h"
#include "core/steps/paint.h"
#include "core/steps/preview.h"
#include "core/steps/remesh.h"
#include "core/steps/remesh_plan.h"
#include "core/steps/snap_and_cut.h"
#include "core/steps/sphere_morph.h"
#include "core/steps/stage_clock.h"
#include "core/steps/summary.h"
#include "core/steps/surface.h"
#include "core/texture/atlas.h"

namespace orbis {
namespace {

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::vector<Vec3f> deliverable(std::span<const sphere::GridPoint> points) {
  std::vector<Vec3f> out;
  out.reserve(points.size());
  for (const sphere::GridPoint& p : points) out.push_back(sphere::from_grid(p));
  return out;
}

} // namespace

std::vector<std::string_view> Request::file_names() const {
  std::vector<std::string_view> out;
  for (const auto& [name, bytes] : files) out.emplace_back(name);
  return out;
}

Result process(const Request& request, const Limits& limits, Progress& progress, Checkpoints& checkpoints,
               const StageDump& dump) {
  StageClock clock(progress);
  Result result;
  Report& report = result.report;
  report.options = request.options;

  clock.report(Stage::decode, 0, 1);
  check_options(request.options, request.file_names());
  asset::Asset asset = asset::read_asset(request.model, request.files, limits);
  describe_input(asset, report);
  check_texture(request, asset, limits);

  clock.report(Stage::topology, 0, 1);
  Surface surface = make_surface(asset, report);
  dump_mesh(dump, "1-surface.obj", surface.mesh.positions, surface.mesh.triangles);

  // What can be refused is refused before the long part, which begins with the embedding.
  std::optional<MorphEnd> end = read_morph_end(request, limits, surface);
  const RemeshTarget target = end ? common_target(request.options, surface, end->surface) : request.options.remesh;
  (void)plan_remesh(surface, target, limits);

  std::vector<Vec3d> points = embed(surface, request.options, clock, checkpoints, report);
  if (end) embed_morph_end(*end, clock, report);

  clock.report(Stage::atlas, 0, 1);
  const std::optional<RemeshSource> source = resample(asset, surface, points, target, limits, clock, report);
  if (end) add_morph_target(*end, *source, surface, points, asset, clock, report);
  const CutSphere sphere = snap_and_cut(asset, surface, points, request.options, clock, report);
  const std::vector<Vec3f> delivered = deliverable(sphere.points);
  report.distortion = measure(surface, delivered, report);
  Delivery delivery = make_delivery(asset, surface, sphere.cut);
  dump_mesh(dump, "2-sphere.obj", delivered, surface.mesh.triangles);
  dump_charts(dump, "3-charts.obj", sphere.cut);

  clock.report(Stage::levels, 0, 1);
  std::vector<DetailLevel> levels = make_levels(asset, surface, sphere.cut, clock, report);

  clock.report(Stage::bake, 0, 1);
  const SurfaceInAtlas shown{asset, surface, sphere.cut};
  texture::CutMesh overlay; // what the maps are baked from, where that is not what is delivered
  if (source) overlay = source_in_atlas(*source, surface, points, sphere.cut, request.options.threads);
  const SurfaceInAtlas baked = source ? SurfaceInAtlas{source->asset, source->surface, overlay} : shown;
  BakedMaps maps = bake_maps(request, limits, baked, shown, delivery, levels, clock, report);
  measure_likeness(asset, sphere.cut, delivery, levels, maps, clock, report);

  clock.report(Stage::encode, 0, 1);
  mirror_tangents(asset, delivery, levels, report);
  if (end) name_morph_target(*end, delivery);
  if (request.options.sphere_morph) {
    add_sphere_morph(asset, surface, delivery);
    for (DetailLevel& level : levels) add_sphere_morph(asset, surface, level.delivery);
  }
  result.preview_png = preview(asset, surface, sphere.cut, delivery, maps.pages, request.options.threads);
  result.atlas_png = atlas_picture(maps, request.options);
  result.maps = std::move(maps.files);
  if (request.options.compression == Compression::quantized) quantise(delivery, levels);
  dump_bytes(dump, "4-atlas.png", result.atlas_png);
  dump_bytes(dump, "5-preview.png", result.preview_png);
  std::vector<asset::Asset::Note> dropped;
  result.glb = asset::write_asset(asset, delivery.primitives, maps.images, extras_of(report),
                                  request.options.compression, in_asset(levels, report), &dropped);
  for (const asset::Asset::Note& note : dropped) report.notes.push_back({note.code, note.message, note.where});

  clock.report(Stage::certify, 0, 1);
  certify_file(result.glb, asset, surface, sphere, delivery, report);
  certify_levels(result.glb, asset, surface, levels, report);
  if (request.options.output == OutputForm::zip)
    result.glb = archive_of(std::move(result.glb), asset, surface, delivery, levels, maps.images, report);
  clock.report(Stage::certify, 1, 1);

  report.stages = clock.times();
  report.peak_rss_bytes = peak_rss_bytes();
  return result;
}

} // namespace orbis
