#include "core/asset/mtl_options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include "core/asset/text_reader.h"

namespace orbis::asset {
namespace {

struct NumberOption {
  std::string_view name;
  std::array<std::string_view, 3> defaults; // fewer: "" behind them
};
constexpr std::array<NumberOption, 4> number_options{
    {{"-s", {"1", "1", "1"}}, {"-o", {"0", "0", "0"}}, {"-t", {"0", "0", "0"}}, {"-mm", {"0", "1", ""}}}};
constexpr std::array<std::string_view, 9> word_options{"-blendu", "-blendv",  "-clamp", "-boost",     "-bm",
                                                       "-texres", "-imfchan", "-type",  "-colorspace"};

bool is_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size();
}

bool names_texture(std::string_view keyword) {
  return keyword.starts_with("map_") || keyword == "bump" || keyword == "disp" || keyword == "refl" ||
         keyword == "norm";
}

// The numbers that are there, then the defaults. The last word of a line is the file, even "4".
void append_numbers(const NumberOption& option, TextReader& line, std::string& out) {
  for (const std::string_view fallback : option.defaults) {
    if (fallback.empty()) return;
    TextReader ahead = line;
    const std::string_view word = ahead.word();
    const bool is_given = is_number(word) && !ahead.at_end_of_line();
    if (is_given) line = ahead;
    out.append(1, ' ').append(is_given ? word : fallback);
  }
}

// What stands behind the keyword of a texture.
std::string completed(TextReader line) {
  std::string out;
  while (true) {
    TextReader before = line;
    const std::string_view word = line.word();
    const auto* const option = std::ranges::find(number_options, word, &NumberOption::name);
    if (option != number_options.end()) {
      out.append(1, ' ').append(word);
      append_numbers(*option, line, out);
    } else if (std::ranges::find(word_options, word) != word_options.end()) {
      out.append(1, ' ').append(word).append(1, ' ').append(line.word());
    } else {
      return out.append(1, ' ').append(before.rest_of_line());
    }
  }
}

} // namespace

std::string with_all_option_numbers(std::span<const std::byte> library) {
  std::string out;
  out.reserve(library.size());
  TextReader text(library, "the material library");
  while (text.next_line()) {
    TextReader line = text;
    const std::string_view keyword = line.word();
    if (names_texture(keyword)) {
      out.append(keyword).append(completed(line));
    } else {
      out.append(text.rest_of_line());
    }
    out += '\n';
  }
  return out;
}

} // namespace orbis::asset
