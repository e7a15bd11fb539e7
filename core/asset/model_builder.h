// A glTF made from a file of another format, so that what comes after the reading knows only one.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/asset/asset.h"
#include "core/asset/document.h"
#include "core/asset/model_files.h"
#include "core/asset/output.h"

namespace orbis::asset {

// A file in glTF's form, and what could not be carried over.
struct Converted {
  Bytes glb;
  std::vector<Asset::Note> notes;
};

// Names may come in any encoding; they are written as_utf8.
class ModelBuilder {
public:
  ModelBuilder();

  // A mesh, shown by a node of that name ("" for none), with its origin at that place. Returns its number.
  std::size_t add_mesh(std::string_view name, const Vec3d& origin = {});
  // A list of triangles; three indices each, all below the attributes' count.
  void add_primitive(std::size_t mesh, std::span<const std::uint32_t> indices, std::span<const Attribute> attributes,
                     std::optional<std::size_t> material);
  // A glTF material; returns its number.
  std::size_t add_material(Json material);
  // A texture that repeats, or ends in its border's colours, of a PNG, JPEG or WebP image. Returns its number.
  std::size_t add_texture(std::string_view name, std::span<const std::byte> image, bool repeats = true);
  // Names an extension that readers may do without.
  void use_extension(std::string_view name);
  [[nodiscard]] Bytes glb();

private:
  std::size_t sampler(bool repeats);

  Document empty_;
  Output out_;
};

// Brings the vectors of a NORMAL attribute to unit length, as glTF asks. False where one has no direction.
[[nodiscard]] bool make_unit(Attribute& normals);

// A PNG, JPEG or WebP image as a texture; nothing, and a note, where it did not come or is of another kind.
[[nodiscard]] std::optional<std::size_t> add_texture_file(ModelBuilder& model, const ModelFiles& files,
                                                          std::string_view name, std::vector<Asset::Note>& notes,
                                                          bool repeats = true);

} // namespace orbis::asset
