#include "core/steps/repair_notes.h"

#include <array>
#include <cstdio>
#include <string>

namespace orbis {
namespace {

std::string counted(std::uint64_t n, const std::string& what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.4g", value);
  return text.data();
}

// A model of this many components, most of them single triangles, was probably not meant to be so.
constexpr std::uint64_t many_single_triangles = 100;

} // namespace

void note_repairs(std::uint64_t unused_vertices, Report& report) {
  const Repairs& r = report.repairs;
  const auto note = [&](std::uint64_t count, const char* code, const std::string& message) {
    if (count > 0) report.notes.push_back({code, message, ""});
  };
  note(
      r.degenerate_triangles, "degenerate-triangles",
      counted(r.degenerate_triangles, "triangle") +
          " without area, two of the corners at one position: delivered, but no part of the surface that is certified");
  note(r.duplicate_triangles, "duplicate-triangles",
       counted(r.duplicate_triangles, "triangle") +
           " on top of another one of the same material: delivered with its coordinates, not certified a second time");
  note(r.turned_triangles, "turned-triangles",
       counted(r.turned_triangles, "triangle") + " turned to agree with the neighbours");
  note(r.shared_edges, "nonmanifold-edges",
       counted(r.shared_edges, "edge") + " of three triangles or more: the sheets were taken apart there");
  note(r.double_edges, "double-edges",
       counted(r.double_edges, "edge") + " between the same two vertices as another edge: cut apart");
  note(r.one_sided_edges, "one-sided",
       "the surface has only one side (a Moebius strip lies in it): cut along " + counted(r.one_sided_edges, "edge"));
  note(r.crack_triangles, "t-junctions",
       counted(r.crack_triangles, "T-junction") + " closed for the parametrization; nothing was added to the model");
  note(r.internal_triangles, "internal-faces",
       counted(r.internal_triangles, "triangle") + " of walls inside a body: kept, and parametrized like the rest");
  note(r.handles, "handles-cut",
       counted(r.handles, "handle") + " cut open along " + counted(r.handle_cut_edges, "edge") + ", " +
           number(r.handle_cut_length) + " units long in all: each is a pair of seams");
  note(r.capped_loops, "holes-capped",
       counted(r.capped_loops, "boundary loop") +
           " closed for the parametrization, those of cuts included; nothing was added to the model");
  note(unused_vertices, "unused-vertices",
       counted(unused_vertices, "unused vertex") + " left out: no triangle uses it");
  if (report.topology.signed_volume < 0 && report.topology.is_sphere() && r.turned_triangles == 0) {
    report.notes.push_back({"inside-out", "the surface is inside out and was kept so: its triangles face inward", ""});
  }
  std::uint64_t single = 0;
  for (const ComponentReport& c : report.components) single += c.triangles == 1 ? 1 : 0;
  if (single >= many_single_triangles && report.options.weld_tolerance == 0) {
    report.notes.push_back({"not-connected",
                            std::to_string(single) + " triangles touch no other one: if they should, their vertices "
                                                     "differ a little, and weld_tolerance joins them",
                            ""});
  }
}

} // namespace orbis
