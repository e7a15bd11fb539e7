#include "core/steps/archive.h"

#include <nlohmann/json.hpp>
#include <string>

#include "core/asset/write_zip.h"
#include "core/steps/summary.h"
#include "core/version.h"

namespace orbis {
namespace {

using Json = nlohmann::ordered_json;

Json entry_of(const Report::Level& level, const std::string& file) {
  return {{"file", file},
          {"target", level.target},
          {"triangles", level.triangles},
          {"vertices", level.vertices},
          {"mean_distance", level.mean_distance},
          {"hausdorff_distance", level.hausdorff_distance},
          {"texture_deviation", level.texture_deviation},
          {"psnr", level.psnr},
          {"screen_coverage", level.screen_coverage}};
}

asset::Bytes bytes_of(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

// In the result a level's materials are the full surface's with some textures changed; alone it must name them all.
std::vector<asset::NewPrimitive> with_textures_of(const Delivery& full, const DetailLevel& level) {
  std::vector<asset::NewPrimitive> out = level.delivery.primitives;
  for (std::size_t p = 0; p < out.size(); ++p) {
    const asset::NewPrimitive& shown = full.primitives[p];
    out[p].textures.insert(shown.textures.begin(), shown.textures.end());
    out[p].plain_base_color = shown.plain_base_color;
    out[p].is_gone = out[p].indices.empty() && !shown.indices.empty();
  }
  return out;
}

} // namespace

std::vector<std::byte> archive_of(std::vector<std::byte> model, const asset::Asset& asset, const Surface& surface,
                                  const Delivery& full, std::span<const DetailLevel> levels,
                                  std::span<const asset::NewImage> atlas, const Report& report) {
  Json manifest{{"version", version},
                {"model",
                 {{"file", "model.glb"},
                  {"triangles", report.output_triangles},
                  {"vertices", report.output_vertices},
                  {"levels", "MSFT_lod"}}},
                {"lengths", "per cent of the model's diagonal"},
                {"levels", Json::array()}};
  std::vector<asset::ZipMember> members;
  members.push_back({"model.glb", std::move(model)});
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const std::string file = "lod" + std::to_string(i + 1) + ".glb";
    members.push_back({file, asset::write_asset(asset, with_textures_of(full, levels[i]), atlas, extras_of(report),
                                                report.options.compression)});
    certify_level_file(members.back().bytes, asset, surface, levels[i], i);
    manifest["levels"].push_back(entry_of(report.levels[i], file));
  }
  members.push_back({"manifest.json", bytes_of(manifest.dump(2) + "\n")});
  return asset::write_zip(members);
}

} // namespace orbis
