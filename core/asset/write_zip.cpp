#include "core/asset/write_zip.h"

#include <zip.h>

#include <memory>

namespace orbis::asset {
namespace {

[[noreturn]] void fail() { throw Error(ErrorCode::internal, "the zip archive of the result could not be written"); }

// Midnight of the first day that zip's own format can name.
constexpr zip_uint16_t first_day = 1 << 5 | 1, midnight = 0;

struct CloseSource {
  void operator()(zip_source_t* source) const { zip_source_free(source); }
};

void add(zip_t* archive, const ZipMember& member) {
  zip_source_t* source = zip_source_buffer(archive, member.bytes.data(), member.bytes.size(), 0);
  if (source == nullptr) fail();
  const zip_int64_t number = zip_file_add(archive, member.name.c_str(), source, ZIP_FL_ENC_UTF_8);
  if (number < 0) {
    zip_source_free(source);
    fail();
  }
  const auto index = static_cast<zip_uint64_t>(number);
  if (zip_set_file_compression(archive, index, ZIP_CM_STORE, 0) != 0 ||
      zip_file_set_dostime(archive, index, midnight, first_day, 0) != 0)
    fail();
}

Bytes contents(zip_source_t* source) {
  zip_stat_t facts{};
  if (zip_source_stat(source, &facts) != 0 || (facts.valid & ZIP_STAT_SIZE) == 0 || zip_source_open(source) != 0)
    fail();
  Bytes out(facts.size);
  const zip_int64_t read = zip_source_read(source, out.data(), out.size());
  zip_source_close(source);
  if (read < 0 || static_cast<std::size_t>(read) != out.size()) fail();
  return out;
}

} // namespace

Bytes write_zip(std::span<const ZipMember> members) {
  zip_error_t error;
  zip_error_init(&error);
  const std::unique_ptr<zip_source_t, CloseSource> target(zip_source_buffer_create(nullptr, 0, 0, &error));
  if (!target) fail();
  zip_t* archive = zip_open_from_source(target.get(), ZIP_TRUNCATE, &error);
  if (archive == nullptr) fail();
  zip_source_keep(target.get()); // the archive takes one reference, we read through the other
  try {
    for (const ZipMember& member : members) add(archive, member);
  } catch (const Error&) {
    zip_discard(archive);
    throw;
  }
  if (zip_close(archive) != 0) {
    zip_discard(archive);
    fail();
  }
  return contents(target.get());
}

} // namespace orbis::asset
