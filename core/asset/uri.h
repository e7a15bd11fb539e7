// URIs of a glTF: data URIs are decoded, names are looked up among the files that came. Nothing is ever opened.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/asset/asset.h"

namespace orbis::asset {

[[nodiscard]] bool is_data_uri(std::string_view uri);

struct DataUri {
  std::string mime_type;
  Bytes bytes;
};
// Strict base64 (RFC 4648: padded, no other characters). Nothing where the URI is not "data:…;base64,…" or is damaged.
[[nodiscard]] std::optional<DataUri> decode_data_uri(std::string_view uri);

// "a%20b.png" -> "a b.png"; a '%' that no two hexadecimal digits follow stays.
[[nodiscard]] std::string percent_decoded(std::string_view uri);

// The file that a URI means, among those that came with the request: by its whole decoded name (a leading "./" does not
// count), else, unless it is absolute ("https:…"), by the last part of that name, since an upload form sends no
// folders; else by its name as it is written. Bytes are compared first; a name in Latin-1 also means the file that was
// sent under the same name in UTF-8. Null where it did not come.
[[nodiscard]] const Bytes* find_attachment(const Attachments& attachments, std::string_view uri);

// A URI as messages show it: short, in UTF-8, without control characters.
[[nodiscard]] std::string shown(std::string_view uri);

} // namespace orbis::asset
