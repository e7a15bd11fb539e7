// What a caller may ask for. One name everywhere: JSON "texture_size", query ?texture_size=, command line
// --texture-size.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec3.h"

namespace orbis {

enum class Objective { isometric, conformal, stretch, shape_preserving };
enum class Quality { draft, standard, high };
enum class TextureSource { automatic, pattern, cubemap, base_color };
enum class AtlasPages { per_material, single };
enum class TextureFormat { png, jpeg, webp };
enum class Compression { none, draco, meshopt, quantized };
enum class TopologyPolicy { repair, strict };
enum class OutputForm { glb, zip };

// When a level of detail is coarse enough.
struct LodTarget {
  enum class Kind { triangles, ratio, deviation } kind = Kind::ratio;
  // Triangles at most; or as a part of the surface's; or the texture deviation allowed, in per cent of the diagonal.
  double value = 0;
  friend bool operator==(const LodTarget&, const LodTarget&) = default;
};
inline constexpr std::size_t most_lods = 8;

// A semi-regular triangulation: a regular polyhedron whose triangles are divided into four, `times` times.
struct RemeshTarget {
  enum class Base { none, octahedral, icosahedral } base = Base::none; // none: the input's own triangles
  std::uint32_t times = 0;
  friend bool operator==(const RemeshTarget&, const RemeshTarget&) = default;
};
inline constexpr std::uint32_t most_remesh_times = 8;

// A point near the first model's surface, and the one near the second's that it should become.
struct FeaturePair {
  Vec3d from, to; // in each model's own units, before node transforms
  friend bool operator==(const FeaturePair&, const FeaturePair&) = default;
};
inline constexpr std::size_t most_features = 256;

// What can be baked into the atlas. The first five take the place of the materials' textures.
enum class Map : std::uint8_t {
  base_color,
  metallic_roughness,
  occlusion,
  emissive,
  normal,        // tangent space
  object_normal, // in the space of POSITION
  ambient_occlusion,
  position,    // a geometry image
  displacement // of the full surface from each level of detail
};
inline constexpr std::array<std::string_view, 9> map_names{
    "base_color",    "metallic_roughness", "occlusion", "emissive",    "normal",
    "object_normal", "ambient_occlusion",  "position",  "displacement"};
constexpr std::string_view name_of(Map map) { return map_names[static_cast<std::size_t>(map)]; }

struct MapSelection {
  bool automatic = true; // the base colour, and every texture that the input's materials have
  std::array<bool, map_names.size()> named{};

  [[nodiscard]] bool names(Map map) const { return named[static_cast<std::size_t>(map)]; }
  friend bool operator==(const MapSelection&, const MapSelection&) = default;
};

struct Options {
  // repair: whatever has triangles is parametrized, cut and capped where it must be; strict: anything but one closed
  // component of genus 0 is refused.
  TopologyPolicy topology = TopologyPolicy::repair;
  double weld_tolerance = 0; // vertices no farther apart are one, in the model's units before node transforms; 0: exact
  Objective objective = Objective::isometric;
  // isometric only: 1 weighs areas as much as angles, 0 is conformal; in [0, 1].
  double area_weight = 1;
  // All but shape-preserving: how close to the least energy the map is brought.
  Quality quality = Quality::standard;
  // shape-preserving only: relaxation stops when the best local improvement ds(p*)/ds(p) is above this (paper: 0.995).
  double threshold = 0.995;
  // automatic: the model's own base colour where it has one that came with the request, else the test pattern.
  TextureSource texture = TextureSource::automatic;
  std::uint32_t texture_size = 2048; // width of the largest page in texels, 64 to 8192
  // Texels per unit of length, before node transforms, where that decides in texture_size's place; 0: it does not.
  double texel_density = 0;
  // per_material: each material keeps an image of its own, as in the input, so that its factors, alpha mode and
  // samplers go on meaning what they meant and what is not drawn need not be loaded. single: one image for the file.
  AtlasPages atlas = AtlasPages::per_material;
  TextureFormat texture_format = TextureFormat::png;
  std::uint32_t jpeg_quality = 90; // 1 to 100; WebP's too
  MapSelection maps;
  std::uint32_t normal_bits = 8; // 8 or 16 a channel, of the normal maps
  // draco, meshopt: without loss. quantized: normals and tangents in 16 bits a component, and meshopt.
  Compression compression = Compression::none;
  OutputForm output = OutputForm::glb; // zip: each level as a file of its own too, with a manifest
  std::vector<LodTarget> lods;         // levels of detail beside the full surface, from fine to coarse
  RemeshTarget remesh;                 // of the largest component; smaller ones get triangles of about the same size
  bool sphere_morph = false;           // a morph target that takes each component to its sphere
  // The name of the file with a second model, which the first one is to become; "" for none.
  std::string morph_to;
  std::vector<FeaturePair> features; // with morph_to: what is to meet
  std::uint32_t threads = 0;         // 0: as many as the machine has; the result does not depend on it
};

// One row per option: its name, the values it takes (for people), its default, and what it does.
struct OptionInfo {
  std::string_view name, values, fallback, summary;
};
[[nodiscard]] std::span<const OptionInfo> option_table();

// Sets one option from its text form. Throws Error{invalid_option} that names the option, the value and what is
// allowed.
void set_option(Options& options, std::string_view name, std::string_view value);
// The text form of one option, as set_option takes it. Throws Error{invalid_option} for an unknown name.
[[nodiscard]] std::string get_option(const Options& options, std::string_view name);

// Limits that the operator sets, not the caller. Exceeding one throws Error{too_large} that names it and its value.
struct Limits {
  std::uint64_t max_bytes = 256ull << 20;       // the request's body
  std::uint64_t max_triangles = 12'000'000;     // in the asset
  std::uint64_t max_vertices = 24'000'000;      // in the asset, before welding
  std::uint64_t max_image_pixels = 64ull << 20; // per image
  std::uint32_t max_json_depth = 64;            // nesting of a glTF's JSON
};

} // namespace orbis
