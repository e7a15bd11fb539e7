#include "core/steps/levels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <future>
#include <string>

#include "core/lod/distance.h"
#include "core/lod/full_surface.h"

namespace orbis {
namespace {

std::vector<lod::Target> targets_of(const Options& options, const Surface& surface) {
  std::vector<lod::Target> targets;
  std::uint64_t delivered = 0;
  for (const Component& c : surface.components) delivered += c.input_triangles;
  for (const LodTarget& target : options.lods) {
    if (target.kind == LodTarget::Kind::deviation) {
      targets.push_back({0, target.value / 100});
    } else {
      const double count =
          target.kind == LodTarget::Kind::ratio ? target.value * static_cast<double>(delivered) : target.value;
      // Four triangles are the fewest that close a surface.
      targets.push_back({std::max<std::uint64_t>(4, static_cast<std::uint64_t>(count)), 0});
    }
  }
  return targets;
}

// The part of the screen's height at which what is off by the level's mean deviation is off by half a pixel on a screen
// of 1080 rows; 1 where it is less all over the screen.
double coverage_of(double deviation) {
  constexpr double rows = 1080, pixels = 0.5;
  return deviation > 0 ? std::min(1.0, pixels / (rows * deviation)) : 1.0;
}

void measure(const lod::Ruler& ruler, const lod::Level& level, Report::Level& out) {
  const lod::Distances distances = ruler.distances(level);
  const lod::TextureDeviation deviation = ruler.texture_deviation(level);
  out.triangles = level.mesh.triangles.size();
  out.mean_distance = 100 * distances.to_full;
  out.mean_distance_from_full = 100 * distances.from_full;
  out.hausdorff_distance = 100 * distances.hausdorff;
  out.texture_deviation = 100 * deviation.mean;
  out.texture_deviation_max = 100 * deviation.largest;
  out.outside = 100 * deviation.outside;
}

// What a target cost, in words.
void note_concessions(const Report::Level& level, const std::string& where, Report& report) {
  const auto note = [&](const char* code, const std::string& message) {
    report.notes.push_back({code, message, where});
  };
  const auto rounded = [](double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.3g", value);
    return std::string(text.data());
  };
  if (level.turned_normals)
    note("lod-turned-normals", "some triangles were allowed to turn by more than 80 degrees at once");
  if (level.outline_texels > 0)
    note("lod-outline", "seams left their lines in the atlas by up to " + rounded(level.outline_texels) +
                            " texels: along them one material shows the other's texels");
  if (level.torn_edges > 0)
    note("lod-torn", std::to_string(level.torn_edges) +
                         " edges were torn in the atlas, where to keep them whole would have cost much of the shape: "
                         "the texture may show a step there");
  if (level.opened_points > 0)
    note("lod-opened-cuts", std::to_string(level.opened_points) +
                                " points of a cut's rim had to go while the other rim kept theirs: a gap may show");
  if (level.lost_components > 0)
    note("lod-lost-components",
         std::to_string(level.lost_components) +
             " components had to be left out, the smallest first; the largest of them measures " +
             rounded(level.lost_size) + " % of the model's diagonal");
  if (level.reached) return;
  if (level.target.starts_with("deviation:"))
    note("lod-short", "the level before it is coarser than this one was to be, and levels only get coarser");
  else
    note("lod-short", "the level has " + std::to_string(level.triangles) +
                          " triangles, more than asked for: no edge is left that can be collapsed");
}

// The positions that were fitted take the place of those on the full surface.
void place(const lod::Level& level, Delivery& delivery) {
  for (std::size_t p = 0; p < delivery.primitives.size(); ++p) {
    for (asset::Attribute& attribute : delivery.primitives[p].attributes) {
      if (attribute.name != "POSITION") continue;
      attribute.type = asset::ComponentType::f32;
      attribute.normalized = false;
      attribute.data.assign(delivery.sources[p].size() * sizeof(Vec3f), std::byte{});
    }
  }
  const auto position_of = [](asset::NewPrimitive& primitive) -> asset::Attribute& {
    return *std::find_if(primitive.attributes.begin(), primitive.attributes.end(),
                         [](const asset::Attribute& a) { return a.name == "POSITION"; });
  };
  for (std::size_t v = 0; v < level.positions.size(); ++v) {
    const OutputVertex o = delivery.of_cut_vertex[v];
    asset::Attribute& position = position_of(delivery.primitives[o.primitive]);
    const Vec3f& at = level.positions[v];
    position.set(o.vertex, 0, double{at.x});
    position.set(o.vertex, 1, double{at.y});
    position.set(o.vertex, 2, double{at.z});
  }
}

std::uint32_t widest_page(const texture::CutMesh& cut) {
  std::uint32_t widest = 1;
  for (const texture::Page& page : cut.pages) widest = std::max(widest, page.width);
  return widest;
}

std::string name_of_target(const Options& options, std::size_t i) {
  Options one;
  one.lods = {options.lods[i]};
  return get_option(one, "lods");
}

} // namespace

std::vector<DetailLevel> make_levels(const asset::Asset& asset, const Surface& surface, const texture::CutMesh& cut,
                                     Progress& progress, Report& report) {
  std::vector<DetailLevel> out;
  if (report.options.lods.empty()) return out;
  const lod::FullSurface full(surface.mesh, surface.primitive_of, cut);
  mesh::ThreadPool threads(report.options.threads);
  // The ruler has its tree by the time when there is something to measure.
  std::future<lod::Ruler> made = std::async(threads.beside(), [&full, &threads] { return lod::Ruler(full, threads); });
  std::vector<lod::Level> levels = lod::simplify(full, targets_of(report.options, surface), threads, progress);
  const lod::Ruler ruler = made.get();
  double coverage = 1;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    progress.check();
    Report::Level& facts = report.levels.emplace_back();
    facts.target = name_of_target(report.options, i);
    measure(ruler, levels[i], facts);
    // Where surface is missing, no texel of the level is in a wrong place.
    const double off = std::max(facts.texture_deviation, facts.mean_distance_from_full) / 100;
    facts.screen_coverage = coverage = std::min(coverage, coverage_of(off));
    const lod::Concessions& c = levels[i].concessions;
    facts.turned_normals = c.turned_normals;
    facts.outline_texels = c.outline * widest_page(cut);
    facts.torn_edges = c.torn;
    facts.opened_points = c.opened;
    facts.lost_components = c.lost_components;
    facts.lost_size = 100 * c.largest_lost;
    facts.reached = !c.is_short;
    note_concessions(facts, "/levels/" + std::to_string(i), report);

    out.push_back({std::move(levels[i]), {}});
    DetailLevel& level = out.back();
    level.delivery = make_delivery(asset, surface, level.level.mesh, RiderPolicy::leave_out);
    place(level.level, level.delivery);
    for (const auto& sources : level.delivery.sources) facts.vertices += sources.size();
  }
  progress.report(Stage::levels, cut.triangles.size(), cut.triangles.size());
  return out;
}

void quantise(Delivery& full, std::span<DetailLevel> levels) {
  for (asset::NewPrimitive& primitive : full.primitives) asset::quantise_directions(primitive);
  for (DetailLevel& level : levels)
    for (asset::NewPrimitive& primitive : level.delivery.primitives) asset::quantise_directions(primitive);
}

std::vector<asset::NewLevel> in_asset(std::span<const DetailLevel> levels, const Report& report) {
  std::vector<asset::NewLevel> out;
  for (std::size_t i = 0; i < levels.size(); ++i)
    out.push_back({levels[i].delivery.primitives, report.levels[i].screen_coverage});
  return out;
}

} // namespace orbis
