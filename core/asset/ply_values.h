// The values behind the header of a PLY file, one after the other, in any of its three forms.
#pragma once

#include "core/asset/ply_header.h"

namespace orbis::asset {

class PlyValues {
public:
  // `text` stands before the data. Reading throws Error{malformed} where the data ends or is none.
  PlyValues(TextReader text, PlyForm form) : text_(text), bytes_(text.rest()), form_(form) {}

  [[nodiscard]] double next(PlyType type);
  // A whole number that is not negative, below `end`.
  [[nodiscard]] std::uint64_t next_index(PlyType type, std::uint64_t end, const char* what);
  // How many values of a list follow.
  [[nodiscard]] std::uint64_t next_length(const PlyProperty& list);
  void skip(const PlyProperty& property);

  // Refuses counts that the rest of the file cannot hold, before anything is made from them.
  void check_count(const PlyElement& element) const;
  // Whether every value of the property is a float32 as it stands in the file.
  [[nodiscard]] bool holds_floats(const PlyProperty& property) const;
  [[noreturn]] void fail(const std::string& message, ErrorCode code) const { text_.fail(message, code); }

private:
  TextReader text_;
  std::string_view bytes_;
  PlyForm form_;
};

} // namespace orbis::asset
