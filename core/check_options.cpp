#include "core/check_options.h"

#include <algorithm>
#include <array>
#include <string>

#include "core/error.h"

namespace orbis {
namespace {

constexpr std::array<std::string_view, 6> cube_faces{"px", "nx", "py", "ny", "pz", "nz"};
constexpr std::string_view equirectangular = "equirectangular";

std::string_view without_ending(std::string_view name) { return name.substr(0, name.rfind('.')); }

void check_morph(const Options& options, std::span<const std::string_view> files) {
  if (options.morph_to.empty()) {
    if (options.features.empty()) return;
    throw Error(ErrorCode::invalid_option,
                "features are points of two models, and there is no second one: see morph_to", "features");
  }
  if (options.sphere_morph)
    throw Error(ErrorCode::invalid_option, "a morph to a second model cannot have the target of sphere_morph beside it",
                "sphere_morph");
  if (std::ranges::find(files, options.morph_to) == files.end())
    throw Error(ErrorCode::missing_resource,
                "the second model, '" + options.morph_to + "', did not come with the request", "morph_to");
}

} // namespace

std::vector<std::string_view> cube_map_files(std::span<const std::string_view> files) {
  const auto find = [&](std::string_view stem) { return std::ranges::find(files, stem, without_ending); };
  if (const auto whole = find(equirectangular); whole != files.end()) return {*whole};
  std::vector<std::string_view> out;
  for (const std::string_view face : cube_faces) {
    const auto file = find(face);
    if (file == files.end())
      throw Error(ErrorCode::missing_resource,
                  "texture=cubemap takes six images named px, nx, py, ny, pz, nz, or one named equirectangular (any "
                  "ending); '" +
                      std::string(face) + "' did not come with the request",
                  "texture");
    out.push_back(*file);
  }
  return out;
}

void check_options(const Options& options, std::span<const std::string_view> files) {
  if (options.texture == TextureSource::cubemap) (void)cube_map_files(files);
  check_morph(options, files);
}

} // namespace orbis
