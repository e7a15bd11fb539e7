#include "core/asset/uri.h"

#include <array>
#include <cstdint>

#include "core/utf8.h"

namespace orbis::asset {
namespace {

constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
constexpr std::uint8_t invalid = 255;

constexpr std::array<std::uint8_t, 256> make_digits() {
  std::array<std::uint8_t, 256> digits{};
  for (auto& d : digits) d = invalid;
  for (std::size_t i = 0; i < alphabet.size(); ++i)
    digits[static_cast<unsigned char>(alphabet[i])] = static_cast<std::uint8_t>(i);
  return digits;
}
constexpr auto digits = make_digits();

std::optional<Bytes> decode_base64(std::string_view text) {
  if (text.size() % 4 != 0) return std::nullopt;
  std::size_t padding = 0;
  while (padding < 2 && padding < text.size() && text[text.size() - 1 - padding] == '=') ++padding;
  Bytes out;
  out.reserve(text.size() / 4 * 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text.substr(0, text.size() - padding)) {
    const std::uint8_t digit = digits[static_cast<unsigned char>(c)];
    if (digit == invalid) return std::nullopt;
    bits = (bits << 6 | digit) & 0xffff;
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out.push_back(static_cast<std::byte>(bits >> count & 0xff));
  }
  return out;
}

int hex(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

} // namespace

bool is_data_uri(std::string_view uri) { return uri.substr(0, 5) == "data:"; }

std::optional<DataUri> decode_data_uri(std::string_view uri) {
  constexpr std::string_view marker = ";base64";
  const std::size_t comma = uri.find(',');
  if (!is_data_uri(uri) || comma == std::string_view::npos) return std::nullopt;
  std::string_view type = uri.substr(5, comma - 5);
  if (type.size() < marker.size() || type.substr(type.size() - marker.size()) != marker) return std::nullopt;
  type.remove_suffix(marker.size());
  auto bytes = decode_base64(uri.substr(comma + 1));
  if (!bytes) return std::nullopt;
  return DataUri{std::string(type.substr(0, type.find(';'))), std::move(*bytes)};
}

std::string percent_decoded(std::string_view uri) {
  std::string out;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex(uri[i + 1]) >= 0 && hex(uri[i + 2]) >= 0) {
      out += static_cast<char>(hex(uri[i + 1]) * 16 + hex(uri[i + 2]));
      i += 2;
    } else {
      out += uri[i];
    }
  }
  return out;
}

const Bytes* find_attachment(const Attachments& attachments, std::string_view uri) {
  const std::string decoded = percent_decoded(uri);
  for (std::string name : {decoded, as_utf8(decoded), std::string(uri)}) {
    while (name.starts_with("./")) name.erase(0, 2);
    auto found = attachments.find(name);
    const bool is_relative = name.find(':') == std::string::npos;
    if (found == attachments.end() && is_relative) found = attachments.find(name.substr(name.rfind('/') + 1));
    if (found != attachments.end()) return &found->second;
  }
  return nullptr;
}

std::string shown(std::string_view uri) {
  constexpr std::size_t longest = 80, longest_character = 4;
  std::string out = as_utf8(uri.substr(0, longest + longest_character));
  for (char& c : out) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  }
  if (out.size() > longest) {
    // A cut inside a multi-byte character would not be UTF-8 any more.
    std::size_t end = longest;
    while ((static_cast<unsigned char>(out[end]) & 0xc0) == 0x80) --end;
    out.resize(end);
    out += "…";
  }
  return out;
}

} // namespace orbis::asset
