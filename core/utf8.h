// Names of files that say nothing of their encoding, for documents and messages that must be UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace orbis {

// Well-formed UTF-8 (The Unicode Standard, table 3-7) stays as it is. Every byte that belongs to none is taken for
// Latin-1, whose characters have the same numbers in Unicode: that keeps names of single-byte encodings readable, and
// those of others at least apart.
[[nodiscard]] std::string as_utf8(std::string_view text);

// A text from behind the byte order mark that some editors begin UTF-8 with.
[[nodiscard]] std::string_view without_byte_order_mark(std::string_view text);

} // namespace orbis
