// Text formats, line by line and word by word, with errors that name the line.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/error.h"
#include "core/utf8.h"

namespace orbis::asset {

class TextReader {
public:
  // `what` begins the messages: "the OBJ file".
  TextReader(std::span<const std::byte> bytes, std::string_view what)
      : rest_(without_byte_order_mark({reinterpret_cast<const char*>(bytes.data()), bytes.size()})), what_(what) {}

  // Goes to the next line; false where there is none. Lines end with "\n", "\r\n" or "\r".
  bool next_line() {
    if (rest_.empty()) return false;
    const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    line_ = rest_.substr(0, end);
    const bool is_pair = rest_.substr(end, 2) == "\r\n";
    rest_.remove_prefix(std::min(rest_.size(), end + (is_pair ? 2 : 1)));
    ++number_;
    return true;
  }
  // The next word of the line; empty where there is none.
  std::string_view word() {
    skip_space();
    const std::size_t end = std::min(line_.find_first_of(" \t"), line_.size());
    const std::string_view found = line_.substr(0, end);
    line_.remove_prefix(end);
    return found;
  }
  // The next word anywhere, over the ends of lines; empty at the end of the text.
  std::string_view word_over_lines() {
    for (std::string_view found = word();; found = word()) {
      if (!found.empty() || !next_line()) return found;
    }
  }
  // What is left of the line, without space at either end.
  std::string_view rest_of_line() {
    skip_space();
    std::string_view found = line_;
    line_ = {};
    while (!found.empty() && (found.back() == ' ' || found.back() == '\t')) found.remove_suffix(1);
    return found;
  }
  [[nodiscard]] bool at_end_of_line() {
    skip_space();
    return line_.empty();
  }
  // The text from the beginning of the next line on.
  [[nodiscard]] std::string_view rest() const { return rest_; }

  // A word as a number, correctly rounded.
  template <class T> [[nodiscard]] T number(std::string_view word) const {
    T value{};
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (word.empty()) fail("a number is missing");
    if (error == std::errc::result_out_of_range) return out_of_range<T>(word);
    if (error != std::errc{} || end != digits.data() + digits.size()) fail(quoted(word) + " is not a number");
    return value;
  }

  [[noreturn]] void fail(const std::string& message, ErrorCode code = ErrorCode::malformed) const {
    throw Error(code, std::string(what_) + ", line " + std::to_string(number_) + ": " + message);
  }
  // A word as messages show it: short, without strange characters.
  [[nodiscard]] static std::string quoted(std::string_view word) {
    std::string out(1, '\'');
    for (const char c : word.substr(0, 40)) out += c >= 0x20 && c < 0x7f ? c : '?';
    out += '\'';
    return out;
  }

private:
  void skip_space() { line_.remove_prefix(std::min(line_.find_first_not_of(" \t"), line_.size())); }
  // What is too small for its type is nothing; what is too large is no coordinate.
  template <class T> [[nodiscard]] T out_of_range(std::string_view word) const {
    if constexpr (std::is_floating_point_v<T>) {
      if (word.find_first_of("eE") != std::string_view::npos && word.find('-', 1) != std::string_view::npos) return T{};
    }
    fail(quoted(word) + " is out of range");
  }

  std::string_view rest_, line_, what_;
  std::size_t number_ = 0;
};

} // namespace orbis::asset
