#include "core/steps/summary.h"

#include <nlohmann/json.hpp>

#include "core/version.h"

namespace orbis {
namespace {

struct Certified {
  std::uint64_t components = 0, vertices = 0, triangles = 0;
};

Certified certified_in(const Report& report) {
  Certified out;
  for (const ComponentReport& c : report.components) {
    if (c.problem) continue;
    ++out.components;
    out.vertices += c.remesh_vertices > 0 ? c.remesh_vertices : c.vertices;
    out.triangles += c.remesh_triangles > 0 ? c.remesh_triangles : c.triangles;
  }
  return out;
}

} // namespace

void describe_input(const asset::Asset& asset, Report& report) {
  report.format = name_of(asset.format);
  for (const auto& note : asset.notes) report.notes.push_back({note.code, note.message, note.where});
}

std::string extras_of(const Report& report) {
  nlohmann::ordered_json options;
  for (const OptionInfo& info : option_table()) {
    // The number of threads changes nothing in the result.
    if (info.name != "threads") options[std::string(info.name)] = get_option(report.options, info.name);
  }
  // The certificate is made on the finished file, so the file states what is certified; a file that fails is not
  // delivered.
  const Certified certified = certified_in(report);
  const nlohmann::ordered_json extras{
      {"version", version},
      {"options", options},
      {"certificate",
       {{"statement",
         "each component, its holes capped: closed, connected, Euler characteristic 2; every triangle of _SPHERE "
         "positively oriented, decided exactly; degree 1: the map is a homeomorphism onto the sphere"},
        {"components", certified.components},
        {"vertices", certified.vertices},
        {"triangles", certified.triangles},
        {"grid", "multiples of 2^-24"}}},
      {"distortion",
       {{"symmetric_dirichlet", report.distortion.symmetric_dirichlet},
        {"l2_stretch", report.distortion.l2_stretch},
        {"quasi_conformal_mean", report.distortion.quasi_conformal_mean}}}};
  return extras.dump();
}

} // namespace orbis
