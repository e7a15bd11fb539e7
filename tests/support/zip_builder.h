// Zip archives of stored members, built in code (PKWARE, APPNOTE.TXT 6.3), with room for lies.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "support/gltf_builder.h"

namespace orbis::test {

struct ZipMember {
  std::string name;
  Bytes contents;
  std::uint16_t method = 0, flags = 0;
  std::uint32_t claimed = 0; // the size after inflating that is claimed; 0: the true one
};

inline std::uint32_t crc32_of(std::span<const std::byte> bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const std::byte b : bytes) {
    crc ^= std::to_integer<std::uint32_t>(b);
    for (int i = 0; i < 8; ++i) crc = crc >> 1 ^ (crc & 1 ? 0xEDB88320u : 0);
  }
  return ~crc;
}

class ZipWriter {
public:
  void u16(std::uint64_t v) { number(v, 2); }
  void u32(std::uint64_t v) { number(v, 4); }
  void bytes(const Bytes& b) { out.insert(out.end(), b.begin(), b.end()); }
  Bytes out;

private:
  void number(std::uint64_t v, int size) {
    for (int i = 0; i < size; ++i) out.push_back(static_cast<std::byte>(v >> (8 * i) & 0xff));
  }
};

inline Bytes zip_of(const std::vector<ZipMember>& members) {
  ZipWriter zip, directory;
  const auto common = [](ZipWriter& w, const ZipMember& m) {
    for (const std::uint64_t v : {std::uint64_t{20}, std::uint64_t{m.flags}, std::uint64_t{m.method}}) w.u16(v);
    w.u32(0x00210000); // 1 January 1980
    w.u32(crc32_of(m.contents));
    w.u32(m.contents.size());
    w.u32(m.claimed ? m.claimed : m.contents.size());
    w.u16(m.name.size());
    w.u16(0);
  };
  for (const ZipMember& m : members) {
    const std::size_t offset = zip.out.size();
    zip.u32(0x04034b50);
    common(zip, m);
    zip.bytes(bytes_of(m.name));
    zip.bytes(m.contents);
    directory.u32(0x02014b50);
    directory.u16(20);
    common(directory, m);
    for (int i = 0; i < 3; ++i) directory.u16(0);
    directory.u32(0);
    directory.u32(offset);
    directory.bytes(bytes_of(m.name));
  }
  const std::size_t start = zip.out.size();
  zip.bytes(directory.out);
  zip.u32(0x06054b50);
  zip.u32(0);
  zip.u16(members.size());
  zip.u16(members.size());
  zip.u32(directory.out.size());
  zip.u32(start);
  zip.u16(0);
  return zip.out;
}

} // namespace orbis::test
