// The files beside a model: what it names, among what came with it.
#pragma once

#include <string>
#include <string_view>

#include "core/asset/uri.h"

namespace orbis::asset {

class ModelFiles {
public:
  // With `complete`, every file that the model names is expected to be there.
  ModelFiles(const Attachments& attachments, bool complete) : attachments_(attachments), complete_(complete) {}

  // The file that a URI or a name means (find_attachment), or null where it did not come: what came alone may go
  // without its images. Where files came along, one that is missing was forgotten or has another name: then throws
  // Error{missing_resource} that names it. An absolute URI ("https:…") is never fetched and may be missing in any case.
  [[nodiscard]] const Bytes* find(std::string_view name, const std::string& where) const;
  [[nodiscard]] bool has(std::string_view name) const { return find_attachment(attachments_, name) != nullptr; }
  // The same as find() for what the model cannot be read without.
  [[nodiscard]] const Bytes& require(std::string_view name, const std::string& where) const;

private:
  const Attachments& attachments_;
  bool complete_;
};

} // namespace orbis::asset
