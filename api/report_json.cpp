// The report of GET /v1/jobs/{id}/report and of `orbis run --report`.
#include <algorithm>

#include "api/json.h"

namespace orbis::api {
namespace {

constexpr std::size_t most_components = 500;

Json topology_json(const mesh::Topology& t) {
  return {{"vertices", t.vertices},
          {"edges", t.edges},
          {"triangles", t.triangles},
          {"components", t.components},
          {"boundary_loops", t.boundary_loops},
          {"boundary_edges", t.boundary_edges},
          {"nonmanifold_edges", t.nonmanifold_edges},
          {"nonmanifold_vertices", t.nonmanifold_vertices},
          {"duplicate_triangles", t.duplicate_triangles},
          {"orientable", t.orientable},
          {"consistently_oriented", t.consistently_oriented},
          {"euler_characteristic", t.euler_characteristic},
          {"genus", t.genus},
          {"signed_volume", t.signed_volume},
          {"where", t.where}};
}

Json certificate_json(const sphere::Certificate& c) {
  return {{"valid", c.valid},
          {"closed", c.closed},
          {"manifold", c.manifold},
          {"connected", c.connected},
          {"euler_characteristic", c.euler_characteristic},
          {"triangles", c.triangles},
          {"vertices", c.vertices},
          {"folded", c.folded},
          {"off_grid", c.off_grid},
          {"max_radius_error", c.max_radius_error},
          {"degree", c.degree}};
}

Json atlas_certificate_json(const texture::AtlasCertificate& c) {
  return {{"valid", c.valid},
          {"triangles", c.triangles},
          {"charts", c.charts},
          {"off_grid", c.off_grid},
          {"folded", c.folded},
          {"outside", c.outside},
          {"too_close", c.too_close},
          {"closed_charts", c.closed_charts},
          {"not_filled", c.not_filled},
          {"open_charts", c.open_charts},
          {"shared_texels", c.shared_texels}};
}

Json distortion_json(const sphere::Distortion& d) {
  return {{"quasi_conformal_mean", d.quasi_conformal_mean},
          {"quasi_conformal_p99", d.quasi_conformal_p99},
          {"log_area_deviation", d.log_area_deviation},
          {"symmetric_dirichlet", d.symmetric_dirichlet},
          {"l2_stretch", d.l2_stretch},
          {"smallest_area", d.smallest_area},
          {"needles", d.needles}};
}

Json repairs_json(const Repairs& r) {
  return {{"degenerate_triangles", r.degenerate_triangles},
          {"duplicate_triangles", r.duplicate_triangles},
          {"turned_triangles", r.turned_triangles},
          {"shared_edges", r.shared_edges},
          {"double_edges", r.double_edges},
          {"split_vertices", r.split_vertices},
          {"one_sided_edges", r.one_sided_edges},
          {"crack_triangles", r.crack_triangles},
          {"internal_triangles", r.internal_triangles},
          {"capped_loops", r.capped_loops},
          {"handles", r.handles},
          {"handle_cut_edges", r.handle_cut_edges},
          {"handle_cut_length", r.handle_cut_length}};
}

Json component_json(const ComponentReport& c) {
  Json out{{"mesh", c.mesh},
           {"triangles", c.triangles},
           {"vertices", c.vertices},
           {"genus", c.genus},
           {"boundary_loops", c.boundary_loops},
           {"boundary_edges", c.boundary_edges},
           {"turned_triangles", c.turned_triangles},
           {"crack_triangles", c.crack_triangles},
           {"cap_triangles", c.cap_triangles},
           {"handles", c.handles},
           {"handle_cut_edges", c.handle_cut_edges},
           {"handle_cut_length", c.handle_cut_length},
           {"symmetric_dirichlet", c.distortion.symmetric_dirichlet},
           {"quasi_conformal_mean", c.distortion.quasi_conformal_mean},
           {"remesh_triangles", c.remesh_triangles},
           {"certified", c.certified},
           {"problem", nullptr}};
  if (c.problem) {
    out["problem"] = {{"code", c.problem->code}, {"message", c.problem->message}, {"where", c.problem->where}};
  }
  return out;
}

// The table is cut at most_components: those with a problem come first, then the largest.
Json components_json(const std::vector<ComponentReport>& components) {
  std::vector<const ComponentReport*> shown;
  shown.reserve(components.size());
  for (const ComponentReport& c : components) shown.push_back(&c);
  if (shown.size() > most_components) {
    std::ranges::stable_sort(shown, [](const ComponentReport* a, const ComponentReport* b) {
      if (a->problem.has_value() != b->problem.has_value()) return a->problem.has_value();
      return a->triangles > b->triangles;
    });
    shown.resize(most_components);
  }
  Json out = Json::array();
  for (const ComponentReport* c : shown) out.push_back(component_json(*c));
  return out;
}

Json atlas_json(const Report::Atlas& a) {
  Json pages = Json::array();
  for (const Report::Atlas::Page& page : a.pages) pages.push_back({{"width", page.width}, {"height", page.height}});
  return {{"pages", std::move(pages)},
          {"gutter", a.gutter},
          {"charts", a.charts},
          {"cut_triangles", a.cut_triangles},
          {"added_vertices", a.added_vertices},
          {"utilisation", a.utilisation},
          {"seam_length", a.quality.seam_length},
          {"texels_per_area", a.quality.texels_per_area},
          {"density_min", a.quality.density_min},
          {"density_p1", a.quality.density_p1},
          {"density_median", a.quality.density_median},
          {"l2_stretch", a.quality.l2_stretch},
          {"source", a.source}};
}

Json level_json(const Report::Level& level) {
  return {{"target", level.target},
          {"triangles", level.triangles},
          {"vertices", level.vertices},
          {"mean_distance", level.mean_distance},
          {"mean_distance_from_full", level.mean_distance_from_full},
          {"hausdorff_distance", level.hausdorff_distance},
          {"texture_deviation", level.texture_deviation},
          {"texture_deviation_max", level.texture_deviation_max},
          {"outside", level.outside},
          {"psnr", level.psnr},
          {"screen_coverage", level.screen_coverage},
          {"folded", level.folded},
          {"degree", level.degree},
          {"turned_normals", level.turned_normals},
          {"reached", level.reached},
          {"outline_texels", level.outline_texels},
          {"torn_edges", level.torn_edges},
          {"opened_points", level.opened_points},
          {"lost_components", level.lost_components},
          {"lost_size", level.lost_size}};
}

Json remesh_json(const std::optional<Report::Remesh>& r) {
  if (!r) return nullptr;
  return {{"components", r->components},
          {"kept_components", r->kept_components},
          {"triangles", r->triangles},
          {"vertices", r->vertices},
          {"mean_distance", r->mean_distance},
          {"mean_distance_from_input", r->mean_distance_from_input},
          {"hausdorff_distance", r->hausdorff_distance}};
}

Json morph_json(const std::optional<Report::Morph>& m) {
  if (!m) return nullptr;
  return {{"format", m->format},
          {"input_triangles", m->input_triangles},
          {"mean_distance", m->mean_distance},
          {"mean_distance_from_input", m->mean_distance_from_input},
          {"hausdorff_distance", m->hausdorff_distance},
          {"features", m->features},
          {"mean_angle_before", m->mean_angle_before},
          {"mean_angle", m->mean_angle},
          {"largest_angle", m->largest_angle}};
}

Json vector_json(const Vec3d& v) { return {v.x, v.y, v.z}; }

Json map_json(const Report::BakedMap& m) {
  Json json{{"name", m.name},     {"page", m.page}, {"width", m.width},
            {"height", m.height}, {"bits", m.bits}, {"bytes", m.bytes}};
  if (m.range) {
    json["offset"] = vector_json(m.range->offset);
    json["scale"] = vector_json(m.range->scale);
  }
  return json;
}

Timing timing_of(const Report& report) {
  Timing timing;
  double wall = 0, cpu = 0;
  for (const StageTime& stage : report.stages) {
    timing.stages.push_back({std::string(name_of(stage.stage)), stage.wall_ms, stage.cpu_ms});
    wall += stage.wall_ms;
    cpu += stage.cpu_ms;
  }
  timing.wall_ms = wall;
  timing.cpu_ms = cpu;
  timing.peak_rss_bytes = report.peak_rss_bytes;
  return timing;
}

} // namespace

Json to_json(const Report& report) {
  Json notes = Json::array();
  for (const Note& note : report.notes) {
    notes.push_back({{"code", note.code}, {"message", note.message}, {"where", note.where}});
  }
  Json levels = Json::array();
  for (const Report::Level& level : report.levels) levels.push_back(level_json(level));
  Json maps = Json::array();
  for (const Report::BakedMap& map : report.maps) maps.push_back(map_json(map));
  return {{"version", ORBIS_VERSION},
          {"format", report.format},
          {"options", to_json(report.options)},
          {"input", {{"triangles", report.input_triangles}, {"vertices", report.input_vertices}}},
          {"topology", topology_json(report.topology)},
          {"partial", report.partial},
          {"repairs", repairs_json(report.repairs)},
          {"components", components_json(report.components)},
          {"components_total", report.components.size()},
          {"embedding",
           {{"t1_ms", report.t1_ms},
            {"t2_ms", report.t2_ms},
            {"t3_ms", report.t3_ms},
            {"minimum", report.minimum},
            {"relaxations", report.relaxations},
            {"converged", report.converged}}},
          {"distortion", distortion_json(report.distortion)},
          {"atlas", atlas_json(report.atlas)},
          {"levels", std::move(levels)},
          {"remesh", remesh_json(report.remesh)},
          {"morph", morph_json(report.morph)},
          {"maps", std::move(maps)},
          {"output", {{"triangles", report.output_triangles}, {"vertices", report.output_vertices}}},
          {"certificate", certificate_json(report.certificate)},
          {"cut_certificate", certificate_json(report.cut_certificate)},
          {"atlas_certificate", atlas_certificate_json(report.atlas_certificate)},
          {"timing", to_json(timing_of(report))},
          {"notes", std::move(notes)}};
}

} // namespace orbis::api
