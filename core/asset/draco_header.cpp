#include "core/asset/draco_header.h"

#include <algorithm>

namespace orbis::asset {
namespace {

// Reads little-endian values; after the end it gives zeros and says so.
class Cursor {
public:
  explicit Cursor(std::span<const std::byte> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool ok() const { return ok_; }

  void skip(std::uint64_t n) {
    if (n > bytes_.size()) ok_ = false;
    bytes_ = bytes_.subspan(static_cast<std::size_t>(std::min<std::uint64_t>(n, bytes_.size())));
  }

  std::uint64_t fixed(std::size_t size) {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size && i < bytes_.size(); ++i)
      value |= std::to_integer<std::uint64_t>(bytes_[i]) << (8 * i);
    skip(size);
    return value;
  }

  // LEB128, at most 5 bytes as counts have 32 bits.
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      const std::uint64_t byte = fixed(1);
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
    ok_ = false;
    return 0;
  }

private:
  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

// One metadata tree: entries, then the named subtrees. Depth first, so that a count of what is left replaces recursion.
void skip_metadata_tree(Cursor& in) {
  bool is_root = true;
  for (std::uint64_t left = 1; left > 0 && in.ok(); --left, is_root = false) {
    if (!is_root) in.skip(in.fixed(1)); // name
    const std::uint64_t entries = in.varint();
    for (std::uint64_t i = 0; i < entries && in.ok(); ++i) {
      in.skip(in.fixed(1)); // name
      in.skip(in.varint()); // value
    }
    left += in.varint();
  }
}

void skip_metadata(Cursor& in) {
  const std::uint64_t attributes = in.varint();
  for (std::uint64_t i = 0; i < attributes && in.ok(); ++i) {
    (void)in.varint(); // the attribute's id
    skip_metadata_tree(in);
  }
  skip_metadata_tree(in);
}

} // namespace

std::optional<DracoHeader> read_draco_header(std::span<const std::byte> bytes) {
  constexpr std::uint64_t metadata_flag = 0x8000;
  Cursor in(bytes);
  in.skip(5); // "DRACO"
  const std::uint64_t major = in.fixed(1), minor = in.fixed(1);
  const std::uint64_t version = major << 8 | minor;
  const std::uint64_t geometry = in.fixed(1), method = in.fixed(1), flags = in.fixed(2);
  if (!in.ok() || geometry > 1 || method > 1) return std::nullopt;
  DracoHeader header;
  header.is_mesh = geometry == 1;
  if (!header.is_mesh) return header;
  if (flags & metadata_flag) skip_metadata(in);
  const bool is_sequential = method == 0;
  const auto count = [&](std::uint64_t first_with_varint) {
    return version < first_with_varint ? in.fixed(4) : in.varint();
  };
  if (is_sequential) {
    header.faces = count(0x0202);
    header.vertices = count(0x0202);
  } else {
    in.skip(1); // traversal
    if (version < 0x0202) (void)count(0x0200);
    header.vertices = count(0x0200);
    header.faces = count(0x0200);
  }
  if (!in.ok()) return std::nullopt;
  return header;
}

} // namespace orbis::asset
