#include "core/steps/unfold_and_cut.h"

#include <array>
#include <cmath>
#include <string>

#include "core/sphere/canonical_turn.h"
#include "core/sphere/embedding.h"
#include "core/sphere/snap.h"

namespace orbis {
namespace {

constexpr int most_turns = 8;
constexpr double turn_angle = 0.02; // radians: about a hundred texels of a usual atlas

// Rodrigues' rotation about an axis that is in no special position to the cube.
Vec3d turned(const Vec3d& p, double angle) {
  const Vec3d axis = normalized(Vec3d{0.35, 0.57, 0.74});
  const double c = std::cos(angle), s = std::sin(angle);
  return c * p + s * cross(axis, p) + (1 - c) * dot(axis, p) * axis;
}

} // namespace

std::vector<Vec3d> embed(const Surface& surface, const Options& options, Progress& progress, Report& report) {
  sphere::Embedding embedding = options.objective == Objective::shape_preserving
                                    ? sphere::embed_shape_preserving(surface.mesh, options.threshold, progress)
                                    : sphere::embed_isometric(surface.mesh, options.quality, options.threads, progress);
  report.t1_ms = embedding.t1_ms;
  report.t2_ms = embedding.t2_ms;
  report.t3_ms = embedding.t3_ms;
  report.relaxations = embedding.relaxations;
  report.converged = embedding.converged;
  report.minimum = sphere::shape_preserving_energy(surface.mesh, embedding.points);
  if (!embedding.converged) {
    report.notes.push_back({"not-converged",
                            "the bound on the work was reached while moves still paid: the map is valid, but could be "
                            "better",
                            ""});
  }
  return sphere::canonically_turned(surface.mesh, std::move(embedding.points));
}

CutSphere snap_and_cut(const Surface& surface, std::span<const Vec3d> points, const texture::AtlasLayout& layout,
                       Progress& progress, Report& report) {
  std::string failure;
  std::vector<Vec3d> rotated(points.begin(), points.end());
  for (int turn = 0; turn < most_turns; ++turn) {
    for (std::size_t v = 0; turn > 0 && v < points.size(); ++v) rotated[v] = turned(points[v], turn * turn_angle);
    sphere::Snapped snapped = sphere::snap(rotated, surface.mesh.triangles);
    if (snapped.folded > 0) {
      failure = std::to_string(snapped.folded) + " triangles are too small for the numbers of the result";
      continue;
    }
    try {
      CutSphere out{std::move(snapped.points), {}};
      out.cut = texture::cut(surface.mesh.triangles, surface.corners, out.points, layout, progress);
      if (turn > 0) {
        report.notes.push_back({"turned-sphere",
                                "the sphere was turned by " + std::to_string(turn * turn_angle) +
                                    " radians to keep every triangle resolvable",
                                ""});
      }
      return out;
    } catch (const Error& e) {
      if (e.code() != ErrorCode::not_certified) throw;
      failure = e.message();
    }
  }
  throw Error(ErrorCode::not_certified, "the map could not be delivered without a fold: " + failure);
}

} // namespace orbis
