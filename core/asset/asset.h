// A model as orbis sees it: the triangle primitives as typed arrays, and around them the whole document, untouched.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/model_format.h"
#include "core/options.h"
#include "core/vec3.h"

namespace orbis::asset {

using Bytes = std::vector<std::byte>;
// Files that came with the request (multipart parts), by the name that a glTF's URI gives.
using Attachments = std::map<std::string, Bytes, std::less<>>;

// glTF component types, with glTF's own codes.
enum class ComponentType : std::uint16_t { i8 = 5120, u8 = 5121, i16 = 5122, u16 = 5123, u32 = 5125, f32 = 5126 };
[[nodiscard]] std::size_t size_of(ComponentType type);

// One vertex attribute in its original component type, tightly packed: count * components values, so that what is
// not touched is delivered to the bit.
struct Attribute {
  std::string name; // "POSITION", "NORMAL", "TEXCOORD_0", "JOINTS_0", "_CUSTOM", …
  ComponentType type = ComponentType::f32;
  bool normalized = false;
  std::uint32_t components = 3; // 1 to 4 (SCALAR, VEC2, VEC3, VEC4)
  Bytes data;

  // NOLINTNEXTLINE(clang-analyzer-core.DivideZero): components is never 0
  [[nodiscard]] std::size_t count() const { return data.size() / (components * size_of(type)); }
  // Component c of vertex v as a number: normalized integers as glTF 2.0 section 3.6.2.2 says, others as they are.
  [[nodiscard]] double get(std::size_t v, std::uint32_t c) const;
  // The inverse: rounds and clamps to the component type.
  void set(std::size_t v, std::uint32_t c, double value);
};

// The first three components of vertex v.
[[nodiscard]] inline Vec3d vector_at(const Attribute& attribute, std::size_t v) {
  return {attribute.get(v, 0), attribute.get(v, 1), attribute.get(v, 2)};
}

// One triangle primitive (mode 4, 5 or 6 in the input; here always a triangle list, always indexed).
struct Primitive {
  std::uint32_t mesh = 0, primitive = 0;       // its place in the document: /meshes/mesh/primitives/primitive
  std::vector<std::uint32_t> indices;          // 3 per triangle, all below vertex_count()
  std::vector<Attribute> attributes;           // all of the same count; POSITION among them
  std::vector<std::vector<Attribute>> targets; // morph targets: deltas
  std::optional<std::uint32_t> material;

  [[nodiscard]] const Attribute* find(std::string_view name) const;
  [[nodiscard]] std::size_t vertex_count() const;
  // POSITION as floats (integers are exact in float up to 16 bits). Finite: read_asset has refused others.
  [[nodiscard]] std::vector<Vec3f> positions() const;
};

// The textures that every glTF material may have.
enum class TextureSlot : std::uint8_t { base_color, metallic_roughness, occlusion, emissive, normal };
inline constexpr std::size_t texture_slots = 5;

// A texture of a primitive's material, ready to be sampled.
struct MaterialTexture {
  std::span<const std::byte> image;   // PNG, JPEG or WebP as in the input, for as long as the asset lives
  std::size_t image_number = 0;       // in the document: equal numbers, equal images
  std::string uv;                     // the attribute that samples it, e.g. "TEXCOORD_0"
  int wrap_s = 10497, wrap_t = 10497; // glTF codes: 33071 clamp, 33648 mirror, 10497 repeat
  bool nearest = false;               // magnified without interpolation
  // KHR_texture_transform as a 2x3 matrix, row-major: u' = m0 u + m1 v + m2, v' = m3 u + m4 v + m5
  std::array<float, 6> transform{1, 0, 0, 0, 1, 0};
  float scale = 1; // normalTexture.scale
};

// Opaque: the JSON document and the buffers as they came.
class Document;

struct Asset {
  ModelFormat format = ModelFormat::glb; // of the model itself, where it came in a zip
  std::vector<Primitive> primitives;     // triangles only; points and lines stay in the document
  std::shared_ptr<const Document> document;
  // Facts for the report: an external image that did not come with the request, an extension that was not understood, …
  struct Note {
    std::string code, message, where;
  };
  std::vector<Note> notes;
};

// Recognises the format by content, not by name or media type (model_format.h), and reads it. OBJ, PLY, STL and raw
// Draco become a glTF first; a zip is taken apart in memory, and its members come before `attachments`.
//
// GLB, glTF JSON (data URIs; other URIs only from `attachments`). Understands KHR_draco_mesh_compression,
// KHR_mesh_quantization, EXT_meshopt_compression and KHR_meshopt_compression, sparse accessors, strips and fans.
// Never touches the file system or the network. Untrusted input: every accessor, view, index, node and size is
// checked before it is used. Throws Error: malformed, unsupported_format, unsupported_feature, too_large,
// missing_resource (a buffer; an image or a material library too, where files came with the model), invalid_geometry
// (NaN or infinity, with the vertex that has it; no triangles at all; a mesh that every node shows at scale zero).
[[nodiscard]] Asset read_asset(std::span<const std::byte> bytes, const Attachments& attachments, const Limits& limits);

// The texture of a slot, or nothing where the primitive's material has none, its image did not come with the request or
// is in a format that orbis does not decode (KTX2, AVIF), or the primitive lacks its coordinates. base_color falls back
// on the diffuse texture of KHR_materials_pbrSpecularGlossiness.
[[nodiscard]] std::optional<MaterialTexture> material_texture(const Asset& asset, const Primitive& primitive,
                                                              TextureSlot slot);

// Whether the primitive's material names a texture for the slot, whatever becomes of it.
[[nodiscard]] bool names_texture(const Asset& asset, const Primitive& primitive, TextureSlot slot);

// One past the highest TEXCOORD set that the textures of the primitive's materials read, those of its variants too.
// Files that read more than eight are taken to be wrong about it.
[[nodiscard]] std::uint32_t named_texture_sets(const Asset& asset, const Primitive& primitive);

// Whether the primitive's material has textures besides those of `replaced`.
[[nodiscard]] bool keeps_textures(const Asset& asset, const Primitive& primitive,
                                  const std::map<TextureSlot, std::uint32_t>& replaced);

// Whether something else than its material's own normal map is seen through the primitive's TANGENT: another
// tangent-space texture (clear coat, anisotropy), or a variant's material with one.
[[nodiscard]] bool shares_tangents(const Asset& asset, const Primitive& primitive);

// Whether other materials may take the place of the primitive's own (KHR_materials_variants).
[[nodiscard]] bool has_variants(const Asset& asset, const Primitive& primitive);

// What replaces a primitive in the output. Without indices the primitive stays as it was: all its triangles were
// degenerate.
struct NewPrimitive {
  std::vector<std::uint32_t> indices;
  std::vector<Attribute> attributes; // with TEXCOORD_n of the atlas and _SPHERE
  std::vector<std::vector<Attribute>> targets;
  std::uint32_t atlas_texcoord = 0; // n
  // The textures of its material that new images take the place of, sampled by TEXCOORD_n: number of the image.
  std::map<TextureSlot, std::uint32_t> textures;
  // The base colour shows its image as it is: the material's base colour factor goes.
  bool plain_base_color = false;
  // Triangles of the old primitive (its own vertex numbers) that go on without a place in the atlas: a primitive of
  // their own behind the mesh's others, with the old attributes and the old material. Only beside `indices`.
  std::vector<std::uint32_t> left_out{};
  // The name of the last target where that is not the input's; all new primitives of a mesh then have it.
  std::string added_target{};

  // The old primitive goes, and nothing takes its place: a level that has no triangle of it. Without `indices`.
  bool is_gone = false;

  // Where some nodes mirror the mesh and others do not: those that do show a copy of it whose TANGENT has its w
  // negated.
  bool mirrors_tangents = false;

  // The attribute of this name, or null.
  [[nodiscard]] const Attribute* find(std::string_view name) const;
  [[nodiscard]] Attribute* find(std::string_view name);
};

// Negates the w of a TANGENT: the bitangent then points the other way.
void negate_handedness(Attribute& tangent);

// A coarser version of the new primitives.
struct NewLevel {
  // One per primitive of the asset; without indices where nothing is left of it. They share the full surface's
  // materials but for their own `textures`.
  std::vector<NewPrimitive> primitives;
  double screen_coverage = 0; // it may replace the level before where the model fills less of the screen's height
};

struct NewImage {
  Bytes bytes;
  std::string mime_type; // "image/png", "image/jpeg" or "image/webp"
  std::string name = "atlas";
};

// Compression::quantized: NORMAL and TANGENT of floats become normalized 16-bit integers (KHR_mesh_quantization), which
// turns them by less than 0.003 degrees.
void quantise_directions(NewPrimitive& primitive);

// Writes the GLB: the document as it came (nodes, names, materials, skins, animations, cameras, extras, unknown
// extensions), with primitive i of `asset` replaced by primitives[i], textures of its material by `images` on the
// atlas' TEXCOORD set, and `extras_json` (a JSON object as text) under asset.extras.orbis. A raw Draco input becomes a
// document with one node, mesh and material. Materials that other primitives use too are cloned, not changed.
// Buffers hold only what is still referenced. Same input, same bytes.
// With Compression::draco the new primitives are written with KHR_draco_mesh_compression, positions and _SPHERE
// lossless (the sphere coordinates must not be quantised: they would fold); with meshopt and quantized as
// EXT_meshopt_compression, lossless too, where a triangle may begin with another of its corners. Levels of detail are
// added as MSFT_lod (levels.h), their meshes behind the document's, level by level. notes: gets what of the document
// could not be kept.
[[nodiscard]] Bytes write_asset(const Asset& asset, std::span<const NewPrimitive> primitives,
                                std::span<const NewImage> images, std::string_view extras_json, Compression compression,
                                std::span<const NewLevel> levels = {}, std::vector<Asset::Note>* notes = nullptr);

} // namespace orbis::asset
