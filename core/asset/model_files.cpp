#include "core/asset/model_files.h"

namespace orbis::asset {
namespace {

[[noreturn]] void missing(std::string_view name, const std::string& where, const std::string& advice) {
  throw Error(ErrorCode::missing_resource, "the file '" + shown(name) + "' did not come with the request; " + advice,
              where);
}

} // namespace

const Bytes* ModelFiles::find(std::string_view name, const std::string& where) const {
  const Bytes* found = find_attachment(attachments_, name);
  const bool is_absolute = name.find(':') != std::string_view::npos;
  if (!found && complete_ && !is_absolute) {
    missing(name, where, "send it along with the others under the name that the model gives it");
  }
  return found;
}

const Bytes& ModelFiles::require(std::string_view name, const std::string& where) const {
  const Bytes* found = find_attachment(attachments_, name);
  if (!found) missing(name, where, "send it along, or export a file that holds everything, such as a GLB");
  return *found;
}

} // namespace orbis::asset
