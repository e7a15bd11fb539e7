#include "core/asset/glb.h"

#include <cstring>
#include <limits>
#include <string>

namespace orbis::asset {
namespace {

constexpr std::uint32_t magic = 0x46546C67;      // "glTF"
constexpr std::uint32_t json_chunk = 0x4E4F534A; // "JSON"
constexpr std::uint32_t bin_chunk = 0x004E4942;  // "BIN\0"
constexpr std::size_t header_size = 12, chunk_header_size = 8;

std::uint32_t word(std::span<const std::byte> bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::to_integer<std::uint32_t>(bytes[at + i]) << (8 * i);
  return value;
}

void put_word(Bytes& out, std::size_t value) {
  for (std::size_t i = 0; i < 4; ++i) out.push_back(static_cast<std::byte>((value >> (8 * i)) & 0xff));
}

void put_chunk(Bytes& out, std::uint32_t type, std::span<const std::byte> data, char padding) {
  const std::size_t padded = (data.size() + 3) / 4 * 4;
  put_word(out, padded);
  put_word(out, type);
  out.insert(out.end(), data.begin(), data.end());
  out.insert(out.end(), padded - data.size(), static_cast<std::byte>(padding));
}

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::malformed, "the GLB " + message); }

void check_header(std::span<const std::byte> bytes) {
  if (bytes.size() < header_size) refuse("ends within its header");
  const std::uint32_t version = word(bytes, 4);
  if (version != 2) {
    throw Error(ErrorCode::unsupported_format, "the GLB is of version " + std::to_string(version) +
                                                   "; only glTF 2.0 is read, so convert it to glTF 2.0 first");
  }
  const std::uint32_t length = word(bytes, 8);
  if (length != bytes.size()) {
    refuse("says that it is " + std::to_string(length) + " bytes long, but " + std::to_string(bytes.size()) +
           " bytes came; it is truncated or damaged");
  }
}

} // namespace

bool is_glb(std::span<const std::byte> bytes) { return bytes.size() >= 4 && word(bytes, 0) == magic; }

GlbChunks split_glb(std::span<const std::byte> bytes) {
  check_header(bytes);
  GlbChunks chunks;
  bool first = true;
  for (std::size_t at = header_size; at < bytes.size(); first = false) {
    if (bytes.size() - at < chunk_header_size) refuse("ends within the header of a chunk");
    const std::size_t length = word(bytes, at);
    const std::uint32_t type = word(bytes, at + 4);
    at += chunk_header_size;
    if (length > bytes.size() - at) refuse("has a chunk that ends beyond the file");
    if (length % 4 != 0) refuse("has a chunk that does not end on a 4-byte boundary");
    if (first != (type == json_chunk)) refuse("must have one JSON chunk, and it must be the first");
    if (type == bin_chunk && chunks.bin) refuse("has two binary chunks");
    if (type == json_chunk) chunks.json = bytes.subspan(at, length);
    if (type == bin_chunk) chunks.bin = bytes.subspan(at, length);
    at += length;
  }
  if (first) refuse("has no JSON chunk");
  return chunks;
}

Bytes join_glb(std::string_view json, std::span<const std::byte> bin) {
  const std::size_t size = header_size + chunk_header_size + (json.size() + 3) / 4 * 4 +
                           (bin.empty() ? 0 : chunk_header_size + (bin.size() + 3) / 4 * 4);
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    throw Error(ErrorCode::too_large, "the result would be larger than the 4 GiB that a GLB can hold");
  }
  Bytes out;
  out.reserve(size);
  put_word(out, magic);
  put_word(out, 2);
  put_word(out, size);
  put_chunk(out, json_chunk, std::as_bytes(std::span(json)), ' ');
  if (!bin.empty()) put_chunk(out, bin_chunk, bin, '\0');
  return out;
}

} // namespace orbis::asset
