#include "core/steps/remesh_plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include "core/remesh/polyhedron.h"
#include "core/steps/measure.h"

namespace orbis {
namespace {

// Why a component keeps its triangles; empty where it need not.
std::string reason_to_keep(const Surface& surface, const Component& c) {
  if (c.has_caps()) return "it has holes, handles or cracks, so that parts of its sphere stand for no surface";
  for (std::uint32_t t = c.first_triangle; t < c.end_triangle(); ++t) {
    if (surface.primitive_of[t] != surface.primitive_of[c.first_triangle])
      return "its triangles belong to several primitives";
  }
  return {};
}

[[noreturn]] void refuse(const std::string& reason) {
  throw Error(ErrorCode::not_genus_zero,
              "no component can be remeshed: " + reason + "; closed components of genus 0 of one primitive can",
              "remesh");
}

// As many divisions as make triangles about as large as those of the largest component, of whose area this is a part.
std::uint32_t times_for(double part, const RemeshTarget& target) {
  const double fewer = std::round(-std::log2(part) / 2);
  return static_cast<std::uint32_t>(std::max(1.0, target.times - fewer));
}

void check_size(const RemeshPlan& plan, const RemeshTarget& target, const Limits& limits) {
  std::uint64_t triangles = 0;
  for (const std::uint32_t times : plan.times)
    if (times > 0) triangles += remesh::triangles_of(target.base, times);
  if (triangles <= limits.max_triangles) return;
  throw Error(ErrorCode::too_large,
              "the remesh would have " + std::to_string(triangles) + " triangles; the limit is " +
                  std::to_string(limits.max_triangles),
              "remesh");
}

} // namespace

RemeshPlan plan_remesh(const Surface& surface, const RemeshTarget& target, const Limits& limits) {
  RemeshPlan plan;
  if (target.base == RemeshTarget::Base::none) return plan;
  std::map<std::string, std::pair<std::uint64_t, std::uint32_t>> kept; // reason -> components, mesh of the first
  double largest = 0;
  std::vector<double> areas;
  for (const Component& c : surface.components) {
    const std::string reason = reason_to_keep(surface, c);
    if (!reason.empty()) ++kept.try_emplace(reason, 0, c.mesh).first->second.first;
    areas.push_back(reason.empty() ? area_of(mesh_of(surface, c)) : 0);
    largest = std::max(largest, areas.back());
  }
  if (!(largest > 0)) refuse(kept.empty() ? "it has no area" : kept.begin()->first);
  for (const auto& [reason, found] : kept) {
    plan.kept.push_back({"remesh-kept", std::to_string(found.first) + " components kept their triangles: " + reason,
                         "/meshes/" + std::to_string(found.second)});
  }
  for (const double area : areas) plan.times.push_back(area > 0 ? times_for(area / largest, target) : 0);
  check_size(plan, target, limits);
  return plan;
}

} // namespace orbis
