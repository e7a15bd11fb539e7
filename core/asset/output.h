// The document on its way out: new buffer views and accessors are added, what nothing refers to is dropped, and
// everything is laid out in one buffer.
#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "core/asset/document.h"

namespace orbis::asset {

enum class Target { none = 0, vertices = 34962, indices = 34963 };

// How the views of attributes and indices that are added are stored.
enum class GeometryCoding { plain, meshopt };

class Output {
public:
  // `document` outlives the output: the bytes of views that stay are taken from it.
  explicit Output(const Document& document, GeometryCoding coding = GeometryCoding::plain);

  Json json; // the document; patch it at will, but add views and accessors through the functions below

  // Both return the new number. Bytes are aligned to 4 in the end.
  std::size_t add_view(Bytes bytes, Target target = Target::none, std::size_t stride = 0);
  std::size_t add_accessor(Json accessor);
  // A vertex attribute with a view of its own, padded to a stride of a multiple of 4; with bounds where the
  // specification asks for them (POSITION).
  std::size_t add_attribute(const Attribute& attribute);
  // 16 bits where the largest index allows it. With meshopt a triangle may begin with another corner.
  std::size_t add_indices(std::span<const std::uint32_t> indices, std::size_t vertex_count);

  // Drops accessors, textures, images, samplers and views that nothing refers to, and renumbers the rest.
  void drop_unreferenced();

  // The finished file.
  [[nodiscard]] Bytes glb();

private:
  std::size_t add_meshopt_view(Bytes encoded, std::size_t count, std::size_t stride, Target target);

  const Document& document_;
  GeometryCoding coding_;
  std::vector<std::span<const std::byte>> views_; // contents of /bufferViews, by number, as stored
  std::deque<Bytes> added_;                       // keeps the contents of new views
};

// The JSON of an accessor without a view: type, count and, for POSITION, exact bounds.
[[nodiscard]] Json accessor_of(const Attribute& attribute);
[[nodiscard]] Json accessor_of_indices(std::size_t count, std::size_t vertex_count);

} // namespace orbis::asset
