#include "core/asset/document.h"

#include <cstring>
#include <string_view>

namespace orbis::asset {

std::span<const std::byte> Document::view(std::size_t i) const {
  if (const auto decoded = decoded_views.find(i); decoded != decoded_views.end()) return decoded->second;
  const Json& view = json.at("bufferViews").at(i);
  const Bytes& buffer = buffers.at(view.at("buffer").get<std::size_t>());
  return std::span(buffer).subspan(view.value("byteOffset", std::size_t{0}), view.at("byteLength").get<std::size_t>());
}

std::optional<std::span<const std::byte>> Document::image(std::size_t i) const {
  if (const auto found = images.find(i); found != images.end()) return found->second;
  if (const Json* number = find(json.at("images").at(i), "bufferView")) return view(number->get<std::size_t>());
  return std::nullopt;
}

std::string_view image_type(std::span<const std::byte> bytes) {
  const std::string_view head(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 12));
  if (head.substr(0, 8) == "\x89PNG\r\n\x1a\n") return "image/png";
  if (head.substr(0, 3) == "\xff\xd8\xff") return "image/jpeg";
  if (head.substr(0, 4) == "RIFF" && head.size() == 12 && head.substr(8) == "WEBP") return "image/webp";
  if (head.substr(0, 7) == "\xabKTX 20") return "image/ktx2";
  if (head.size() == 12 && head.substr(4) == "ftypavif") return "image/avif";
  return {};
}

} // namespace orbis::asset
