// The document as it came: its JSON and its binary data. What orbis does not touch is written from here.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/asset/asset.h"
#include "core/asset/json.h"

namespace orbis::asset {

class Document {
public:
  Json json;                  // vetted; data URIs of buffers are taken out
  std::vector<Bytes> buffers; // one per /buffers entry; empty where nothing refers to its bytes
  // Views that were stored with a meshopt extension, decoded; by their number.
  std::map<std::size_t, Bytes> decoded_views;
  // Images with a URI, by their number: from a data URI or a file that came with the request.
  std::map<std::size_t, Bytes> images;
  bool keeps_numbers = false; // an extension whose references are not known: nothing is dropped or renumbered

  // The bytes of /bufferViews/i, decoded.
  [[nodiscard]] std::span<const std::byte> view(std::size_t i) const;
  // The file of /images/i, or nothing where it did not come.
  [[nodiscard]] std::optional<std::span<const std::byte>> image(std::size_t i) const;
};

// "image/png", "image/jpeg", "image/webp", "image/ktx2" or "image/avif", by content; empty for anything else.
[[nodiscard]] std::string_view image_type(std::span<const std::byte> bytes);

} // namespace orbis::asset
